"""Frame logs and results of studies built by hand, and a small world to replay in."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench.analysis.metrics.footing import Footing
from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.metrics.worst_moment import Moment
from lodbench.analysis.study.engine.task import Failure
from lodbench.analysis.study.results.manifest import PARTS, Manifest, write_manifest
from lodbench.analysis.study.results.parts import FINAL, write_part
from lodbench.analysis.study.results.record import Entry, encode
from lodbench.analysis.study.score import Scored
from lodbench.analysis.study.study import Study
from lodbench.base.predictors import GPU_PREDICTORS, LEVEL_PREDICTORS
from lodbench.models.machine.cost import CostModel, CpuCostModel
from lodbench.models.machine.hardware import Display, HardwareProfile, Posterior, Provenance
from lodbench.models.machine.residual import Residual
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import ObjectTypes, Scene
from lodbench.sim.frame_log import COUNTS, TIMES, FrameLog, LogHeader
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.orientation import look_along

MakeLog = Callable[..., FrameLog]
Outcome = Mapping[str, float | None] | Failure
MakeUp = Callable[[Study, Callable[[dict[str, object]], Outcome]], Path]


@pytest.fixture
def make_log() -> MakeLog:
    """Return a builder of frame logs: displays (ms, NaN if dropped), inputs, and any columns."""

    def build(
        display_ms: Any = None,
        *,
        input_ms: Any = None,
        budget_ms: float = 10.0,
        mode: str = "immediate",
        refresh_hz: float = 60.0,
        policy: str = "by-hand",
        memory_bound_bytes: float = 1e9,
        **columns: Any,
    ) -> FrameLog:
        given = display_ms if display_ms is not None else next(iter(columns.values()))
        n = len(np.atleast_1d(given))
        display = np.arange(n) * 10.0 + 10.0 if display_ms is None else np.asarray(display_ms)
        start = np.arange(n) * 10.0 if input_ms is None else np.asarray(input_ms)
        times = np.full((n, len(TIMES)), -1, dtype=np.int64)
        times[:, TIMES.index("input_ns")] = np.round(start * 1e6)
        shown = ~np.isnan(display)
        times[shown, TIMES.index("display_ns")] = np.round(display[shown] * 1e6)
        counts = np.zeros((n, len(COUNTS)))
        counts[:, COUNTS.index("predicted_gpu_ms")] = np.nan
        counts[:, COUNTS.index("benefit_bound")] = np.nan
        for name, values in columns.items():
            counts[:, COUNTS.index(name)] = values
        header = LogHeader(
            policy, "scene", "trace", "machine", budget_ms, 0, mode, refresh_hz, memory_bound_bytes
        )
        return FrameLog(header, times, counts)

    return build


@pytest.fixture(scope="session")
def small_scene() -> Scene:
    """Sixty objects of one type with three levels, in front of the origin along +x."""
    counts = np.zeros((3, len(LEVEL_PREDICTORS)))
    counts[:, LEVEL_PREDICTORS.index("draw_calls")] = 1
    counts[:, LEVEL_PREDICTORS.index("triangles")] = (2000, 500, 100)
    counts[:, LEVEL_PREDICTORS.index("vertices")] = (1000, 250, 50)
    levels = LevelTable(
        start=np.array([0, 3]),
        counts=counts,
        error_m=np.array([0.0, 0.02, 0.1]),
        bytes=counts.sum(axis=1) * 12.0,
        continuous=np.array([False]),
    )
    types = ObjectTypes(("block",), np.zeros((1, 3)), np.array([1.0]), levels)
    x, y = np.meshgrid(np.arange(5.0, 65.0, 6.0), np.arange(-7.5, 8.0, 3.0))
    n = x.size
    return Scene(
        name="small",
        types=types,
        type_index=np.zeros(n, dtype=np.int32),
        position_m=np.column_stack((x.ravel(), y.ravel(), np.ones(n))),
        orientation_xyzw=np.tile([0.0, 0.0, 0.0, 1.0], (n, 1)),
        scale=np.ones(n),
        importance=np.ones(n),
        parent=np.full(n, -1, dtype=np.int32),
        additive=np.zeros(n, dtype=np.bool_),
    )


@pytest.fixture(scope="session")
def turn_trace() -> CameraTrace:
    """Three seconds at the origin: the first looking away from the objects, then at them."""
    time_s = np.arange(181) / 60.0
    heading = np.where(time_s < 1.0, np.pi, 0.0)
    return CameraTrace(
        "turn",
        time_s,
        np.tile([0.0, 0.0, 1.6], (len(time_s), 1)),
        look_along(heading, np.zeros_like(heading)),
        np.append(False, np.diff(heading) != 0.0),
    )


@pytest.fixture(scope="session")
def machine() -> HardwareProfile:
    """Return a machine that takes 13 ms for the sixty objects in full, 1.6 ms at the coarsest."""
    return HardwareProfile(
        name="machine",
        provenance=Provenance("made up for tests", assumed=True),
        gpu=CostModel.of(1.0, {"triangles": 1e-4}),
        cpu=CpuCostModel.of(4.0, {"objects_visited": 1e-4}),
        gpu_residual=Residual("gaussian", 0.02),
        display=Display("immediate"),
    )


@pytest.fixture(scope="session")
def fitted_machine(machine: HardwareProfile) -> HardwareProfile:
    """Return the machine with six posterior draws of its triangle cost, 20 % apart at most."""
    linear = np.zeros((6, len(GPU_PREDICTORS)))
    linear[:, GPU_PREDICTORS.index("triangles")] = 1e-4 * np.linspace(0.8, 1.2, 6)
    return replace(machine, posterior=Posterior(np.ones(6), linear, np.full(6, 0.02)))


@pytest.fixture(scope="session")
def bad_policies(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a user's file with policies that break the contract or are out of the ordinary."""
    path = tmp_path_factory.mktemp("policies") / "mine.py"
    path.write_text(BAD_POLICIES, encoding="utf-8")
    return path


BAD_POLICIES = '''
import numpy as np
from lodbench.policies.protocol import Capabilities
from lodbench.policies.selection import Selection


class Coarsest:
    """Not broken: the coarsest level of everything."""

    capabilities = Capabilities()

    def reset(self, scene, budget_ms):
        pass

    def select(self, view):
        return Selection(view.ids, np.full(len(view.ids), 2.0))


class Raises(Coarsest):
    def select(self, view):
        if view.frame == 70:
            raise ValueError("lost <b>patience</b>")
        return super().select(view)


class Nan(Coarsest):
    def select(self, view):
        return Selection(view.ids, np.full(len(view.ids), np.nan))


class Short(Coarsest):
    def select(self, view):
        return Selection(view.ids, np.zeros(max(len(view.ids) - 1, 0)))


class TooCoarse(Coarsest):
    def select(self, view):
        return Selection(view.ids, np.full(len(view.ids), 3.0))


class OnlyTrees(Coarsest):
    capabilities = Capabilities(levels=False, hierarchy=True)


class Seer(Coarsest):
    capabilities = Capabilities(future=True)
'''


@pytest.fixture(scope="session")
def made_scored() -> Callable[..., Scored]:
    """Return a builder of scores: of every metric the same number, unless another is given."""

    def build(*, judged_ms: float = 10.0, fill: float = 1.0, **values: float | None) -> Scored:
        known: dict[str, float | None] = {metric.id: fill for metric in METRICS}
        assert values.keys() <= known.keys()
        return Scored(
            log=None,
            values=known | values,
            steps=(),
            frames=100,
            judged_ms=judged_ms,
            worst=Moment("path", 2.0, (0.0, 0.0, 1.7), judged_ms, 5.0, "triangles", 3.0),
            footing=Footing(100.0, 0.0),
        )

    return build


@pytest.fixture
def make_up(tmp_path: Path, made_scored: Callable[..., Scored]) -> MakeUp:
    """Return what writes results of made-up numbers: metrics or a failure, by cells of a run."""

    def write(study: Study, outcome_of: Callable[[dict[str, object]], Outcome]) -> Path:
        folder = tmp_path / "results"
        (folder / PARTS).mkdir(parents=True)
        runs = study.run_list()
        entries: list[Entry] = []
        for at, case in enumerate(study.cases()):
            found = outcome_of(dict(case.cells))
            if not isinstance(found, Failure):
                values = dict.fromkeys((metric.id for metric in METRICS), None) | dict(found)
                found = made_scored(**values)
            entries.append(Entry(at, found))
        rows = encode(runs, entries)
        half = len(entries) // 2
        parts = [
            write_part(folder, FINAL, number, part)
            for number, part in enumerate((rows.slice(0, half), rows.slice(half)))
        ]
        write_manifest(folder, Manifest(runs.digest, len(runs), complete=True, parts=tuple(parts)))
        return folder

    return write
