"""Mason and Blake's policy against the enumeration of all cuts of small trees."""

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.models.machine.cost import CostModel
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.scene import Scene
from lodbench.policies.hierarchies.mason_blake import MasonBlake
from lodbench.policies.view import View

Make = Callable[..., Any]
BASE_MS = 1.0
COSTS = CostModel.of(BASE_MS, {"triangles": 1e-3})


class Cuts:
    """All cuts of a tree, with cost and benefit of each computed leaf by leaf."""

    def __init__(self, scene: Scene, view: View) -> None:
        self.scene = scene
        levels = scene.types.levels
        self.triangles = levels.counts[:, 2][scene.type_index]
        everything = view.at(np.arange(len(scene)))
        self.weight = everything.area_px * everything.inside
        self.inside = everything.inside
        trees = [self._below(int(root)) for root in view.ids]
        self.cuts = [sum(parts, ()) for parts in itertools.product(*trees)]
        self.points = np.array([(self.cost(cut), self.benefit(cut)) for cut in self.cuts])

    def _below(self, node: int) -> list[tuple[int, ...]]:
        children = [self._below(int(child)) for child in self.scene.children(node)]
        finer = [sum(parts, ()) for parts in itertools.product(*children)] if children else []
        return [(node,), *finer]

    def leaves(self, node: int) -> list[int]:
        """Return the leaves at or below a node."""
        children = self.scene.children(node)
        below = [leaf for child in children for leaf in self.leaves(int(child))]
        return below or [node]

    def cost(self, cut: tuple[int, ...]) -> float:
        """Return milliseconds of a cut."""
        return BASE_MS + 1e-3 * sum(self.triangles[n] for n in cut if self.inside[n])

    def benefit(self, cut: tuple[int, ...]) -> float:
        """Return area times accuracy, summed over leaves."""
        total = 0.0
        for node in cut:
            leaves = self.leaves(node)
            whole = sum(self.triangles[leaf] for leaf in leaves)
            for leaf in leaves:
                samples = self.triangles[node] * self.triangles[leaf] / whole
                total += self.weight[leaf] * (1.0 - 0.5 / samples)
        return total

    def hull(self) -> list[tuple[float, float]]:
        """Return the vertices of the upper hull from the roots' cut up: the relaxed optima."""
        vertices = [tuple(self.points[0])]
        while True:
            cost, benefit = vertices[-1]
            more = self.points[(self.points[:, 0] > cost) & (self.points[:, 1] > benefit)]
            if not len(more):
                return vertices
            slope = (more[:, 1] - benefit) / (more[:, 0] - cost)
            steepest = more[slope >= slope.max() * (1 - 1e-12)]
            vertices.append(tuple(steepest[steepest[:, 0].argmax()]))


@pytest.fixture(scope="session")
def grow(make_scene: Make, make_levels: Make) -> Callable[..., Scene]:
    """Return a function that grows a random tree in which refining makes no leaf coarser."""

    def build(seed: int, nodes: int) -> Scene:
        rng = np.random.default_rng(seed)
        parent = [-1, *(int(rng.integers(0, node)) for node in range(1, nodes))]
        parent = [-1 if rng.random() < 0.1 else above for above in parent]
        triangles = np.ceil(rng.lognormal(10.0, 1.2, nodes))
        below, share = triangles.copy(), np.ones(nodes)
        for node in range(nodes - 1, -1, -1):
            children = [child for child in range(nodes) if parent[child] == node]
            if children:
                below[node] = below[children].sum()
                share[node] = rng.uniform(0.4, 0.95) * share[children].min()
        position = rng.uniform((-3.0, -3.0, -40.0), (3.0, 3.0, -10.0), (nodes, 3))
        levels = make_levels([[count] for count in below * share])
        scene = make_scene(position, kind=np.arange(nodes), parent=parent, levels=levels)
        return scene.with_costs(COSTS)

    return build


TREES = {"seed": st.integers(0, 2**32 - 1), "nodes": st.integers(2, 14), "part": st.floats(0, 1)}


@settings(max_examples=150, deadline=None)
@given(**TREES)
def test_against_all_cuts(
    grow: Make, make_tree_view: Make, seed: int, nodes: int, part: float
) -> None:
    """At least the relaxed optimum that fits, and half of the best gain over the roots."""
    scene = grow(seed, nodes)
    view = make_tree_view(scene)
    cuts = Cuts(scene, view)
    costs, benefits = cuts.points[:, 0], cuts.points[:, 1]
    budget_ms = costs[0] + part * (costs.max() - costs[0]) + 1e-9
    policy = MasonBlake()
    policy.reset(scene, budget_ms)
    selection = policy.select(view)
    chosen = tuple(selection.ids.tolist())
    assert sorted(chosen) in [sorted(cut) for cut in cuts.cuts]
    assert selection.predicted_ms == pytest.approx(cuts.cost(chosen))
    assert selection.predicted_ms <= budget_ms + 1e-9
    gain = cuts.benefit(chosen) - benefits[0]
    relaxed = max(benefit for cost, benefit in cuts.hull() if cost <= budget_ms)
    best = benefits[costs <= budget_ms].max()
    scale = np.abs(benefits).max()
    assert gain >= relaxed - benefits[0] - 1e-9 * scale
    assert gain >= 0.5 * (best - benefits[0]) - 1e-9 * scale


@settings(max_examples=60, deadline=None)
@given(**TREES)
def test_optimal_at_each_vertex_of_the_relaxation(
    grow: Make, make_tree_view: Make, seed: int, nodes: int, part: float
) -> None:
    """With a budget of exactly a relaxed optimum's cost the policy draws an optimum."""
    scene = grow(seed, nodes)
    view = make_tree_view(scene)
    hull = Cuts(scene, view).hull()
    cost, benefit = hull[int(part * (len(hull) - 1))]
    policy = MasonBlake()
    policy.reset(scene, cost + 1e-9)
    chosen = tuple(policy.select(view).ids.tolist())
    assert Cuts(scene, view).benefit(chosen) >= benefit - 1e-9 * abs(benefit)


def test_no_order_by_slope_is_bounded_where_refinements_pay_only_together(
    make_scene: Make, make_levels: Make, make_tree_view: Make
) -> None:
    """Of a refinement that pays through its children, the part that fits is still taken."""
    # Refining the root costs 1 triangle and leaves every leaf as coarse as it was; each of its
    # four children then costs 90.  The whole does not fit, two of the children do.
    triangles = [[39.0], *[[10.0]] * 4, *[[100.0]] * 4]
    position = [(0.0, 0.0, -20.0), *[(x, 0.0, -20.0) for x in (-3.0, -1.0, 1.0, 3.0)] * 2]
    scene = make_scene(
        position,
        kind=np.arange(9),
        parent=[-1, 0, 0, 0, 0, 1, 2, 3, 4],
        levels=make_levels(triangles),
    ).with_costs(COSTS)
    policy = MasonBlake()
    policy.reset(scene, BASE_MS + 0.039 + 0.001 + 0.2)
    drawn = policy.select(make_tree_view(scene)).ids
    assert np.count_nonzero(drawn >= 5) == 2
    assert len(drawn) == 4


def test_warm_start_ends_where_a_cold_one_does_in_fewer_steps(
    city: Scene, make_tree_view: Make
) -> None:
    """Along a street every frame's front is that of a policy that starts anew."""
    scene = city.with_costs(CostModel.of(3.0, {"triangles": 8e-5, "draw_calls": 0.01}))
    warm, steps = MasonBlake(), {"warm": 0, "cold": 0}
    warm.reset(scene, 30.0)
    for frame in range(12):
        # Along x at eye height: the camera's -z turned to +x, its y up.
        ahead = (0.5, -0.5, -0.5, 0.5)
        camera = Camera((2.0 * frame, 55.0, 1.7), ahead, 1280, 1024, np.pi / 3)
        view = make_tree_view(scene, camera)
        cold = MasonBlake()
        cold.reset(scene, 30.0)
        selections = {"warm": warm.select(view), "cold": cold.select(view)}
        assert selections["warm"].ids.tolist() == selections["cold"].ids.tolist()
        assert len(selections["warm"].ids) > 100
        if frame:
            for name, selection in selections.items():
                steps[name] += selection.work.iterations
    assert 10 * steps["warm"] < steps["cold"]


def test_roots_are_covered_over_budget(grow: Make, make_tree_view: Make) -> None:
    """With no time at all, every root in view is drawn."""
    scene = grow(4, 14)
    policy = MasonBlake()
    policy.reset(scene, 0.1)
    view = make_tree_view(scene)
    assert policy.select(view).ids.tolist() == view.ids.tolist()


def test_needs_a_cost_model(make_scene: Make) -> None:
    """Without one there is nothing to predict with."""
    with pytest.raises(InputError, match="mason-blake: expected a scene with a cost model"):
        MasonBlake().reset(make_scene([(0.0, 0.0, -5.0)]), 10.0)
