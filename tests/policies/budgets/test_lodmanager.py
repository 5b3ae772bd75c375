"""Test the sharing of extracted levels between objects of one type."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.models.scene.motion import Placed
from lodbench.models.scene.scene import Scene
from lodbench.policies.budgets.lodmanager import LodManager
from lodbench.policies.selection import Selection, find_violation
from lodbench.policies.shared.levels.level_pools import SharedLevels
from lodbench.policies.view import View
from lodbench.sim.accounting.extraction import IndexSets
from lodbench.sim.accounting.switches import Drawn

Make = Callable[..., Any]
OGRE = (1960.0, 196.0)  # triangles of the paper's test mesh, full and at its minimum of 10 %


@pytest.fixture
def ogres(make_scene: Make, make_levels: Make) -> Callable[[int], Scene]:
    """Return a function that builds so many ogres on one spot."""
    levels = make_levels((OGRE,), continuous=True)
    return lambda count: make_scene(np.zeros((count, 3)), levels=levels, radius_m=1e-3)


@pytest.fixture
def see(make_view: Make) -> Callable[..., View]:
    """Return a function that shows a scene with each object at a given distance straight ahead."""

    def show(scene: Scene, distance_m: Any, inside: Any = True, **state: Any) -> View:
        centers_m = np.zeros((3, len(scene)))
        centers_m[2] = -np.asarray(distance_m, dtype=np.float64)
        mask = np.broadcast_to(np.asarray(inside), (len(scene),))
        before = make_view(scene, **state).state
        seen = replace(before, centers=Placed.at_rest(centers_m), inside=mask)
        ids = np.flatnonzero(mask).astype(np.int32)
        return View(seen, ids, seen.camera.to_camera(centers_m[:, ids]))

    return show


def manager(scene: Scene, **params: Any) -> LodManager:
    """Return a policy whose wanted factor is 1 - distance / 100 m, without feedback."""
    chosen: dict[str, Any] = {"near_m": 0.0, "far_m": 100.0, "gain": 1.0, **params}
    policy = LodManager(**chosen)
    policy.reset(scene, 10.0)
    return policy


def distance_of(lod: Any) -> np.ndarray:
    """Return the distances at which these factors are wanted."""
    return 100.0 * (1.0 - np.asarray(lod))


def resolution_of(lod: Any) -> np.ndarray:
    """Return the resolutions of these factors where the coarsest is 10 %."""
    return 0.1 + 0.9 * np.asarray(lod)


def check(selection: Selection, source: list[int], lod: list[float]) -> None:
    """Compare whose levels are drawn, and which."""
    assert selection.holder is not None
    assert selection.holder.tolist() == source
    assert selection.detail == pytest.approx(resolution_of(lod), abs=1e-12)


def test_six_objects_follow_the_holder_rules(
    ogres: Callable[[int], Scene], see: Callable[..., View]
) -> None:
    """Six objects over four slots, worked by hand through five frames (see the comments)."""
    scene = ogres(6)
    policy = manager(scene, slots=4)
    # Slots 3 3 2 2 1 0.  The lower median of its slot first: B and C extract, A and D borrow.
    lod = [0.95, 0.85, 0.60, 0.65, 0.30, 0.05]
    selection = policy.select(see(scene, distance_of(lod)))
    check(selection, [1, 1, 2, 2, 4, 5], [0.85, 0.85, 0.60, 0.60, 0.30, 0.05])
    # C goes to slot 3, which B holds: it borrows and leaves slot 2; D goes on drawing C's own.
    lod[2] = 0.80
    selection = policy.select(see(scene, distance_of(lod)))
    check(selection, [1, 1, 1, 2, 4, 5], [0.85, 0.85, 0.85, 0.60, 0.30, 0.05])
    # E goes to slot 2, which nobody holds since: it extracts and holds it; slot 1 is empty now.
    lod[4] = 0.62
    selection = policy.select(see(scene, distance_of(lod)))
    check(selection, [1, 1, 1, 2, 4, 5], [0.85, 0.85, 0.85, 0.60, 0.62, 0.05])
    # B goes to the empty slot 1 and extracts; A and C lose what they borrowed, C extracts for
    # slot 3 as its lower median and A borrows from C.  So D, which draws C's own, draws slot 3
    # until its turn, which comes in this frame too: it borrows from E.
    lod[1] = 0.30
    selection = policy.select(see(scene, distance_of(lod)))
    check(selection, [2, 1, 2, 4, 4, 5], [0.80, 0.30, 0.80, 0.62, 0.62, 0.05])
    # F goes to slot 2 and borrows from E; nobody holds slot 0 any more.
    lod[5] = 0.70
    selection = policy.select(see(scene, distance_of(lod)))
    check(selection, [2, 1, 2, 4, 4, 4], [0.80, 0.30, 0.80, 0.62, 0.62, 0.62])


def test_a_holder_out_of_view_lends_its_index_set(
    ogres: Callable[[int], Scene], see: Callable[..., View]
) -> None:
    """What was extracted stays when its owner leaves the view, and the simulator agrees."""
    scene = ogres(3)
    policy = manager(scene, slots=4)
    policy.select(see(scene, distance_of([0.6, 0.1, 0.1]), [True, False, False]))
    view = see(scene, distance_of([0.9, 0.7, 0.1]), [False, True, False])
    selection = policy.select(view)
    assert selection.holder is not None
    assert selection.holder.tolist() == [0]
    assert selection.detail == pytest.approx(resolution_of([0.6]))


def visit_one_by_one(
    state: dict[str, Any], order: list[int], wanted: list[int], may_extract: list[bool]
) -> None:
    """Algorithm 4.1 as a loop, with pointers to holders that left compared and found false."""
    own, source, array = state["own"], state["source"], state["array"]
    for node, slot, free in zip(order, wanted, may_extract, strict=True):
        if source[node] >= 0 and own[source[node]] == slot:
            continue
        holder = array.get(slot)
        if holder is not None and own[holder] == slot:
            if free or source[node] != node:
                source[node] = holder
                for place in [s for s, held in array.items() if held == node]:
                    del array[place]
        elif free:
            own[node], source[node], array[slot] = slot, node, node


@given(st.data())
def test_visiting_at_once_equals_a_loop(data: st.DataObject) -> None:
    """Over several frames the vectorised visit leaves every node with the loop's level."""
    nodes = data.draw(st.integers(1, 12))
    slots = data.draw(st.integers(1, 5))
    levels = SharedLevels(nodes, slots)
    state: dict[str, Any] = {"own": [-1] * nodes, "source": [-1] * nodes, "array": {}}
    for frame in range(data.draw(st.integers(1, 6))):
        order = data.draw(st.permutations(range(nodes)))[: data.draw(st.integers(1, nodes))]
        wanted = [data.draw(st.integers(0, slots - 1)) for _ in order]
        free = [data.draw(st.booleans()) for _ in order]
        lod = np.array(order) + 100.0 * frame
        visited, at = np.array(order, dtype=np.int32), np.array(wanted, dtype=np.int32)
        levels.visit(visited, at, lod, lod, np.array(free))
        visit_one_by_one(state, order, wanted, free)
        assert levels.source.tolist() == state["source"]
        assert levels.slot.tolist() == state["own"]
        held = {s: n for s, n in state["array"].items() if state["own"][n] == s}
        assert {s: n for s, n in enumerate(levels.holder.tolist()) if n >= 0} == held


def all_positions(seen: View, _: np.ndarray) -> np.ndarray:
    """Return the positions of all objects seen."""
    return np.arange(len(seen))


@given(seed=st.integers(0, 2**32 - 1), active=st.sampled_from([None, 3]), sharing=st.booleans())
def test_borrowers_draw_what_their_holders_own(
    make_view: Make, make_scene: Make, make_levels: Make, seed: int, active: int, sharing: bool
) -> None:
    """On random walks in and out of view the simulator accepts every selection.

    Who is passed over would have been left as it is: a visit of everybody ends in the same.
    """
    rng = np.random.default_rng(seed)
    levels = make_levels((OGRE, (500.0, 100.0), (9.0, 4.0, 1.0)), continuous=(True, True, False))
    scene = make_scene(np.zeros((9, 3)), levels=levels, kind=np.arange(9) % 3, radius_m=1e-3)
    policy, everybody = (manager(scene, slots=3, active=active, sharing=sharing) for _ in range(2))
    vars(everybody)["_concerned"] = all_positions
    drawn_sets = IndexSets(scene)
    base = make_view(scene).state
    for _ in range(8):
        centers_m = np.zeros((3, 9))
        centers_m[2] = -rng.uniform(1.0, 120.0, 9)
        inside = rng.random(9) < 0.6
        ids = np.flatnonzero(inside).astype(np.int32)
        state = replace(base, centers=Placed.at_rest(centers_m), inside=inside)
        view = View(state, ids, state.camera.to_camera(centers_m[:, ids]))
        selection = policy.select(view)
        assert selection.detail.tolist() == everybody.select(view).detail.tolist()
        assert find_violation(selection, view.ids, scene) is None
        row, fraction = levels.position(view.type_index, selection.detail)
        none = np.zeros(len(ids))
        drawn_sets.record(selection, Drawn(ids, selection.detail, row, fraction, view, none))


def test_without_sharing_every_object_extracts_its_own(
    ogres: Callable[[int], Scene], see: Callable[..., View]
) -> None:
    """The baseline keeps similar levels too, but nobody borrows."""
    scene = ogres(3)
    policy = manager(scene, slots=4, sharing=False)
    selection = policy.select(see(scene, distance_of([0.6, 0.55, 0.1])))
    assert selection.holder is None
    assert selection.detail == pytest.approx(resolution_of([0.6, 0.55, 0.1]))
    selection = policy.select(see(scene, distance_of([0.7, 0.8, 0.1])))
    assert selection.detail == pytest.approx(resolution_of([0.6, 0.8, 0.1]))


def test_the_active_list_takes_the_largest_differences(
    ogres: Callable[[int], Scene], see: Callable[..., View]
) -> None:
    """With two places the two that are furthest off have their turn, the third after."""
    scene = ogres(4)
    policy = manager(scene, slots=10, active=2, refresh=1)
    policy.select(see(scene, distance_of([0.05, 0.15, 0.25, 0.95])))
    wanted = [0.55, 0.75, 0.65, 0.95]
    selection = policy.select(see(scene, distance_of(wanted)))
    assert selection.detail == pytest.approx(resolution_of([0.55, 0.75, 0.25, 0.95]))
    selection = policy.select(see(scene, distance_of(wanted)))
    assert selection.detail == pytest.approx(resolution_of(wanted))


def test_objects_outside_the_frustum_count_less_and_only_borrow(
    ogres: Callable[[int], Scene], see: Callable[..., View]
) -> None:
    """One place: a factor of 0.9 leaves it to a far-off object outside, one of 0.1 does not.

    Who holds a level outside, as object 2, keeps no place from anybody.
    """
    scene = ogres(4)
    for outside, expected in ((0.9, 0.25), (0.1, 0.55)):
        policy = manager(scene, slots=10, active=1, refresh=1, outside=outside)
        policy.select(see(scene, distance_of([0.95, 0.25, 0.04, 0.06])))  # all of them are new
        seen = [True, True, False, False]
        selection = policy.select(see(scene, distance_of([0.95, 0.55, 0.95, 0.95]), seen))
        assert selection.detail[1] == pytest.approx(resolution_of(expected))


def test_a_list_looks_at_a_slice_of_all_objects_a_frame(
    ogres: Callable[[int], Scene], see: Callable[..., View]
) -> None:
    """With 120 objects at rest, a list of 5 and slices of an eighth: 15 to 20 looks a frame.

    What then jumps is right after all slices have been looked at twice, at most 20 turns each.
    """
    scene = ogres(120)
    rng = np.random.default_rng(2)
    policy = manager(scene, slots=8, active=20, refresh=8)
    view = see(scene, rng.uniform(0.0, 100.0, 120))
    first = policy.select(view)
    assert first.work.objects_visited == 120  # all of them are new
    for _ in range(10):
        selection = policy.select(view)
        assert 15 <= selection.work.objects_visited <= 15 + 20
    jumped = see(scene, rng.uniform(0.0, 100.0, 120))
    selection = first
    for _ in range(16):
        selection = policy.select(jumped)
        assert selection.work.objects_visited <= 15 + 20
    wanted = np.trunc(8.0 * np.minimum(1.0 - jumped.distance_m / 100.0, 1.0 - 1e-9))
    shown = np.trunc(8.0 * np.minimum((selection.detail - 0.1) / 0.9, 1.0 - 1e-9))
    assert (shown == wanted).all()


def test_types_may_have_slots_of_their_own(
    make_scene: Make, make_levels: Make, see: Callable[..., View]
) -> None:
    """Factors 0.6 and 0.9 are similar in two slots and not in ten."""
    levels = make_levels((OGRE, OGRE), continuous=True)
    scene = make_scene(np.zeros((4, 3)), levels=levels, kind=[0, 0, 1, 1], radius_m=1e-3)
    name = scene.types.names[1]
    view = see(scene, distance_of([0.6, 0.9, 0.6, 0.9]))
    detail = manager(scene, slots=2, slots_of=f"{name}:10").select(view).detail
    assert detail[0] == detail[1]
    assert detail[2:] == pytest.approx(resolution_of([0.6, 0.9]))
    for wrong in ("nobody:3", name, f"{name}:0", f"{name}:x", "3"):
        with pytest.raises(InputError, match=r"lodmanager: slots_of: expected .*, got"):
            manager(scene, slots_of=wrong)


def test_discrete_types_have_their_chain_for_slots(
    make_scene: Make, make_levels: Make, see: Callable[..., View]
) -> None:
    """Factors 1, 0.7, 0.5, 0.3 and 0 of a chain of four are levels 0, 1, 1, 2 and 3."""
    scene = make_scene(np.zeros((5, 3)), levels=make_levels(((80.0, 40.0, 20.0, 10.0),)))
    selection = manager(scene).select(see(scene, distance_of([1.0, 0.7, 0.5, 0.3, 0.0])))
    assert selection.detail.tolist() == [0.0, 1.0, 1.0, 2.0, 3.0]
    assert selection.holder is None


def test_spacing_makes_slots_finer_near_the_eye(
    ogres: Callable[[int], Scene], see: Callable[..., View]
) -> None:
    """With ten slots, 0.90 and 0.96 share a level if linear and not if squared; 0.01 and 0.2 do."""
    scene = ogres(4)
    view = see(scene, distance_of([0.9, 0.96, 0.01, 0.2]))
    linear = manager(scene, slots=10).select(view)
    square = manager(scene, slots=10, spacing=2.0).select(view)
    assert len(np.unique(linear.detail[:2])) == 1
    assert len(np.unique(linear.detail[2:])) == 2
    assert len(np.unique(square.detail[:2])) == 2
    assert len(np.unique(square.detail[2:])) == 1


def test_slow_frames_lower_detail_and_faults_never_raise_it(
    ogres: Callable[[int], Scene], see: Callable[..., View]
) -> None:
    """The exponent is multiplied by n per slow frame, divided per fast one, else it rests."""
    scene = ogres(1)
    policy = manager(scene, gain=1.5, limit=4.0, target=1.0, slots=10_000)
    times_ms: list[float] = []
    exponents = [1.5, 1.5**2, 1.5, 1.5, 1.5, 1.5, 1.0, 1 / 1.5]
    for report, exponent in zip((20, 30, 5, np.nan, 0, -1, 4, 3), exponents, strict=True):
        times_ms.append(report)
        selection = policy.select(see(scene, [50.0], work_ms=times_ms))
        assert selection.detail == pytest.approx(resolution_of(0.5**exponent), abs=1e-4)


def test_a_static_view_rests_after_two_frames(
    ogres: Callable[[int], Scene], see: Callable[..., View]
) -> None:
    """Whatever moved before, a view that stands still is the same from its second frame on."""
    scene = ogres(60)
    rng = np.random.default_rng(3)
    policy = manager(scene, slots=8)
    for _ in range(20):
        policy.select(see(scene, rng.uniform(0.0, 110.0, 60), rng.random(60) < 0.7))
    view = see(scene, rng.uniform(0.0, 110.0, 60))
    policy.select(view)
    rested = policy.select(view)
    for _ in range(3):
        again = policy.select(view)
        assert np.array_equal(again.detail, rested.detail)
        assert again.holder is not None
        assert rested.holder is not None
        assert np.array_equal(again.holder, rested.holder)


def test_numbering_does_not_matter(ogres: Callable[[int], Scene], see: Callable[..., View]) -> None:
    """Renumbered objects draw the same resolutions, however they moved."""
    scene = ogres(40)
    rng = np.random.default_rng(4)
    new = rng.permutation(40)
    # All stand on one spot, so that slices by place would go by number.
    one, other = (manager(scene, slots=6, active=9, refresh=1) for _ in range(2))
    for _ in range(10):
        distance_m = rng.uniform(0.0, 110.0, 40)
        first = one.select(see(scene, distance_m)).detail
        second = other.select(see(scene, distance_m[new])).detail
        assert np.array_equal(first[new], second)


@pytest.mark.parametrize(
    "params",
    [
        {"slots": 0},
        {"spacing": 0.0},
        {"active": 0},
        {"outside": 2.0},
        {"gain": 0.9},
        {"limit": 1.0, "gain": 1.1},
        {"target": 0.0},
        {"near_m": 5.0, "far_m": 5.0},
    ],
)
def test_senseless_parameters_are_refused(
    ogres: Callable[[int], Scene], params: dict[str, Any]
) -> None:
    """A parameter out of its range is bad input."""
    with pytest.raises(InputError, match=f"lodmanager: expected .*{next(iter(params))}.*, got"):
        LodManager(**params).reset(ogres(1), 10.0)
