"""Processes that somebody kills: the run is repeated, as nobody knows that the policy did it."""

import os
import signal
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import pytest

from lodbench.analysis.study.engine.limits import Limits
from lodbench.analysis.study.engine.local.local_engine import LocalEngine


@dataclass(frozen=True)
class Killed:
    """A task whose process, or the one that minds it, is killed in so many tries."""

    tries: Path
    kills: int
    minder: bool
    owner: str = "a"

    result_type: ClassVar[Any] = int

    def __call__(self, inputs: Any, beat: Any) -> int:
        """Return the number of the try."""
        beat(7)
        with self.tries.open("a") as file:
            file.write("x")
        tries = len(self.tries.read_text())
        if tries <= self.kills:
            os.kill(os.getppid() if self.minder else os.getpid(), signal.SIGKILL)
            signal.pause()
        return tries


@pytest.mark.parametrize("minder", [False, True])
@pytest.mark.parametrize("kills", [1, 2, 3])
def test_a_run_whose_process_is_killed_is_repeated_twice(
    tmp_path: Path, kills: int, *, minder: bool
) -> None:
    """Killed once or twice it has its result, a third time it fails; the next is carried out."""
    tasks = [Killed(tmp_path / "a", kills, minder), Killed(tmp_path / "b", 0, minder)]
    with LocalEngine({}, 1, Limits(timeout_s=30.0)) as engine:
        first, second = sorted(engine.run(tasks, stop=False), key=lambda outcome: outcome.index)
    if kills < 3:
        assert (first.result, first.failure) == (kills + 1, None)
    else:
        assert first.failure is not None
        assert first.failure.frame == 7
        assert "killed" in first.failure.reason or "SIGKILL" in first.failure.reason
    assert len((tmp_path / "a").read_text()) == min(kills + 1, 3)
    assert second.result == 1


@dataclass(frozen=True)
class Hangs:
    """A task that says by which process it is carried out, and never ends."""

    folder: Path
    owner: str = "a"

    result_type: ClassVar[Any] = int

    def __call__(self, inputs: Any, beat: Any) -> int:
        """Leave a file named by the process."""
        (self.folder / str(os.getpid())).touch()
        return signal.pause() or 0


def test_what_is_interrupted_is_not_repeated(tmp_path: Path) -> None:
    """A task and a second one behind it: `run` raises, and no other process is started for them."""
    with LocalEngine({}, 1, Limits(timeout_s=30.0)) as engine:

        def interrupt() -> None:
            while not list(tmp_path.iterdir()):
                time.sleep(0.01)
            engine.interrupt()

        thread = threading.Thread(target=interrupt)
        thread.start()
        with pytest.raises(InterruptedError):
            list(engine.run([Hangs(tmp_path), Hangs(tmp_path)]))
        thread.join()
    (pid,) = tmp_path.iterdir()
    with pytest.raises(ProcessLookupError):
        os.kill(int(pid.name), 0)
