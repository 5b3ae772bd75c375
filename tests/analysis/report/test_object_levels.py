"""The raster of levels: which objects it shows, in which colours, and how much of a page."""

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lodbench.analysis.report.blocks import Choice, Paragraph
from lodbench.analysis.report.palette import inks
from lodbench.analysis.report.plots import LEVEL_STYLES, WIDE, Plot
from lodbench.analysis.report.render import render_report
from lodbench.analysis.report.results import Results
from lodbench.analysis.report.sections import object_levels
from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.comparison_folder import Compared
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.level_history import HIDDEN, LevelHistory
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.camera_trace import CameraTrace


@pytest.fixture(scope="module")
def compared(small_scene: Scene, turn_trace: CameraTrace, machine: HardwareProfile) -> Compared:
    """Return a comparison of two policies along a turn."""
    policies = [parse_policy("static-screen:bias=1"), parse_policy("feedback:target=0.9")]
    settings = CompareSettings(workers=1, warmup_s=0.2)
    return compare(policies, small_scene, [turn_trace], machine, ReplayOptions(budget_ms=8.0),
                   settings)  # fmt: skip


def results_of(compared: Compared, scene: Scene | None, **levels: Any) -> Results:
    """Return results in which every log keeps these levels, where some are given."""
    logs = {label: replace(log, **levels) for label, log in compared.logs.items()}
    return Results(compared.comparison, logs, inks(compared.comparison), scene)


def history_of(frames: int, changes: dict[int, list[tuple[int, int]]]) -> LevelHistory:
    """Return a history of frames from (node, level) pairs by frame."""
    pairs = [pair for at in range(frames) for pair in changes.get(at, [])]
    return LevelHistory(
        np.cumsum([0, *(len(changes.get(at, [])) for at in range(frames))]),
        np.array([node for node, _ in pairs], dtype=np.int32),
        np.array([level for _, level in pairs], dtype=np.int16),
        np.tile((0.0, 0.0, 0.0, 1.0), (frames, 1)),
    )


def raster_of(results: Results) -> Plot:
    """Return the chart of the first policy."""
    (block,) = object_levels.object_levels(results).blocks
    assert isinstance(block, Choice)
    return block.options[0][1]


def test_rows_are_the_objects_that_switch_most(
    compared: Compared, make_scene: Callable[..., Scene]
) -> None:
    """Of three objects one switches twice, one once, one never; colours are of their levels."""
    scene, log = make_scene(np.zeros((3, 3))), next(iter(compared.logs.values()))
    assert scene.level_count.tolist() == [3, 3, 3]
    changes = {0: [(0, 1), (1, 2), (2, 0)], 4: [(1, 1)], 6: [(0, 0), (1, 2)], 8: [(1, HIDDEN)]}
    chart = raster_of(results_of(compared, scene, levels=history_of(10, changes)))
    assert [row.name for row in chart.rows] == ["type-0 1 · 2", "type-0 0 · 1"]
    assert chart.rows[0].hint == "type-0 1: 2 switches"
    assert chart.rows[1].hint == "type-0 0: 1 switch"
    assert "of 2 objects that switch; the record ends at" in chart.title
    coarse, middle, fine = LEVEL_STYLES[0], LEVEL_STYLES[4], LEVEL_STYLES[-1]
    assert [line.style for line in chart.rows[0].boxes] == [middle, coarse]
    assert [line.style for line in chart.rows[1].boxes] == [fine, middle]
    assert chart.rows[0].boxes[1].hint == "level 2 of 0 (finest) to 2"
    unit = WIDE / float(log["input_ns"][-1])
    at = [round(unit * float(log["input_ns"][frame])) for frame in (0, 4, 6, 8)]
    expected = f"M{at[0]} 1000h{at[1] - at[0]}m{at[2] - at[1]} 0h{at[3] - at[2]}"
    assert chart.rows[0].boxes[1].path == expected


def test_a_tree_is_coloured_by_depth(compared: Compared, make_scene: Callable[..., Scene]) -> None:
    """The root, for which its children are drawn and back, is coarsest, they are finest."""
    levels = make_scene([(0, 0, 0)]).types.levels
    one = type(levels)(
        np.array([0, 1]), levels.counts[:1], np.zeros(1), np.ones(1), np.zeros(1, dtype=bool)
    )
    scene = make_scene(np.zeros((3, 3)), parent=[-1, 0, 0], levels=one)
    refined = [(0, HIDDEN), (1, 0), (2, 0)]
    chart = raster_of(results_of(compared, scene, levels=history_of(9, {0: [(0, 0)], 5: refined})))
    styles = {row.name: [line.style for line in row.boxes] for row in chart.rows}
    assert styles["type-0 0 · 1"] == [LEVEL_STYLES[0]]
    assert styles["type-0 2 · 1"] == [LEVEL_STYLES[-1]]
    assert chart.rows[0].boxes[0].hint == "drawn"


def test_the_raster_is_bounded(compared: Compared, make_scene: Callable[..., Scene]) -> None:
    """Fifty objects that switch in every frame: at most 40 rows, and 4,000 stretches of time."""
    scene, frames = make_scene(np.zeros((50, 3))), len(next(iter(compared.logs.values())))
    always = {at: [(node, at % 2) for node in range(50)] for at in range(frames)}
    chart = raster_of(results_of(compared, scene, levels=history_of(frames, always)))
    assert len(chart.rows) == min(40, 4_000 // frames)
    assert sum(len(line.path) for row in chart.rows for line in row.boxes) < 80_000
    assert "of 50 objects" in chart.title


def test_logs_without_levels_say_so(compared: Compared, small_scene: Scene) -> None:
    """A folder of before, or a scene that is not there: a sentence in place of the chart."""
    for results in (
        results_of(compared, small_scene, levels=None),
        results_of(compared, None),
    ):
        (block,) = object_levels.object_levels(results).blocks
        assert isinstance(block, Paragraph)
        assert "do not keep levels" in block.text


def test_a_type_that_is_called_a_script_is_text(compared: Compared, small_scene: Scene) -> None:
    """Names of types are escaped in labels, hints and titles."""
    names = tuple(f"<script>alert({at})</script>" for at in range(len(small_scene.types.names)))
    scene = replace(small_scene, types=replace(small_scene.types, names=names))
    html = render_report(compared.comparison, compared.logs, scene)
    assert "<script>alert" not in html
    counted = re.search(r"of (\d+) objects? that switch", html)
    if counted is not None:
        assert "&lt;script&gt;alert" in html
