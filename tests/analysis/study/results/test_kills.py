"""Studies that are killed: they end with the bytes of an undisturbed one and leave nothing behind.

`make studies` kills 300 times; the table of `docs/kills.md` is what it prints.
"""

import json
import os
import signal
import subprocess
import sys
import time
import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

import pytest

PROGRAM = Path(__file__).with_name("kill_program.py")
MARK = "LODBENCH_KILL_STUDY"
WHOLE, REDUCED = 50, 2  # kills of each kind
ENDS_S = 5.0  # in which the processes of a study that was killed have to be gone
PATIENCE_S = 120.0

Lines = list[dict[str, Any]]


class Started:
    """A study that runs, with all processes that belong to it.

    Its processes are found by a word in their environment, which what they fork has too.
    """

    def __init__(self, kind: str, folder: Path, step: int | None = None) -> None:
        self._mark = f"{MARK}={uuid.uuid4().hex}"
        name, _, value = self._mark.partition("=")
        scratch = folder.with_name("scratch")
        for path in (folder, scratch):
            path.mkdir(exist_ok=True)
        arguments = [kind, str(folder), *([] if step is None else [str(step)])]
        self.began_s = time.monotonic()
        self.struck = False  # one of its other processes was killed
        self.process = subprocess.Popen(
            [sys.executable, PROGRAM, *arguments],
            env={**os.environ, name: value, "TMPDIR": str(scratch)},
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        assert self.process.stdout is not None
        self.process.stdout.readline()  # it begins

    def others(self) -> list[int]:
        """Return its processes but for the first."""
        return [pid for pid in processes_of(self._mark) if pid != self.process.pid]

    def end(self) -> tuple[int, Lines]:
        """Return the exit status and what it printed; no process may be left."""
        out, _ = self.process.communicate(timeout=PATIENCE_S)
        until = time.monotonic() + ENDS_S
        while self.others():
            assert time.monotonic() < until, "processes are left"
            time.sleep(0.02)
        return self.process.returncode, [json.loads(line) for line in out.splitlines()]


def processes_of(mark: str) -> Iterator[int]:
    """Yield the processes that have this in their environment."""
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit():
            try:
                ends = (folder / "stat").read_text().rpartition(")")[2].split()[0] == "Z"
                if not ends and mark.encode() in (folder / "environ").read_bytes():
                    yield int(folder.name)
            except (OSError, UnicodeError):
                continue


@dataclass(frozen=True)
class Undisturbed:
    """A study that nobody killed: its files, how long it took, and how many steps."""

    files: dict[str, bytes]
    took_s: float
    steps: int


def files_of(folder: Path) -> dict[str, bytes]:
    """Return every file and folder below one, hidden ones too, but for what has times in it."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() if path.is_file() else b"folder"
        for path in sorted(folder.rglob("*"))
        if path.name != "run-info.json"
    }


@cache
def undisturbed(kind: str) -> Undisturbed:
    """Carry out a study without disturbing it."""
    with TemporaryDirectory() as place:
        started = Started(kind, Path(place) / "study")
        code, lines = started.end()
        took_s = time.monotonic() - started.began_s
        assert code == 0
        return Undisturbed(files_of(Path(place) / "study"), took_s, lines[-1]["steps"])


def kill_parent(kind: str, folder: Path, random: Random) -> Started:
    """Kill the study itself at a random instant."""
    started = Started(kind, folder)
    time.sleep(random.uniform(0.0, undisturbed(kind).took_s))
    started.process.kill()
    return started


def kill_at_step(kind: str, folder: Path, random: Random) -> Started:
    """Let the study kill itself before a random step of the file system."""
    return Started(kind, folder, random.randrange(undisturbed(kind).steps))


def kill_worker(kind: str, folder: Path, random: Random) -> Started:
    """Kill one of the processes that the study has started, at a random instant."""
    started = Started(kind, folder)
    time.sleep(random.uniform(0.0, 0.7 * undisturbed(kind).took_s))
    others = started.others()
    while not others and started.process.poll() is None:  # none has been started yet
        time.sleep(0.01)
        others = started.others()
    if others:
        os.kill(random.choice(others), signal.SIGKILL)
        started.struck = True
    return started


KILLS: dict[str, Callable[[str, Path, Random], Started]] = {
    "parent": kill_parent,
    "step": kill_at_step,
    "worker": kill_worker,
}


@dataclass
class Tally:
    """What a number of kills came to."""

    kills: int = 0
    repeated: int = 0  # runs that were carried out again
    lost: int = 0  # of these, runs that had been called done


def count_results(lines: Lines) -> int:
    """Return how many results came in; a line more a round says that all are durable."""
    rounds = len({line["of"] for line in lines if "done" in line})
    return max(sum("done" in line for line in lines) - max(rounds, 1), 0)


def most(lines: Lines, key: str) -> int:
    """Return the largest number of that name in what was printed."""
    return max((line.get(key, 0) for line in lines), default=0)


def disturb(kind: str, victim: str, random: Random, place: Path, tally: Tally) -> None:
    """Kill a study, and have it go on, until it is done; then look at what is there."""
    folder = place / "study"
    started = KILLS[victim](kind, folder, random)
    code, lines = started.end()
    tally.kills += started.struck
    total, results = most(lines, "of"), count_results(lines)
    while code != 0:
        assert code == -signal.SIGKILL, lines
        tally.kills += 1
        done = most(lines, "done")
        again = random.random() < 0.2  # it is killed once more
        started = kill_at_step(kind, folder, random) if again else Started(kind, folder)
        code, lines = started.end()
        total = max(total, most(lines, "of"))
        results += count_results(lines)
        tally.lost += max(count_results(lines) - (total - done), 0)
    tally.repeated += max(results - total, 0)
    assert files_of(folder) == undisturbed(kind).files
    assert not list((place / "scratch").iterdir())


@pytest.mark.slow
@pytest.mark.study
@pytest.mark.skipif(sys.platform != "linux", reason="finds processes in /proc")
@pytest.mark.parametrize("victim", KILLS)
@pytest.mark.parametrize("kind", ["compare", "sweep"])
def test_a_killed_study_ends_as_one_that_was_not(
    kind: str, victim: str, tmp_path: Path, *, full_studies: bool
) -> None:
    """Its bytes are the same, no result that was called done is repeated, and nothing is left."""
    tally = Tally()
    kills = WHOLE if full_studies else REDUCED
    seed = 0
    while tally.kills < kills:
        place = tmp_path / str(seed)
        place.mkdir()
        disturb(kind, victim, Random(f"{kind} {victim} {seed}"), place, tally)
        seed += 1
    assert tally.lost == 0
    print(f"| {kind} | {victim} | {tally.kills} | {tally.repeated} | 0 | 0 | 0 |")
