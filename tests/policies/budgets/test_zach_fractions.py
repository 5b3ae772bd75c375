"""Zach's selection as printed: fractions of groups, and what is predicted and not spent."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.machine.cost import CostModel
from lodbench.models.scene.levels import LevelTable, count_rows
from lodbench.models.scene.scene import Scene
from lodbench.policies.budgets.zach import Zach
from lodbench.policies.selection import Selection, find_violation
from lodbench.policies.view import View

Make = Callable[..., Any]
PAPER = CostModel.of(1.0, {"draw_calls": 2.45e-3, "splats": 0.35e-3})
_ONE_MS = 2.8e-3  # a tree of one splat


def groups(trees: int, splats: int) -> LevelTable:
    """Return a type of so many trees of so many splats each, down to one tree of one."""
    counts = count_rows(3, draw_calls=[trees, trees, 1], splats=[trees * splats, trees, 1])
    none = np.zeros(3)
    return LevelTable(np.array([0, 3]), counts, none, none, np.array([True]))


def choose(scene: Scene, view: View, left_ms: float, **params: Any) -> tuple[Selection, float]:
    """Return a valid selection with so much beside the base, and what it costs beside the base."""
    policy = Zach(admission=False, **params)
    policy.reset(scene, 1.0 + left_ms)
    selection = policy.select(view)
    assert find_violation(selection, view.ids, scene) is None
    levels, kind = scene.types.levels, scene.type_index[selection.ids]
    counts = levels.interpolate(levels.counts, *levels.position(kind, selection.detail))
    costs_ms = counts @ PAPER.linear_ms[: len(LEVEL_PREDICTORS)]
    return selection, float(costs_ms.sum())


@pytest.mark.parametrize(
    ("left_ms", "splats"),
    [
        (0.9 * _ONE_MS, 0),  # less than one splat: nothing is drawn
        (5.5 * _ONE_MS, 5),  # half of the trees, one splat each
        (10.5 * _ONE_MS, 10),  # each tree has one, and the rest is not enough for a second
        (10 * _ONE_MS + 10.5 * 0.35e-3, 20),  # the second splat of each costs no set-up
        (10 * _ONE_MS + 29.0 * 0.35e-3, 30),  # 39 splats are three a tree
    ],
)
def test_whole_splats_of_whole_trees(
    left_ms: float, splats: int, make_scene: Make, make_view: Make
) -> None:
    """Ten trees: the budget is predicted to be spent, and what is less than a splat is not."""
    scene = make_scene([(0.0, 0.0, -5.0)], levels=groups(10, 100)).with_costs(PAPER)
    selection, spent_ms = choose(scene, make_view(scene), left_ms)
    drawn = selection.detail * 1_000.0
    assert drawn.tolist() == pytest.approx([splats] if splats else [])
    assert selection.predicted_ms == pytest.approx(1.0 + left_ms, rel=1e-6)
    paid_ms = 0.35e-3 * splats + 2.45e-3 * min(splats, 10)
    assert spent_ms == pytest.approx(paid_ms, abs=1e-12)
    assert 1.0 + spent_ms <= selection.predicted_ms


def test_no_group_is_refused_beforehand(make_scene: Make, make_view: Make) -> None:
    """A hundred groups whose set-up is twice the budget: all get trees without admission."""
    rng = np.random.default_rng(1)
    depth = rng.uniform(20.0, 40.0, 100)
    place = np.stack((rng.uniform(-5, 5, 100), rng.uniform(-5, 5, 100), -depth), axis=1)
    scene = make_scene(place, levels=groups(40, 100)).with_costs(PAPER)
    view, left_ms = make_view(scene), 0.5 * 100 * 40 * 2.45e-3
    selection, spent_ms = choose(scene, view, left_ms)
    assert len(selection.ids) == 100
    assert (selection.detail < 1.0 / 100.0).all()
    assert 0.95 * left_ms < spent_ms <= left_ms
    admitting = Zach()
    admitting.reset(scene, 1.0 + left_ms)
    assert len(admitting.select(view).ids) < 60


def test_meshes_share_the_time_with_groups(
    make_scene: Make, make_levels: Make, make_view: Make
) -> None:
    """Whatever is no group is drawn at its coarsest at least: one continuous, one of one level."""
    trees, meshes = (
        groups(10, 100),
        make_levels(((1000.0, 100.0), (50.0,)), continuous=[True, False]),
    )
    levels = LevelTable(
        np.array([0, 3, 5, 6]),
        np.concatenate((trees.counts, meshes.counts)),
        np.concatenate((trees.error_m, meshes.error_m)),
        np.concatenate((trees.bytes, meshes.bytes)),
        np.array([True, True, False]),
    )
    costs = CostModel.of(1.0, {"draw_calls": 1e-3, "splats": 1e-3, "triangles": 1e-3})
    scene = make_scene([(0.0, 0.0, -5.0)] * 3, kind=[0, 1, 2], levels=levels).with_costs(costs)
    policy, view = Zach(admission=False), make_view(scene)
    base_ms = 1.0 + 0.05 + sum(levels.counts[[4, 5], 0]) * 1e-3
    for left_ms, everything in ((0.2, False), (5.0, True)):
        policy.reset(scene, base_ms + left_ms)
        selection = policy.select(view)
        detail = dict(zip(selection.ids.tolist(), selection.detail.tolist(), strict=True))
        assert detail[2] == 0.0
        assert detail[1] >= 0.1
        assert (detail.get(0) == detail[1] == 1.0) == everything
        assert selection.predicted_ms <= base_ms + left_ms


def test_culled_groups_are_no_variables(make_scene: Make, make_view: Make) -> None:
    """Spheres 1 px wide are passed over, others are not; what was tried is told."""
    scene = make_scene([(0.0, 0.0, -5.0), (0.0, 0.0, -900.0)], levels=groups(10, 100))
    scene = scene.with_costs(PAPER)
    policy = Zach(admission=False)
    policy.reset(scene, 1.5)
    assert policy.select(make_view(scene)).ids.tolist() == [0]
    assert (policy.effort.groups, policy.effort.variables) == (1, 1)


def test_the_coarsest_is_drawn_where_nothing_fits(make_scene: Make, make_view: Make) -> None:
    """A budget below the base leaves no group."""
    scene = make_scene([(0.0, 0.0, -5.0)], levels=groups(10, 100)).with_costs(PAPER)
    selection, _ = choose(scene, make_view(scene), -0.5)
    assert len(selection.ids) == 0


def test_a_roofline_is_refused_without_admission(make_scene: Make) -> None:
    """Its costs are no line over splats."""
    costs = CostModel.of(1.0, {"splats": 1e-3}, {"splats": 1e-3, "shaded_samples": 1e-6})
    scene = make_scene([(0.0, 0.0, -5.0)], levels=groups(10, 100)).with_costs(costs)
    with pytest.raises(InputError, match="admission=false"):
        Zach(admission=False).reset(scene, 5.0)
