"""What the page on hardware says of pacing is what the pipeline does."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lodbench.analysis.study.paths import load_paths
from lodbench.models.machine.hardware import Display
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.pipeline.pipeline import Pipeline
from lodbench.sim.replay import ReplayOptions, replay

PAGE = (Path(__file__).parents[2] / "docs" / "hardware.md").read_text(encoding="utf-8")
MS = 1_000_000
FRAMES = 600
WAYS = {  # by what the table calls them
    "nothing": Display(latency_limit=0),
    "`latency_limit` 2, the default": Display(),
    "`latency_limit` 1": Display(latency_limit=1),
    "`limiter`": Display(pacing="limiter", latency_limit=0),
    "`just-in-time`": Display(pacing="just-in-time", latency_limit=0),
}


class Even:
    """Frames that all take the same."""

    def __init__(self, cpu_ms: int, gpu_ms: int) -> None:
        self.costs = cpu_ms * MS, gpu_ms * MS

    def begin(self, frame: int, time_ns: int) -> tuple[int, int] | None:
        """Return what a frame takes."""
        return self.costs if frame < FRAMES else None


def told(display: Display, work: str) -> str:
    """Return a cell of the table: mean lag, and frames a second where they are not 60."""
    pipeline = Pipeline(Even(*map(int, re.findall(r"\d+", work))), display, 2)
    pipeline.run()
    shown = np.array(pipeline.display_ns)
    lag_ms = (shown - np.array(pipeline.input_ns))[20:].mean() / MS
    rate = 1e9 * (FRAMES - 21) / float(shown[-1] - shown[20])
    return f"{lag_ms:.1f}" + ("" if round(rate, 1) == 60.0 else f" ({round(rate, 1):g})")


def test_the_table_of_lags_is_what_the_pipeline_does() -> None:
    """Every cell: four ways to wait and none, for four kinds of work at 60 Hz."""
    head, _, *rows = PAGE[PAGE.index("| lag in ms at 60 Hz") :].split("\n\n")[0].splitlines()
    cells = [[cell.strip() for cell in row.strip("|").split("|")] for row in (head, *rows)]
    works = cells[0][1:]
    assert {row[0]: row[1:] for row in cells[1:]} == {
        name: [told(display, work) for work in works] for name, display in WAYS.items()
    }


@pytest.mark.slow
def test_just_in_time_misses_refreshes_that_two_frames_of_latency_do_not() -> None:
    """Over two trials through `district`: 2 % and none, at half the lag."""
    scene, machine = load_scene("district"), load_hardware("desktop-assumed")
    paths = load_paths(
        ["trial"], scene, "shrink", paths=2, length_s=6.0, seconds=(0.0, None), seed=0
    )
    missed: dict[str, float] = {}
    lag_ms: dict[str, float] = {}
    for name in ("`latency_limit` 2, the default", "`just-in-time`"):
        way = WAYS[name]
        display = replace(machine.display, pacing=way.pacing, latency_limit=way.latency_limit)
        logs = [
            replay(
                parse_policy("static-screen:bias=1").make(),
                scene,
                path,
                replace(machine, display=display),
                ReplayOptions(budget_ms=16.67),
                name="static-screen",
            )
            for path in paths
        ]
        steps = [np.round(np.diff(log["display_ns"]) * 60e-9) for log in logs]
        missed[name] = float(np.mean([(step - 1).sum() / step.sum() for step in steps]))
        lag_ms[name] = float(
            np.mean([(log["display_ns"] - log["input_ns"]).mean() for log in logs]) / MS
        )
    print(missed, lag_ms)
    two, just = missed
    assert missed[two] == 0.0
    assert missed[just] == pytest.approx(0.02, abs=0.005)
    assert lag_ms[just] == pytest.approx(0.5 * lag_ms[two], rel=0.05)
    assert "misses 2 % of the refreshes so, and none with two frames" in PAGE
