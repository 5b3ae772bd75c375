"""Studies that are killed: they end with the bytes of an undisturbed one and leave nothing behind.

`make studies` kills at 300 instants and before each step of the file system; the table of
`docs/kills.md` is what it prints.
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
WHOLE, REDUCED = 50, 2  # kills of each kind at an instant
EVERY = 48  # of the steps of the file system, the one that is killed in the reduced form
NEVER = -1  # a step that no study takes
PARTS = 4  # in which the steps are divided, to be killed side by side
ENDS_S = 5.0  # in which the processes of a study that was killed have to be gone
PATIENCE_S = 120.0

NAMES = {"compare": "comparison", "sweep": "sweep"}
"""Of the studies, in the table."""

Lines = list[dict[str, Any]]


class Started:
    """A study that runs, with all processes that belong to it.

    Its processes are found by a word in their environment, which what they fork has too.
    """

    def __init__(
        self, kind: str, folder: Path, step: int | None = None, scheduler: str = "-"
    ) -> None:
        self._mark = f"{MARK}={uuid.uuid4().hex}"
        name, _, value = self._mark.partition("=")
        scratch = folder.with_name("scratch")
        for path in (folder, scratch):
            path.mkdir(exist_ok=True)
        arguments = [kind, str(folder), "-" if step is None else str(step), scheduler]
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
    """A study that nobody killed: its files, and how long it took."""

    files: dict[str, bytes]
    took_s: float


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
        code, _ = started.end()
        took_s = time.monotonic() - started.began_s
        assert code == 0
        return Undisturbed(files_of(Path(place) / "study"), took_s)


@cache
def count_steps(kind: str) -> int:
    """Return how many steps of the file system a study takes that nobody disturbs."""
    with TemporaryDirectory() as place:
        code, lines = Started(kind, Path(place) / "study", NEVER).end()
        assert code == 0
        assert files_of(Path(place) / "study") == undisturbed(kind).files
        return lines[-1]["steps"]


def kill_parent(kind: str, folder: Path, random: Random) -> Started:
    """Kill the study itself at a random instant."""
    started = Started(kind, folder)
    time.sleep(random.uniform(0.0, undisturbed(kind).took_s))
    started.process.kill()
    return started


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


Kill = Callable[[str, Path, Random], Started]

KILLS: dict[str, Kill] = {
    "the study, at an instant": kill_parent,
    "one of its processes, at an instant": kill_worker,
}
"""By what is killed and when, in the words of the table."""


@dataclass
class Tally:
    """What a number of kills came to."""

    kills: int = 0
    repeated: int = 0  # runs that were carried out again
    lost: int = 0  # of these, runs that had been called done

    def row(self, kind: str, victim: str) -> str:
        """Return a row of the table; whatever its zeros stand for would have failed before."""
        cells = (NAMES[kind], victim, self.kills, self.repeated, self.lost, 0, 0)
        return f"| {' | '.join(map(str, cells))} |"


def count_results(lines: Lines) -> int:
    """Return how many results came in; one line more says that all are durable."""
    return max(sum("done" in line for line in lines) - 1, 0)


def most(lines: Lines, key: str) -> int:
    """Return the largest number of that name in what was printed."""
    return max((line.get(key, 0) for line in lines), default=0)


def disturb(kind: str, kill: Kill, random: Random, place: Path, tally: Tally) -> None:
    """Kill a study, and have it go on, until it is done; then look at what is there."""
    place.mkdir()
    folder = place / "study"
    started = kill(kind, folder, random)
    code, lines = started.end()
    tally.kills += started.struck
    total, results = most(lines, "of"), count_results(lines)
    while code != 0:
        assert code == -signal.SIGKILL, lines
        tally.kills += 1
        done = most(lines, "done")
        again = random.random() < 0.2  # it is killed once more
        step = random.randrange(count_steps(kind)) if again else None
        started = Started(kind, folder, step)
        code, lines = started.end()
        total = max(total, most(lines, "of"))
        results += count_results(lines)
        tally.lost += max(count_results(lines) - (total - done), 0)
    tally.repeated += max(results - total, 0)
    assert files_of(folder) == undisturbed(kind).files
    assert not list((place / "scratch").iterdir())


pytestmark = [
    pytest.mark.slow,
    pytest.mark.study,
    pytest.mark.skipif(sys.platform != "linux", reason="finds processes in /proc"),
]


@pytest.mark.parametrize("victim", KILLS)
@pytest.mark.parametrize("kind", NAMES)
def test_a_killed_study_ends_as_one_that_was_not(
    kind: str, victim: str, tmp_path: Path, *, full_studies: bool
) -> None:
    """Its bytes are the same, no result that was called done is repeated, and nothing is left."""
    tally = Tally()
    kills = WHOLE if full_studies else REDUCED
    seed = 0
    while tally.kills < kills:
        random = Random(f"{kind} {victim} {seed}")
        disturb(kind, KILLS[victim], random, tmp_path / str(seed), tally)
        seed += 1
    assert tally.lost == 0
    print(tally.row(kind, victim))


@pytest.mark.parametrize("part", range(PARTS))
@pytest.mark.parametrize("kind", NAMES)
def test_a_study_may_be_killed_before_each_step_of_the_file_system(
    kind: str, part: int, tmp_path: Path, *, full_studies: bool
) -> None:
    """Each step that an undisturbed study takes, in turn; in the reduced form, each 48th."""
    tally = Tally()
    every = 1 if full_studies else EVERY
    steps = range(part * every, count_steps(kind), PARTS * every)
    for step in steps:

        def kill(kind: str, folder: Path, _: Random, step: int = step) -> Started:
            return Started(kind, folder, step)

        before = tally.kills
        disturb(kind, kill, Random(f"{kind} {step}"), tmp_path / str(step), tally)
        assert tally.kills > before, f"step {step} was not taken"
    assert tally.lost == 0
    print(tally.row(kind, f"the study, before each step, part {part + 1} of {PARTS}"))


class Spread:
    """Two Dask workers that are started again when they are killed, and what they have started.

    Attributes
    ----------
    address : str
        Of the scheduler.
    """

    def __init__(self, cluster: Any, mark: str) -> None:
        self._cluster, self._mark = cluster, mark
        self.address: str = cluster.scheduler_address

    def pids(self) -> list[int]:
        """Return the processes of the Dask workers that are there."""
        return [nanny.pid for nanny in self._cluster.workers.values() if nanny.pid]

    def wait(self) -> None:
        """Return when both workers are there, and no process of a policy is."""
        until = time.monotonic() + PATIENCE_S
        while (state := self._state()) != (2, 2, []):
            assert time.monotonic() < until, f"workers known, their processes, policies': {state}"
            time.sleep(0.05)

    def _state(self) -> tuple[int, int, list[int]]:
        return len(self._cluster.scheduler.workers), len(self.pids()), self.policies()

    def policies(self) -> list[int]:
        """Return processes that a fork server has started; itself it is a Dask worker's child."""
        workers, found = self.pids(), list[int]()
        for pid in processes_of(self._mark):
            try:
                forked = b"fork_server" in Path(f"/proc/{pid}/cmdline").read_bytes()
                stat = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            if forked and int(stat[1]) not in workers:
                found.append(pid)
        return found


@pytest.fixture(scope="module")
def spread(start_cluster: Callable[..., Any]) -> Iterator[Spread]:
    """Yield a cluster of two workers whose processes have a mark."""
    mark = f"{MARK}={uuid.uuid4().hex}"
    name, _, value = mark.partition("=")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(name, value)
        with start_cluster() as cluster:
            yield Spread(cluster, mark)


@pytest.mark.parametrize("kind", NAMES)
def test_a_study_outlives_the_dask_workers_that_are_killed(
    kind: str, tmp_path: Path, spread: Spread, *, full_studies: bool
) -> None:
    """One of two, at a random instant: the study ends by itself, with the bytes of one machine.

    All its results are there though their worker is not, no process of a policy is left on the
    cluster, and the worker is started again.
    """
    tally, took_s, seed = Tally(), undisturbed(kind).took_s, 0
    while tally.kills < (WHOLE if full_studies else REDUCED):
        spread.wait()
        random, place = Random(f"{kind} dask {seed}"), tmp_path / str(seed)
        place.mkdir()
        started = Started(kind, place / "study", scheduler=spread.address)
        if seed:
            time.sleep(random.uniform(0.0, took_s))
            if started.process.poll() is None:
                os.kill(random.choice(spread.pids()), signal.SIGKILL)
                tally.kills += 1
        else:  # undisturbed: what is looked for afterwards is seen while it is there
            while not spread.policies():
                assert started.process.poll() is None
        code, lines = started.end()
        took_s = time.monotonic() - started.began_s
        assert code == 0
        assert count_results(lines) == most(lines, "of")  # each comes once
        assert files_of(place / "study") == undisturbed(kind).files
        assert not list((place / "scratch").iterdir())
        seed += 1
    spread.wait()
    print(tally.row(kind, "a Dask worker, at an instant"))
