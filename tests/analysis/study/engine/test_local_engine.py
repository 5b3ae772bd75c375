"""Tasks in processes of their own: who shares what with whom, and what comes back."""

import os
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from lodbench.analysis.study.engine.limits import Limits
from lodbench.analysis.study.engine.local import launch
from lodbench.analysis.study.engine.local.local_engine import LocalEngine
from lodbench.analysis.study.engine.task import NotApplicableError, Outcome
from lodbench.base.errors import InputError, PolicyError
from lodbench.policies.policy_spec import PolicySpec

LIMITS = Limits(timeout_s=30.0)


@dataclass(frozen=True)
class Does:
    """A task of one owner that calls a function."""

    owner: str
    function: Callable[[Any], Any]

    result_type: ClassVar[Any] = Any

    def __call__(self, inputs: Any, beat: Any) -> Any:
        """Begin a frame and call it."""
        beat(0)
        return self.function(inputs)


def run(*tasks: Does, workers: int = 2, stop: bool = True, **inputs: Any) -> list[Outcome]:
    """Return outcomes by index."""
    with LocalEngine(inputs, workers, LIMITS) as engine:
        return sorted(engine.run(tasks, stop=stop), key=lambda outcome: outcome.index)


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_no_two_owners_share_a_process(workers: int) -> None:
    """Processes of one owner are of no other, and none is this one, however many there are."""
    tasks = [Does(owner, lambda _: os.getpid()) for owner in "aabbaccab"]
    pids: dict[str, set[int]] = {}
    for outcome in run(*tasks, workers=workers):
        pids.setdefault(tasks[outcome.index].owner, set()).add(outcome.result)
    every = [pid for of_owner in pids.values() for pid in of_owner]
    assert len(every) == len(set(every))
    assert os.getpid() not in every
    assert len(pids["b"]) == 1 or workers > 1


def test_a_process_stays_with_its_owner() -> None:
    """From one call to the next it is the same, so that a search pays for one start."""
    with LocalEngine({}, 1, LIMITS) as engine:
        pids = {next(iter(engine.run([Does("a", lambda _: os.getpid())]))).result for _ in "123"}
    assert len(pids) == 1


def fails(_: Any) -> None:
    """Fail at once."""
    raise PolicyError("a", 12, "broken")


def fails_late(_: Any) -> None:
    """Fail after all others are finished."""
    time.sleep(0.3)
    raise PolicyError("a", 34, "broken late")


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_the_same_is_told_on_any_number_of_workers(workers: int) -> None:
    """An owner's first failure is that of the first task, and tasks after it have no outcome."""
    functions = [abs, fails_late, fails, abs, abs]
    tasks = [Does("a", lambda _: 1), *(Does("a", f) for f in functions[1:]), Does("b", lambda _: 2)]
    told = [
        (outcome.index, outcome.result, str(outcome.failure or ""))
        for outcome in run(*tasks, workers=workers)
    ]
    assert told == [(0, 1, ""), (1, None, "frame 34: broken late"), (5, 2, "")]
    every = run(*tasks, workers=workers, stop=False)
    assert [outcome.index for outcome in every] == [0, 1, 2, 3, 4, 5]


def not_applicable(_: Any) -> None:
    """Say that the policy does not fit."""
    raise NotApplicableError("a flat scene")


def test_how_a_task_can_end() -> None:
    """Each way to end has its failure; bad input is the caller's."""
    ends: list[Callable[[Any], Any]] = [
        fails,
        not_applicable,
        lambda _: os._exit(5),
        lambda _: object(),
        lambda _: 1 / 0,
    ]
    failures = [outcome.failure for outcome in run(*map(Does, "abcde", ends))]
    assert [str(failure) for failure in failures] == [
        "frame 12: broken",
        "a flat scene",
        "frame 0: process ended with status 5 before its result",
        "frame 0: TypeError: expected numbers, text and arrays, got object",
        "frame 0: ZeroDivisionError: division by zero",
    ]

    def refuses(_: Any) -> None:
        raise InputError("expected more", path="a.toml", line=3)

    with pytest.raises(InputError, match=r"^a\.toml:3: expected more$"):
        run(Does("a", refuses))


def test_who_cannot_be_made_fails_alone() -> None:
    """What a constructor raises is no bad input, which would end the study: of whatever kind."""

    class Unmade:
        """Is never made."""

        def __init__(self, error: BaseException) -> None:
            raise error

    for error in (MemoryError(), KeyError(1), ValueError("odd"), SystemExit(2), GeneratorExit()):
        spec = PolicySpec("unmade", "unmade", Unmade, {"error": error})
        tasks = Does("a", lambda _, spec=spec: spec.make()), Does("b", lambda _: 1)
        failed, done = run(*tasks, stop=False)
        assert failed.failure is not None
        assert failed.failure.kind == "failed"
        assert type(error).__name__ in failed.failure.reason
        assert done.result == 1


def test_a_constructor_that_refuses_is_bad_input() -> None:
    """An `InputError` says that the parameters are wrong, whose remedy is another command."""

    class Choosy:
        """Is never made either."""

        def __init__(self) -> None:
            raise InputError("choosy: expected more, got less")

    spec = PolicySpec("choosy", "choosy", Choosy, {})
    with pytest.raises(InputError, match=r"^choosy: expected more, got less$"):
        run(Does("a", lambda _: spec.make()))


def test_what_cannot_be_sent_is_named() -> None:
    """An object that holds what no other process can have is refused with what to do."""
    lock = threading.Lock()
    with pytest.raises(InputError, match=r"policy a: .* keep files, locks"):
        run(Does("a", lambda _: lock.locked()))


def test_inputs_are_shared_and_cannot_be_written() -> None:
    """Each process has them whole, none has a copy of its own, and this one keeps its own."""
    array = np.ones(2**24)

    def look(inputs: Any) -> list[Any]:
        mine = inputs["array"]
        status = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
        own_kib = next(int(line.split()[1]) for line in status if line.startswith("RssAnon"))
        refused = False
        try:
            mine.flags.writeable = True
        except ValueError:
            refused = True
        return [float(mine.sum()), refused, mine.ctypes.data % 64, own_kib, inputs["text"]]

    for outcome in run(Does("a", look), Does("b", look), array=array, text="é"):
        total, refused, offset, own_kib, text = outcome.result
        assert (total, refused, offset, text) == (2.0**24, True, 0, "é")
        assert 1024 * own_kib < array.nbytes
    assert array.flags.writeable


def test_time_and_memory_are_told() -> None:
    """A task that sleeps a fifth of a second and takes 200 MB says so, and another does not."""

    def take(_: Any) -> float:
        time.sleep(0.2)
        return float(np.ones(25 * 2**20).sum())

    greedy, modest = run(Does("a", take), Does("b", lambda _: 0.0))
    assert greedy.took_s >= 0.2
    assert greedy.peak_bytes - modest.peak_bytes > 150e6


def test_surroundings_are_the_callers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Folder, path and environment are those of the moment; arithmetic has one thread in it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("LODBENCH_TEST", "here")
    before = dict(os.environ)

    def look(_: Any) -> list[str]:
        names = ("LODBENCH_TEST", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")
        return [str(Path.cwd()), sys.path[0], *(os.environ[name] for name in names)]

    (outcome,) = run(Does("a", look))
    assert outcome.result == [str(tmp_path), str(tmp_path), "here", "1", "1"]
    assert dict(os.environ) == before


def test_who_hears_no_more_leaves_nothing_behind(tmp_path: Path) -> None:
    """A caller that stops listening, or fails, ends the processes that work for it."""

    def write_and_sleep(_: Any) -> None:
        (tmp_path / str(os.getpid())).touch()
        time.sleep(1000.0)

    with LocalEngine({}, 2, LIMITS) as engine:
        outcomes = engine.run([Does("a", lambda _: 1), Does("b", write_and_sleep)])
        assert next(outcomes).result == 1
        until = time.monotonic() + 20.0
        while not (pids := list(tmp_path.iterdir())) and time.monotonic() < until:
            time.sleep(0.01)
        (pid,) = pids
        assert Path(f"/proc/{pid.name}").exists()
    assert not Path(f"/proc/{pid.name}").exists()


@pytest.mark.slow
def test_workers_that_are_not_forked_do_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no process can fork, each worker is an interpreter of its own, and ends alike."""
    monkeypatch.setattr(launch, "FORKS", False)

    def sleeps(_: Any) -> None:
        time.sleep(1000.0)

    functions: list[Callable[[Any], Any]] = [
        lambda inputs: float(inputs["array"].sum()),
        lambda _: os._exit(5),
        fails,
        sleeps,
    ]
    tasks = list(map(Does, "abcd", functions))
    with LocalEngine({"array": np.ones(1000)}, 2, Limits(timeout_s=5.0)) as engine:
        told = {outcome.index: outcome for outcome in engine.run(tasks)}
    assert told[0].result == 1000.0
    assert [str(told[index].failure) for index in (1, 2, 3)] == [
        "frame 0: process ended with status 5 before its result",
        "frame 12: broken",
        "frame 0: no frame for 5 s (--policy-timeout)",
    ]
