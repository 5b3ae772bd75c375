"""Extraction and borrowing of continuous levels, worked out by hand."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from lodbench.base.errors import PolicyError
from lodbench.models.scene.levels import LevelTable
from lodbench.policies.protocol import Policy
from lodbench.policies.selection import Selection
from lodbench.policies.view import View
from lodbench.sim.frame_log import FrameLog

AREA_PX = math.pi * 50.0**2 / 99.0  # of a sphere of 1 m at 10 m, 100 px high at 90 degrees
UNIT_PX = 50.0 / 9.0  # of 1 m at its nearest point, 9 m away
VIEWPORT_PX = 100.0 * 100.0
Run = Callable[..., FrameLog]
MakePolicy = Callable[..., Policy]
MakeLevels = Callable[..., LevelTable]


def test_continuous_nodes_extract_when_they_change(
    run: Run, scripted: MakePolicy, make_levels: MakeLevels
) -> None:
    """A new resolution changes `a - b³ / a²` triangles; a toggle needs a knot to be passed.

    1000 - 500³ / 1000² = 875, 500 - 400³ / 500² = 244, 400 - 200³ / 400² = 350; 12 bytes a triangle
    are sent, and 36 of each of the 1,000 once, which is the geometry.
    """
    levels = make_levels([(1000, 250, 50)], continuous=True)
    log = run(scripted([1.0, 0.5, 0.5, 0.4, 0.2]), 5, levels=levels)
    assert log["levels_extracted"].tolist() == [1, 1, 0, 1, 1]
    assert log["triangles_changed"].tolist() == [1000, 875, 0, 244, 350]
    assert log["bytes_uploaded"].tolist() == [48_000, 6_000, 0, 4_800, 2_400]
    assert log["levels_changed"].tolist() == [0, 1, 0, 1, 1]
    assert log["first_uses"].tolist() == [1, 0, 0, 0, 0]
    assert log["toggles"].tolist() == [0, 0, 0, 0, 1]
    step_m = np.array([0.0, 0.1 / 1.5, 0.0, 0.1 * 0.1 / 0.75, 0.125 - 0.08])
    assert log["popping_px"] == pytest.approx(step_m * UNIT_PX * AREA_PX / VIEWPORT_PX)


def test_borrowing_costs_a_reference_once(
    run: Run, scripted: MakePolicy, make_levels: MakeLevels
) -> None:
    """Two nodes extract; then the second borrows, which is counted in that frame alone."""

    def lend(view: View, selection: Selection) -> Selection:
        holder = np.array([0, 1 if view.frame == 0 else 0], dtype=np.int32)
        return replace(selection, holder=holder)

    levels = make_levels([(1000, 250, 50)], continuous=True)
    log = run(scripted([0.5], lend), 3, positions=[(0.0, 0.0, -10.0)] * 2, levels=levels)
    assert log["levels_extracted"].tolist() == [2, 0, 0]
    assert log["levels_borrowed"].tolist() == [0, 1, 0]


def test_borrowing_another_resolution_fails_the_policy(
    run: Run, scripted: MakePolicy, make_levels: MakeLevels
) -> None:
    """A node cannot draw at 0.25 an index set that was extracted at 1."""
    levels = make_levels([(1000, 250, 50)], continuous=True)
    policy = scripted([[1.0, 0.25]], holder=np.zeros(2, dtype=np.int32))
    with pytest.raises(PolicyError, match=r"frame 0: holder: node 1 draws resolution 0.25"):
        run(policy, positions=[(0.0, 0.0, -10.0)] * 2, levels=levels)
