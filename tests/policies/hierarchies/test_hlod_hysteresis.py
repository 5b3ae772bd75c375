"""The thesis' counters, slices, loops and priorities, worked by hand on a root and its children.

Without a cost model the roots are taken to fill the target, so that two like children of a root of
R triangles, with C each, are short of or over their half of the slice by R / (2 C) - 1.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.machine.cost import CostModel
from lodbench.models.scene.scene import Scene
from lodbench.policies.hierarchies.hlod_hysteresis import HlodHysteresis

Make = Callable[..., Any]
ROOT = 1_000.0
BUDGET_MS = 10.0


@pytest.fixture
def family(make_scene: Make, make_levels: Make) -> Callable[..., Scene]:
    """Return a function that builds a root and two like children of a stated urgency."""

    def build(urgency: float = 0.0, *, behind: bool = False) -> Scene:
        child = ROOT / (2.0 * (1.0 + urgency))
        position = [(0.0, 0.0, -20.0), (-1.0, 0.0, -20.0), (1.0, 0.0, 50.0 if behind else -20.0)]
        levels = make_levels([[ROOT], [child], [child]])
        return make_scene(position, kind=[0, 1, 2], parent=[-1, 0, 0], levels=levels)

    return build


def _started(scene: Scene, **parameters: Any) -> HlodHysteresis:
    own: dict[str, Any] = {"unused": "lost", **parameters}  # the thesis' own, unless told
    policy = HlodHysteresis(**own)
    policy.reset(scene, BUDGET_MS)
    return policy


def _set(policy: HlodHysteresis, counters: Sequence[float]) -> None:
    policy._counter[1:] = counters  # pyright: ignore[reportPrivateUsage] - states that take long


def _counters(policy: HlodHysteresis) -> list[float]:
    return policy._counter[1:].tolist()  # pyright: ignore[reportPrivateUsage] - not shown otherwise


def _loops(policy: HlodHysteresis) -> tuple[float, float]:
    loops: Any = policy._loops  # pyright: ignore[reportPrivateUsage] - not shown otherwise
    return loops.ms_per_unit, loops.share_ms


def _frames_until(policy: HlodHysteresis, view: Any, *, refined: bool) -> int:
    """Return the number of the frame, from 1, that first draws the children (or the root)."""
    for frame in range(1, 2_000):
        if (len(policy.select(view).ids) == 2) == refined:
            return frame
    raise AssertionError("it never switches")


@pytest.mark.parametrize("urgency", [1.0, 0.25, -0.5, -0.9])
def test_counters_add_urgency_within_the_limit(
    family: Make, make_tree_view: Make, urgency: float
) -> None:
    """From 1.0 a counter goes to 1 + k u, never beyond ±4.51."""
    scene = family(urgency)
    policy, view = _started(scene), make_tree_view(scene)
    _set(policy, [1.0, 1.0])
    for frame in range(1, 12):
        policy.select(view)
        expected = float(np.clip(1.0 + frame * urgency, -4.51, 4.51))
        assert _counters(policy) == pytest.approx([expected, expected])


def test_demotion_takes_two_frames_from_zero_and_seven_from_saturation(
    family: Make, make_tree_view: Make
) -> None:
    """Urgency is at least -1, so that the switch at -1.5 is two frames from 0, seven from 4.51."""
    scene = family(-0.999_999)
    view = make_tree_view(scene)
    for start, frames in ((0.0, 2), (4.51, 7)):
        policy = _started(scene)
        _set(policy, [start, start])
        assert _frames_until(policy, view, refined=False) == frames


def test_promotion_can_take_one_frame(family: Make, make_tree_view: Make) -> None:
    """Urgency has no upper bound: a node with ten times its need is drawn at once."""
    scene = family(9.0)
    assert _frames_until(_started(scene), make_tree_view(scene), refined=True) == 1


def test_cold_start_draws_the_roots(family: Make, make_tree_view: Make) -> None:
    """Counters start at -limit, because at 0 the children would be drawn whatever they cost."""
    scene = family(-0.01)
    view = make_tree_view(scene)
    policy = _started(scene)
    assert policy.select(view).ids.tolist() == [0]
    _set(policy, [0.0, 0.0])
    assert policy.select(view).ids.tolist() == [1, 2]


def test_the_smallest_urgency_switches_slowest(family: Make, make_tree_view: Make) -> None:
    """Frames to a switch fall as |slice - needed| / needed grows, in both directions.

    Up from -4.51 past -1.5 takes 3.01 / u, down from 4.51 to -1.5 takes 6.01 / |u|.
    """
    urgencies = np.array([0.011, 0.03, 0.11, 0.3, 0.7, 0.99])
    for sign, way, refined in ((1.0, 3.01, True), (-1.0, 6.01, False)):
        frames: list[int] = []
        for urgency in sign * urgencies:
            scene = family(float(urgency))
            policy = _started(scene)
            _set(policy, [-4.51 * sign] * 2)
            frames.append(_frames_until(policy, make_tree_view(scene), refined=refined))
        assert frames == np.ceil(way / urgencies).astype(int).tolist()
        assert frames[0] == max(frames)
        assert (np.diff(frames) < 0).all()


@pytest.mark.parametrize(
    ("counters", "expected"),
    [
        ([1.49, -1.49], [1, 2]),  # both truncate to 0
        ([4.5, -4.4], [1, 2]),  # 3 - 2
        ([2.9, -3.1], [0]),  # 1 - 2
        ([-1.49, -1.51], [0]),
    ],
)
def test_siblings_sum_truncated_counters(
    family: Make, make_tree_view: Make, counters: list[float], expected: list[int]
) -> None:
    """Children are drawn while the sum of counter / 1.5 without fractions is at least 0."""
    scene = family(0.0)
    policy = _started(scene)
    _set(policy, counters)
    assert policy.select(make_tree_view(scene)).ids.tolist() == expected


def test_slices_go_by_priority(make_scene: Make, make_levels: Make, make_tree_view: Make) -> None:
    """A child twice as far has a quarter of its sibling's priority, so a fifth of the slice."""
    position = [(0.0, 0.0, -10.0), (0.0, 0.0, -10.0), (0.0, 0.0, -20.0)]
    levels = make_levels([[ROOT], [ROOT], [ROOT]])
    scene = make_scene(position, kind=[0, 1, 2], parent=[-1, 0, 0], levels=levels)
    policy = _started(scene)
    _set(policy, [0.0, 0.0])
    policy.select(make_tree_view(scene))
    assert _counters(policy) == pytest.approx([0.8 - 1.0, 0.2 - 1.0])


def test_slices_go_by_true_surface_and_by_facing(
    make_scene: Make, make_levels: Make, make_tree_view: Make
) -> None:
    """Four times the surface is twice the priority; facing the picture 1.45, edge-on 1, away .55.

    The camera looks along -z, so that a normal of +z faces it.
    """
    position = [(0.0, 0.0, -10.0)] * 3
    levels = make_levels([[ROOT], [ROOT], [ROOT]])
    plain = make_scene(position, kind=[0, 1, 2], parent=[-1, 0, 0], levels=levels)
    for surface_m2, normal, share in (
        ((1.0, 4.0, 1.0), ((0, 0, 0), (0, 0, 0), (0, 0, 0)), 2.0 / 3.0),
        ((1.0, 1.0, 1.0), ((0, 0, 0), (0, 0, 1), (1, 0, 0)), 1.45 / 2.45),
        ((1.0, 1.0, 1.0), ((0, 0, 0), (0, 0, -1), (0, 0, 1)), 0.55 / 2.0),
        ((1.0, 4.0, 0.0), ((0, 0, 0), (0, 0, 0), (0, 0, 0)), 0.5),  # not all known: discs
    ):
        types = replace(
            plain.types, surface_m2=np.array(surface_m2), normal=np.array(normal, dtype=float)
        )
        scene = replace(plain, types=types)
        policy = _started(scene)
        _set(policy, [0.0, 0.0])
        policy.select(make_tree_view(scene))
        assert _counters(policy) == pytest.approx([share - 1.0, -share])


def test_what_a_leaf_cannot_use_goes_to_its_sibling(
    make_scene: Make, make_levels: Make, make_tree_view: Make
) -> None:
    """Of 10 ms for needs of 1 and 20 ms, at equal distance: 2 and 8, where half each is lost."""
    position = [(0.0, 0.0, -10.0)] * 3
    # A hundred times the triangles: priority goes by 1 / sqrt(cost), as benefit does by its root.
    levels = make_levels([[ROOT], [0.1 * ROOT], [2.0 * ROOT]])
    scene = make_scene(position, kind=[0, 1, 2], parent=[-1, 0, 0], levels=levels)
    weight = np.array([0.1, 2.0]) ** -0.5
    lost_ms = 10.0 * weight / weight.sum()
    for unused, slice_ms in (("lost", lost_ms), ("shared", np.array([2.0, 8.0]))):
        policy = _started(scene, unused=unused)
        _set(policy, [0.0, 0.0])
        policy.select(make_tree_view(scene))
        urgency = slice_ms / np.array([1.0, 20.0]) - 1.0
        assert _counters(policy) == pytest.approx(np.clip(urgency, -4.51, 4.51).tolist())


def test_children_out_of_memory_leave_the_parent(family: Make, make_tree_view: Make) -> None:
    """A child in view that is not in memory keeps its siblings from being drawn, too."""
    scene = family(9.0)
    for resident, expected in (([True, True, False], [0]), ([True, True, True], [1, 2])):
        view = make_tree_view(scene, residency=np.array(resident))
        assert _started(scene).select(view).ids.tolist() == expected


def test_a_missing_child_out_of_view_counts_only_if_asked_for(
    family: Make, make_tree_view: Make
) -> None:
    """With all_children the root waits for the child behind the camera."""
    scene = family(9.0, behind=True)
    view = make_tree_view(scene, residency=np.array([True, True, False]))
    assert _started(scene).select(view).ids.tolist() == [1]
    assert _started(scene, all_children=True).select(view).ids.tolist() == [0]


def test_wants_all_that_it_visits_by_priority(family: Make, make_tree_view: Make) -> None:
    """Priority is sqrt(n A) (1 + 1.275 v) / (cost d²): the child behind the camera comes last."""
    scene = family(1.0, behind=True)
    wanted = _started(scene).select(make_tree_view(scene)).wanted
    assert wanted is not None
    # Per unit of cost sqrt(1000) / 873 and sqrt(250) / 218; the near child has twice the root's.
    assert wanted.tolist() == [1, 0, 2]


def test_costs_are_the_thesis_units(make_scene: Make, make_levels: Make) -> None:
    """0.127 for a textured triangle, 0.873 for an untextured one."""
    levels = make_levels([[100.0]])
    counts = levels.counts.copy()
    counts[0, 4] = 60.0  # textured triangles
    scene = make_scene(
        [(0.0, 0.0, -5.0)] * 2, parent=[-1, 0], levels=replace(levels, counts=counts)
    )
    policy = _started(scene)
    units: Any = policy._units  # pyright: ignore[reportPrivateUsage] - not shown otherwise
    assert units.tolist() == pytest.approx([60 * 0.127 + 40 * 0.873] * 2)


def test_time_of_a_unit_follows_measured_time_less_overhead(
    family: Make, make_tree_view: Make
) -> None:
    """A fifth of the way at each report: from 1 µs to (5 - 1) ms / 873 units, then on."""
    scene = family(-0.5).with_costs(CostModel.of(1.0, {"triangles": 0.873e-3}))
    policy = HlodHysteresis()
    policy.reset(scene, 1.873)  # the overhead and the root
    assert policy.select(make_tree_view(scene)).predicted_ms == pytest.approx(1.0 + 0.873)
    expected = 1e-3
    for reports in ([5.0], [5.0, 4.0]):
        predicted_ms = policy.select(make_tree_view(scene, work_ms=reports)).predicted_ms
        expected += 0.2 * ((reports[-1] - 1.0) / 873.0 - expected)
        assert _loops(policy)[0] == pytest.approx(expected)
        assert predicted_ms == pytest.approx(1.0 + 873.0 * expected)


def test_roots_share_more_while_nodes_are_refused_and_time_is_left(
    family: Make, make_tree_view: Make
) -> None:
    """0.3 % a report below 9 ms, back above 11 ms, not at all in between or if none is refused."""
    for urgency, report, turn in ((-0.5, 5.0, 1), (-0.5, 12.0, -1), (-0.5, 10.5, 0), (0.5, 5.0, 0)):
        scene = family(urgency)
        policy = _started(scene, time_rate=0.0)
        policy.select(make_tree_view(scene))
        before = _loops(policy)[1]
        policy.select(make_tree_view(scene, work_ms=[report]))
        assert _loops(policy)[1] == pytest.approx(before * 1.003**turn)


def test_switches_under_way_count_as_time(family: Make, make_tree_view: Make) -> None:
    """Children that are on their way to be drawn leave no time to give out."""
    scene = family(0.02)  # two children of 490 triangles: a little less than the root
    policy = _started(scene, time_rate=0.0)
    view = make_tree_view(scene)
    policy.select(view)
    pending: Any = policy._loops._pending  # pyright: ignore[reportPrivateUsage] - not shown otherwise
    assert pending == pytest.approx(0.873 * (2 * ROOT / 2.04 - ROOT))


@pytest.mark.parametrize("fault", [float("nan"), 0.0, -2.0])
def test_faulty_times_teach_nothing(family: Make, make_tree_view: Make, fault: float) -> None:
    """A report that is missing, zero or negative moves neither loop."""
    scene = family(-0.5)
    policy = _started(scene)
    policy.select(make_tree_view(scene))
    policy.select(make_tree_view(scene, work_ms=[8.0]))
    before = _loops(policy)
    policy.select(make_tree_view(scene, work_ms=[8.0, fault]))
    assert _loops(policy) == before


@pytest.mark.parametrize(
    "wrong", [{"switch": 0.5}, {"switch": 5.0}, {"target": 0.0}, {"time_rate": 1.5}, {"vis": -1.0}]
)
def test_refuses_senseless_parameters(family: Make, wrong: dict[str, float]) -> None:
    """The thesis demands 1 <= switch <= limit; rates are shares."""
    with pytest.raises(InputError, match=f"hlod-hysteresis: expected .*{next(iter(wrong))}.*, got"):
        _started(family(), **wrong)
