"""Zach's mixed selection on a likeness of its test: ipopt, enumeration, splitting, a replay."""

import itertools
from collections.abc import Callable
from typing import Any

import casadi
import numpy as np
import pytest

from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.machine.cost import CostModel
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.tree import Tree
from lodbench.policies.budgets.zach import Zach
from lodbench.policies.selection import Selection, find_violation
from lodbench.policies.view import View
from lodbench.sim.replay import ReplayOptions, replay

Make = Callable[..., Any]
PAPER = CostModel.of(0.0, {"draw_calls": 2.45e-3, "splats": 0.35e-3, "vertices": 0.06e-3})
PATCH_MS = 33.0**2 * 0.06e-3
SPLATS = LEVEL_PREDICTORS.index("splats")
TREES = LEVEL_PREDICTORS.index("draw_calls")


def choose(scene: Scene, view: View, budget_ms: float, **params: Any) -> Selection:
    """Return a valid selection of a new policy."""
    policy = Zach(**params)
    policy.reset(scene, budget_ms)
    selection = policy.select(view)
    assert find_violation(selection, view.ids, scene, Tree(scene)) is None
    return selection


class Styria:
    """A view of `build_styria` with the paper's benefits, written down once more."""

    def __init__(self, scene: Scene, view: View, terrain_depth: int) -> None:
        self.scene, self.view = scene, view
        self.ground = (4 ** (terrain_depth + 1) - 1) // 3
        self.depth = Tree(scene).depth
        everything = view.at(np.arange(len(scene)))
        self.area_px = np.where(view.state.inside, everything.area_px, 0.0)
        patch = np.where(self.depth[: self.ground] == terrain_depth, self.area_px[: self.ground], 0)
        for node in range(self.ground - 1, 0, -1):
            patch[scene.parent[node]] += patch[node]
        self.patch_px = patch
        levels = scene.types.levels
        finest = levels.counts[levels.start[scene.type_index]]
        self.trees, self.splats = finest[:, TREES], finest[:, SPLATS]

    def of_patches(self, ids: Any) -> float:
        """Return ``Σ sqrt(2^depth) · S`` of patches."""
        return float((np.sqrt(2.0 ** self.depth[ids]) * self.patch_px[ids]).sum())

    def of_groups(self, ids: Any, resolution: Any) -> float:
        """Return ``Σ 1/16 S² (N / 64) sqrt(x / N · N_splats)`` of groups."""
        per_tree = np.sqrt(resolution * self.splats[ids] / self.trees[ids])
        return float((self.area_px[ids] / 16.0 * self.trees[ids] / 64.0 * per_tree).sum())

    def benefit(self, selection: Selection) -> float:
        """Return the benefit of a selection."""
        patch = selection.ids < self.ground
        smooth = self.of_groups(selection.ids[~patch], selection.detail[~patch])
        return self.of_patches(selection.ids[patch]) + smooth


def test_no_steps_leave_the_coarsest(
    make_styria: Make, flyover: Camera, make_tree_view: Make
) -> None:
    """Stopped before its first step the search has the root, and groups at their floor."""
    scene = make_styria(1, terrain_depth=3, forest_depth=3).with_costs(PAPER)
    view = make_tree_view(scene, flyover)
    selection = choose(scene, view, 50.0, max_steps=0)
    patches = selection.ids < 85
    assert selection.ids[patches].tolist() == [0]
    assert selection.detail[~patches] == pytest.approx(1.0 / 512.0)
    styria, last = Styria(scene, view, 3), 0.0
    for steps in (0, 1, 2, 4, 8, 256):
        selection = choose(scene, view, 50.0, max_steps=steps)
        assert selection.predicted_ms <= 50.0
        now = styria.benefit(selection)
        assert now >= last
        last = now


@pytest.mark.parametrize("engine", ["bent", "gradient", "newton"])
@pytest.mark.parametrize("seed", range(3))
def test_against_every_front_with_the_shares_of_ipopt(
    engine: str, seed: int, make_styria: Make, make_tree_view: Make
) -> None:
    """Terrain of two levels (17 fronts) and 16 groups, all in view, without cost of setup."""
    costs = CostModel.of(0.0, {"splats": 0.35e-3, "vertices": 0.06e-3})
    scene = make_styria(seed, width_m=100.0, terrain_depth=2, forest_depth=2, wooded=1.0)
    scene = scene.with_costs(costs)
    camera = Camera((50.0, 60.0, 300.0), (0.0, 0.0, 0.0, 1.0), 800, 800, 0.9)
    view = make_tree_view(scene, camera)
    assert view.state.inside.all()
    budget_ms = (1.5, 3.0, 6.0)[seed] * 17.0 * PATCH_MS / 3.0
    policy = {"splitting": False, "engine": engine, "max_steps": 10_000, "cull_px": 0.0}
    selection = choose(scene, view, budget_ms, **policy)
    styria = Styria(scene, view, 2)
    trees = selection.ids[selection.ids >= styria.ground]
    assert len(trees) == 16
    best, alone = best_front(styria, trees, budget_ms)
    reached = styria.benefit(selection)
    assert best * (1.0 + 1e-6) >= reached >= best - 0.42 * 2.0 * float(styria.patch_px[1:5].max())
    patches = selection.ids[selection.ids < styria.ground]
    exact = styria.of_patches(patches) + alone(budget_ms - len(patches) * PATCH_MS)
    assert reached == pytest.approx(exact, rel=1e-3)


def best_front(
    styria: Styria, trees: Any, budget_ms: float
) -> tuple[float, Callable[[float], float]]:
    """Return the greatest benefit of any front, and a function for the groups' alone by ipopt."""
    library: Any = casadi
    full = 0.35e-3 * styria.splats[trees]
    unit = np.array([styria.of_groups(trees[i : i + 1], 1.0) for i in range(len(trees))])
    r = library.SX.sym("r", len(trees))
    problem = {"x": r, "f": -library.dot(unit, library.sqrt(r)), "g": library.dot(full, r)}
    quiet = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-9}
    solver: Any = library.nlpsol("solver", "ipopt", problem, quiet)

    def alone(left_ms: float) -> float:
        found = solver(x0=0.1, lbx=1.0 / 512.0, ubx=1.0, ubg=left_ms)
        return -float(found["f"])

    best = -np.inf
    fronts = [[0]]
    for refined in itertools.product([False, True], repeat=4):
        parts = [
            styria.scene.children(1 + i) if deep else [1 + i] for i, deep in enumerate(refined)
        ]
        fronts.append(np.concatenate(parts).tolist())
    for front in fronts:
        left_ms = budget_ms - len(front) * PATCH_MS
        if left_ms >= float(full.sum()) / 512.0:
            best = max(best, styria.of_patches(np.array(front)) + alone(left_ms))
    return best, alone


@pytest.mark.parametrize("budget_ms", [20.0, 60.0, 200.0, 1000.0])
def test_splitting_loses_less_than_a_thousandth_on_the_flyover(
    budget_ms: float, make_styria: Make, flyover: Camera, make_tree_view: Make
) -> None:
    """With the paper's costs and with groups that are nearly free to set up."""
    free = CostModel.of(1.0, {"draw_calls": 1e-6, "splats": 0.05e-3, "vertices": 0.06e-3})
    for costs in (PAPER, free):
        scene = make_styria(2).with_costs(costs)
        view = make_tree_view(scene, flyover)
        styria = Styria(scene, view, 5)
        apart, shared = (
            choose(scene, view, budget_ms, splitting=splitting) for splitting in (False, True)
        )
        assert shared.predicted_ms <= budget_ms
        assert styria.benefit(shared) >= 0.999 * styria.benefit(apart)


def test_predictions_hold_in_a_replay(
    make_styria: Make, make_hardware: Make, make_trace: Make, flyover: Camera
) -> None:
    """Flying over, true and predicted times are the same and never over the budget."""
    linear = {"draw_calls": 2.45e-3, "splats": 0.35e-3, "vertices": 0.06e-3, "state_changes": 0.01}
    roofline = {"splats": 1e-5, "shaded_samples": 1e-7}
    hardware = make_hardware(linear, roofline=roofline, base_ms=2.0)
    along_m = np.linspace(0.0, 60_000.0, 12)
    position_m = np.stack((np.full(12, 60_000.0), along_m, np.full(12, 2_000.0)), axis=1)
    time_s = np.linspace(0.0, 6.0, 12)
    trace = make_trace(position_m, time_s=time_s, orientation_xyzw=flyover.orientation_xyzw)
    scene = make_styria(4, terrain_depth=4, forest_depth=5)
    log = replay(
        Zach(), scene, trace, hardware, ReplayOptions(budget_ms=40.0, frames=12), name="zach"
    )
    predicted, true = log["predicted_gpu_ms"], log["model_gpu_ms"]
    assert (predicted <= 40.0).all()
    assert predicted == pytest.approx(true, rel=1e-9)
    assert true.max() > 39.0
