"""What a run costs beside its own work on a Dask cluster."""

import importlib
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from lodbench.analysis.study.engine.cluster.dask_engine import DaskEngine
from lodbench.analysis.study.engine.local.local_engine import LocalEngine
from lodbench.analysis.study.engine.task import Engine
from lodbench.base.user_code import load_object

TASKS = '''
from dataclasses import dataclass

@dataclass(frozen=True)
class Sum:
    """The sum of the inputs and a number: a run without work."""
    owner: str
    number: int
    result_type = float

    def __call__(self, inputs, beat):
        beat(0)
        return float(inputs["ramp"].sum()) + self.number
'''

RUNS, POLICIES, ROUNDS = 200, 4, 4


def costs(function: Callable[[], Any]) -> tuple[float, float]:
    """Return wall and processor time of this process, in milliseconds a run."""
    wall, cpu = time.perf_counter(), time.process_time()
    function()
    return 1e3 * (time.perf_counter() - wall) / RUNS, 1e3 * (time.process_time() - cpu) / RUNS


def test_a_run_costs_less_here_than_a_plain_dask_task(
    tmp_path: Path, start_cluster: Callable[..., Any]
):
    """Of 200 runs of 4 policies; in all about what it costs locally, and a message of Dask's."""
    (tmp_path / "tasks.py").write_text(TASKS)
    distributed: Any = importlib.import_module("distributed")
    cls: Any = load_object(f"{tmp_path / 'tasks.py'}:Sum", "task")
    tasks = [cls(f"policy-{i * POLICIES // RUNS}", i) for i in range(RUNS)]
    inputs = {"ramp": np.arange(1000.0)}
    with (
        start_cluster() as cluster,
        distributed.Client(cluster) as client,
        DaskEngine(inputs, cluster.scheduler_address) as spread,
        LocalEngine(inputs, 2) as local,
    ):

        def plain() -> None:
            futures = [client.submit(sum, (i, 1), pure=False) for i in range(RUNS)]
            assert len(list(distributed.as_completed(futures, with_results=True))) == RUNS

        def run_on(engine: Engine) -> None:
            assert len(list(engine.run(tasks))) == RUNS

        kinds = (lambda: run_on(spread), lambda: run_on(local), plain)
        rounds = [[costs(kind) for kind in kinds] for _ in range(ROUNDS)]
    # The quickest of each, since other work on the machine only adds.
    walls = [min(round_[kind][0] for round_ in rounds) for kind in range(3)]
    cpus = [min(round_[kind][1] for round_ in rounds) for kind in range(3)]
    print(
        "a run, here and in all: "
        + ", ".join(
            f"{name} {cpu:.2f} of {wall:.1f} ms"
            for name, wall, cpu in zip(("cluster", "local", "plain Dask"), walls, cpus, strict=True)
        )
    )
    assert cpus[0] < cpus[2]
    assert walls[0] < 1.5 * (walls[1] + walls[2])
