"""Alternatives of flat scenes, worked by hand."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.frame_cost import FrameCost
from lodbench.policies.shared.levels.choices import distinct, importance, make_choices

Make = Callable[..., Any]


def test_a_short_chain_offers_no_more_than_it_has(
    make_scene: Make, make_levels: Make, make_view: Make
) -> None:
    """Levels of 1,000, 250 and 50 triangles, and one of 80: what is not there costs infinitely."""
    levels = make_levels([(1000, 250, 50), (80,)])
    scene = make_scene([(0.0, 0.0, -10.0)] * 3, kind=[1, 0, 1], levels=levels)
    costs = FrameCost(CostModel.of(2.0, {"triangles": 1e-3, "state_changes": 0.25}), levels)
    offer = make_choices(scene, costs, 1.0).offer(make_view(scene), importance)
    none = np.inf
    expected = np.array([[0.08, none, none], [1.0, 0.25, 0.05], [0.08, none, none]])
    assert offer.cost_ms == pytest.approx(expected)
    assert offer.fixed_ms == pytest.approx(2.0 + 2 * 0.25)


def test_distinct_types() -> None:
    """Types 4 and 1 are two, however often they stand there; nothing has none."""
    assert distinct(np.array([4, 1, 4, 4], dtype=np.int32)) == 2
    assert distinct(np.empty(0, dtype=np.int32)) == 0
