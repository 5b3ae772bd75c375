"""Zach's experiments: the flight, the paper's benefit by hand, and the whole at reduced size."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.analysis.reproduce.registry import find_experiments
from lodbench.analysis.reproduce.reproduce import reproduce
from lodbench.analysis.reproduce.zach.benefit import PaperBenefit
from lodbench.analysis.reproduce.zach.flight import LENGTH_S, UP_M, flight
from lodbench.models.scene.camera import Camera
from lodbench.models.scenes.styria import CELL_M, WIDTH_M, styria_heights
from lodbench.policies.selection import Selection

Make = Callable[..., Any]


@pytest.mark.slow
def test_the_flight_is_above_the_ground_and_in_the_province() -> None:
    """At least 200 m up at every sample, and never near an edge."""
    path, heights = flight(), styria_heights()
    x, y, z = path.position_m.T
    ground = heights[np.round(y / CELL_M).astype(int), np.round(x / CELL_M).astype(int)]
    assert (z - ground >= UP_M).all()
    assert path.duration_s == LENGTH_S
    assert flight(1.0).duration_s == 1.0
    for along in (x, y):
        assert (along > 5_000.0).all()
        assert (along < WIDTH_M - 5_000.0).all()


def test_benefit_by_hand(make_styria: Make, make_view: Make) -> None:
    """Terrain of one patch over four: S, and sqrt(2) S; a group of 512 splats a tree in full."""
    scene = make_styria(0, width_m=100.0, terrain_depth=1, forest_depth=1, wooded=1.0)
    camera = Camera((50.0, 50.0, 300.0), (0.0, 0.0, 0.0, 1.0), 800, 800, 0.9)
    view = make_view(scene, camera)
    assert view.state.inside.all()
    benefit = PaperBenefit(scene)
    leaves = np.arange(1, 5, dtype=np.int32)
    area = float(view.at(leaves).area_px.sum())
    root = Selection(np.array([0], dtype=np.int32), np.zeros(1))
    assert benefit.of(view, root) == pytest.approx((area, 0.0))
    assert benefit.of(view, Selection(leaves, np.zeros(4)))[0] == pytest.approx(2**0.5 * area)
    group = int(np.flatnonzero(scene.continuous)[0])
    levels = scene.types.levels
    trees = float(levels.counts[levels.start[scene.type_index[group]], 0])
    ids = np.array([group], dtype=np.int32)
    for resolution in (1.0, 0.25):
        worth = benefit.of(view, Selection(ids, np.array([resolution])))[1]
        per_tree = (512.0 * resolution) ** 0.5
        assert worth == pytest.approx(view.at(ids).area_px[0] / 16.0 * trees / 64.0 * per_tree)


@pytest.mark.slow
def test_zach_at_reduced_size() -> None:
    """What holds of a few frames on the whole scene: budgets, predictions, and a tenth of work."""
    result = reproduce(find_experiments("zach"), reduced=True, workers=1)
    for entry in result.entries:
        kept = "predicted" in entry.claim and "exploited" not in entry.claim
        if kept or entry.id in ("zach/fig4", "zach/scale"):
            assert entry.verdict == "reproduced", entry
        if "exploited" in entry.claim:
            assert entry.verdict in ("reproduced", "in direction"), entry
    (work,) = [entry for entry in result.entries if entry.claim.startswith("work")]
    (loss,) = [entry for entry in result.entries if "lost" in entry.claim]
    assert work.verdict == loss.verdict == "reproduced"
