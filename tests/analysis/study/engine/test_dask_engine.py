"""Studies on a Dask cluster: the results of one machine, and what becomes of what is lost."""

import importlib
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, cast

import numpy as np
import pytest

from lodbench.analysis.study.engine.cluster import dask_engine
from lodbench.analysis.study.engine.cluster.dask_engine import DaskEngine
from lodbench.analysis.study.engine.limits import Limits
from lodbench.analysis.study.engine.local.local_engine import LocalEngine
from lodbench.analysis.study.engine.task import Outcome
from lodbench.base.errors import InputError
from lodbench.base.user_code import load_object

pytestmark = pytest.mark.slow

StartCluster = Callable[..., Any]

INPUTS = {"ramp": np.arange(1000.0)}

TASKS = '''
import ctypes, os, signal, time
from dataclasses import dataclass
from pathlib import Path

@dataclass(frozen=True)
class Add:
    """The sum of the ramp and a number, or whatever else `do` says."""
    owner: str
    number: int
    do: str = ""
    where: str = ""
    result_type = tuple[float, int, str]

    def __call__(self, inputs, beat):
        beat(0)
        beat(self.number)
        if self.do == "exit":
            os._exit(0)
        if self.do == "hang":
            time.sleep(1000)
        if self.do == "crash":
            os.kill(os.getpid(), signal.SIGSEGV)
        if self.do == "raise":
            raise KeyError(self.number)
        if self.do == "nap":
            time.sleep(0.2)
        if self.do == "wait":
            Path(self.where, f"{self.number}-{os.getpid()}").touch()
            while not Path(self.where, "go").exists():
                time.sleep(0.02)
        if self.do == "kill":
            os.kill(int(Path(self.where, "worker").read_text()), signal.SIGKILL)
            time.sleep(1000)
        return float(inputs["ramp"].sum()) + self.number, os.getpid(), os.getcwd()
'''
"""A user's file, that no worker has."""


@pytest.fixture
def add(tmp_path: Path) -> Any:
    """Return the class of tasks, whose file has been removed."""
    path = tmp_path / "tasks.py"
    path.write_text(TASKS, encoding="utf-8")
    cls = load_object(f"{path}:Add", "task")
    path.unlink()
    return cls


@pytest.fixture(scope="module")
def cluster(start_cluster: StartCluster) -> Generator[Any]:
    """Yield a cluster of two workers with a thread each, as `dask worker` starts them."""
    with start_cluster() as started:
        yield started


def by_index(outcomes: Sequence[Outcome]) -> list[tuple[int, Any, str]]:
    """Return what the engines have to agree on, in the order of tasks."""
    ordered = sorted(outcomes, key=lambda outcome: outcome.index)
    return [(o.index, o.result and o.result[0], str(o.failure)) for o in ordered]


def wait_for(condition: Callable[[], Any], seconds: float = 20.0) -> Any:
    """Return the first true value of a condition."""
    until = time.monotonic() + seconds
    while not (value := condition()):
        assert time.monotonic() < until, "waited in vain"
        time.sleep(0.05)
    return value


def ended(pid: int) -> bool:
    """Whether a process is gone or waits to be buried."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True


def test_outcomes_are_those_of_one_machine(cluster: Any, add: Any) -> None:
    """Three owners, one of which fails in its fourth task; with and without stopping there."""
    tasks = [add(f"owner-{i % 3}", i, "raise" if i in {10, 16} else "") for i in range(60)]
    for stop in (True, False):
        with LocalEngine(INPUTS, 2) as engine:
            local = by_index(list(engine.run(tasks, stop=stop)))
        with DaskEngine(INPUTS, cluster.scheduler_address) as engine:
            assert by_index(list(engine.run(tasks, stop=stop))) == local
            assert by_index(list(engine.run(tasks[:4], stop=stop))) == local[:4]
        assert len(local) == (44 if stop else 60)
        assert local[10] == (10, None, "frame 10: KeyError: 10")
        assert local[2] == (2, 499_502.0, "None")


def test_a_hostile_policy_fails_alone(cluster: Any, add: Any) -> None:
    """Each ends or hangs its own process; the Dask workers live, and the others are finished."""
    tasks = [
        *(add("good", i) for i in range(20)),
        *(add(do, 3, do) for do in ("exit", "crash", "hang")),
    ]
    before = [nanny.pid for nanny in cluster.workers.values()]
    with DaskEngine(INPUTS, cluster.scheduler_address, Limits(timeout_s=1.0)) as engine:
        found = by_index(list(engine.run(tasks)))
    assert [nanny.pid for nanny in cluster.workers.values()] == before
    assert [failure for _, _, failure in found[20:]] == [
        "frame 3: process ended with status 0 before its result",
        "frame 3: process ended by SIGSEGV",
        "frame 3: no frame for 1 s (--policy-timeout)",
    ]
    assert [result for _, result, _ in found[:20]] == [499_500.0 + i for i in range(20)]


def test_no_two_owners_share_a_process_and_no_policy_runs_in_a_dask_worker(
    cluster: Any, add: Any
) -> None:
    """Pids of tasks are those of neither workers nor another owner's, and few for one owner."""
    tasks = [add(f"owner-{i // 30}", i) for i in range(90)]
    with DaskEngine(INPUTS, cluster.scheduler_address) as engine:
        outcomes = list(engine.run(tasks))
    pids = [{o.result[1] for o in outcomes if o.index // 30 == owner} for owner in range(3)]
    workers = {worker.pid for worker in cluster.workers.values()}
    assert not pids[0] & pids[1]
    assert not (pids[0] | pids[1]) & pids[2]
    assert not workers & (pids[0] | pids[1] | pids[2])
    assert max(map(len, pids)) <= 4
    wait_for(lambda: all(ended(pid) for owner in pids for pid in owner))


def test_a_study_that_is_left_leaves_nothing_running(cluster: Any, add: Any) -> None:
    """Of an engine that is left in the middle, all processes end, though they would hang."""
    hanging = [add("quick", 0), *(add(f"owner-{i}", i, "hang") for i in range(4))]
    with DaskEngine(INPUTS, cluster.scheduler_address) as engine:
        outcomes: Any = engine.run(hanging)
        next(outcomes)
        wait_for(lambda: len(workers_of(cluster)) == 2)
        outcomes.close()
    wait_for(lambda: not workers_of(cluster), 5.0)


@pytest.mark.parametrize(
    ("number", "within_s"), [(signal.SIGINT, 2.0), (signal.SIGTERM, 10.0), (signal.SIGKILL, 10.0)]
)
def test_a_client_that_ends_leaves_nothing_running(
    cluster: Any, tmp_path: Path, number: int, within_s: float
) -> None:
    """Nobody waits for its tasks any more: their processes end though they would hang.

    They do so as soon as it is interrupted, and are not started again; a client that cannot tell
    anybody is missed by the scheduler.
    """
    (tmp_path / "tasks.py").write_text(TASKS)
    (tmp_path / "client.py").write_text(
        "import signal\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # deaf in the background
        "from lodbench.analysis.study.engine.cluster.dask_engine import DaskEngine\n"
        "from lodbench.base.user_code import load_object\n"
        f"add = load_object({str(tmp_path / 'tasks.py')!r} + ':Add', 'task')\n"
        f"with DaskEngine({{}}, {cluster.scheduler_address!r}) as engine:\n"
        "    list(engine.run([add(f'owner-{i}', i, 'hang') for i in range(4)]))\n"
    )
    command = [sys.executable, str(tmp_path / "client.py")]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as client:
        victims = wait_for(lambda: (pids := workers_of(cluster)) and len(pids) == 2 and pids, 60.0)
        client.send_signal(number)
        wait_for(lambda: all(map(ended, victims)) and not workers_of(cluster), within_s)
    assert not workers_of(cluster)


def workers_of(cluster: Any) -> list[int]:
    """Return the pids of processes that Dask workers have started and that carry out tasks."""
    servers = [child for nanny in cluster.workers.values() for child in children_of(nanny.pid)]
    minders = [child for server in servers for child in children_of(server)]
    return [child for minder in minders for child in children_of(minder)]


def children_of(pid: int) -> list[int]:
    """Return the pids of a process's children."""
    found: list[int] = []
    for path in Path(f"/proc/{pid}/task").glob("*/children"):
        found += map(int, path.read_text().split())
    return found


@dataclass(frozen=True)
class Typed:
    """A task of a module that no worker can import, as of a notebook."""

    owner: str
    number: int

    result_type: ClassVar[Any] = int

    def __call__(self, inputs: Any, beat: Any) -> int:
        """Return the number."""
        return self.number


def test_a_class_without_a_file_there_travels_as_it_is(cluster: Any) -> None:
    """What was typed into a notebook is found by no import, and is not looked for."""
    with DaskEngine({}, cluster.scheduler_address) as engine:
        assert [outcome.result for outcome in engine.run([Typed("owner", 7)])] == [7]


def test_a_module_that_is_not_there_is_named(
    cluster: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A class of a module that is installed here alone is refused in one line."""
    (tmp_path / "only_here.py").write_text(TASKS)
    monkeypatch.syspath_prepend(str(tmp_path))
    task = importlib.import_module("only_here").Add("owner", 1)
    with (
        DaskEngine(INPUTS, cluster.scheduler_address) as engine,
        pytest.raises(
            InputError, match=r"policy owner: .*got No module named 'only_here'; install"
        ),
    ):
        list(engine.run([task]))


def test_a_cluster_that_adapts_starts_its_workers(add: Any, start_cluster: StartCluster) -> None:
    """From none, when the study has asked for something."""
    tasks = [add("owner", i) for i in range(4)]
    with start_cluster(n_workers=0) as cluster:
        cluster.adapt(minimum=0, maximum=1, interval="200ms")
        with DaskEngine(INPUTS, cluster.scheduler_address) as engine:
            found = by_index(list(engine.run(tasks)))
    assert found == [(i, 499_500.0 + i, "None") for i in range(4)]


def test_few_tasks_are_on_their_way_at_a_time(cluster: Any, add: Any) -> None:
    """Of 2,000 tasks, no more futures than twice the threads of the cluster, whatever they take."""
    tasks = [add("owner", i) for i in range(2000)]
    most, inside = 0, cast("Any", DaskEngine(INPUTS, cluster.scheduler_address))
    with inside as engine:
        told = 0
        for _ in engine.run(tasks):
            told += 1
            most = max(most, len(engine._flying))
    assert told == 2000
    assert 1 <= most <= dask_engine.AHEAD * 2


def test_what_a_killed_worker_did_is_done_again(
    tmp_path: Path, add: Any, start_cluster: StartCluster
) -> None:
    """Its runs in flight come back from elsewhere, and its processes end with it."""
    tasks = [add("owner", i, "wait", str(tmp_path)) for i in range(6)]
    with (
        start_cluster() as cluster,
        DaskEngine(INPUTS, cluster.scheduler_address) as engine,
    ):
        outcomes = engine.run(tasks)
        first: list[Outcome] = []

        def begun() -> list[Path]:
            return [path for path in tmp_path.iterdir() if "-" in path.name]

        thread = threading.Thread(target=lambda: first.extend(outcomes))
        thread.start()
        wait_for(lambda: len(begun()) == 2)
        victims = {int(path.name.partition("-")[2]) for path in begun()}
        os.kill(cluster.workers[0].pid, signal.SIGKILL)
        wait_for(lambda: sum(map(ended, victims)) == 1)
        (tmp_path / "go").touch()
        thread.join(60.0)
        assert by_index(first) == [(i, 499_500.0 + i, "None") for i in range(6)]


def test_a_worker_that_comes_late_helps(add: Any, start_cluster: StartCluster) -> None:
    """It gets the inputs on its first task; the only thread of each worker has one process."""
    tasks = [add("owner", i, "nap") for i in range(60)]
    with (
        start_cluster(n_workers=1) as cluster,
        DaskEngine(INPUTS, cluster.scheduler_address) as engine,
    ):
        outcomes = engine.run(tasks)
        found = [next(outcomes)]
        cluster.scale(2)
        found += outcomes
    assert by_index(found) == [(i, 499_500.0 + i, "None") for i in range(60)]
    assert len({outcome.result[1] for outcome in found}) == 2


def test_a_task_that_ends_every_worker_fails(
    tmp_path: Path, add: Any, start_cluster: StartCluster
) -> None:
    """Where the machine itself ends under a task, it is that task's failure after some tries."""
    config: Any = importlib.import_module("dask.config")
    tasks = [*(add("good", i) for i in range(8)), add("bad", 1, "kill", str(tmp_path))]
    with (
        config.set({"distributed.scheduler.allowed-failures": 0}),
        start_cluster(n_workers=1) as cluster,
        DaskEngine(INPUTS, cluster.scheduler_address) as engine,
    ):
        good = list(engine.run(tasks[:8]))
        (tmp_path / "worker").write_text(str(cluster.workers[0].pid))
        outcomes = list(engine.run(tasks))
    assert by_index(outcomes)[:8] == by_index(good)
    (failure,) = [o.failure for o in outcomes if o.index == 8]
    assert str(failure).startswith("reset: Dask workers ended one after the other")
