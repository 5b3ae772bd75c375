"""The refinement rule of 3D Tiles on a small tileset, worked by hand."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.scene import Scene
from lodbench.policies.thresholds.screen_space_error import ScreenSpaceError

Make = Callable[..., Any]
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


@pytest.fixture
def tileset(make_scene: Make, make_levels: Make) -> Callable[..., Scene]:
    """Return a function that builds tile 0 (error 1 m) -> 1, 2 (0.25 m), 1 -> 3 (exact)."""

    def build(*, add: bool = False) -> Scene:
        levels = make_levels(
            [[100.0], [200.0], [200.0], [800.0]], error_m=[[1.0], [0.25], [0.25], [0.0]]
        )
        return make_scene(
            [(0.0, 0.0, 0.0)] * 4,
            kind=np.arange(4),
            parent=[-1, 0, 0, 1],
            additive=[add] * 4,
            levels=levels,
        )

    return build


def _camera(nearest_m: float) -> Camera:
    """Return a camera of 1920 x 1080 px and 60 degrees at a distance from the unit spheres."""
    return Camera((0.0, 0.0, 1.0 + nearest_m), UPRIGHT, 1920, 1080, np.radians(60.0))


def _drawn(policy: ScreenSpaceError, view: Any) -> list[int]:
    return policy.select(view).ids.tolist()


@pytest.mark.parametrize(
    ("nearest_m", "expected"),
    [(58.47, [0]), (58.45, [1, 2]), (14.62, [1, 2]), (14.61, [2, 3])],
)
def test_one_metre_is_sixteen_pixels_at_58_46_metres(
    tileset: Make, make_tree_view: Make, nearest_m: float, expected: list[int]
) -> None:
    """1080 px and 60 degrees: 935.307 px a metre at 1 m, so 16 px of 1 m at 58.457 m."""
    scene = tileset()
    policy = ScreenSpaceError()
    policy.reset(scene, 16.0)
    assert _drawn(policy, make_tree_view(scene, _camera(nearest_m))) == expected


@pytest.mark.parametrize(
    ("nearest_m", "expected"), [(58.47, [0]), (58.45, [0, 1, 2]), (14.61, [0, 1, 2, 3])]
)
def test_tiles_that_add_are_joined_by_their_children(
    tileset: Make, make_tree_view: Make, nearest_m: float, expected: list[int]
) -> None:
    """With ADD what is refined stays drawn."""
    scene = tileset(add=True)
    policy = ScreenSpaceError()
    policy.reset(scene, 16.0)
    assert _drawn(policy, make_tree_view(scene, _camera(nearest_m))) == expected


def test_replacing_tiles_wait_for_all_children_and_adding_ones_do_not(
    tileset: Make, make_tree_view: Make
) -> None:
    """With tile 2 missing, REPLACE draws the root alone and ADD the root and tile 1."""
    resident = np.array([True, True, False, False])
    for add, expected in ((False, [0]), (True, [0, 1])):
        scene = tileset(add=add)
        policy = ScreenSpaceError()
        policy.reset(scene, 16.0)
        view = make_tree_view(scene, _camera(20.0), residency=resident)
        assert _drawn(policy, view) == expected


def test_wants_what_it_would_draw_coarsest_error_first(tileset: Make, make_tree_view: Make) -> None:
    """Children of the root, which take off 1 m of error, come before the child of tile 1."""
    scene = tileset()
    policy = ScreenSpaceError()
    policy.reset(scene, 16.0)
    resident = np.array([True, False, False, False])
    selection = policy.select(make_tree_view(scene, _camera(10.0), residency=resident))
    assert selection.ids.tolist() == [0]
    assert selection.wanted is not None
    assert selection.wanted.tolist() == [1, 2, 3]


def test_memory_raises_the_tolerance_by_two_percent_a_frame_and_lets_it_fall(
    tileset: Make, make_tree_view: Make
) -> None:
    """At 50 m the root's error is 18.7 px: eight frames of 2 % end the wish for its children."""
    scene = tileset()
    policy = ScreenSpaceError(memory_bytes=1_000.0)  # the children take 2 x 7,200 bytes
    policy.reset(scene, 16.0)
    view = make_tree_view(scene, _camera(50.0))
    wanted: list[int] = []
    for _ in range(10):
        selection = policy.select(view)
        assert selection.wanted is not None
        wanted.append(len(selection.wanted))
    # The tolerance rises above 18.7 px after 8 frames, falls in the next, and rises again.
    assert wanted == [2] * 8 + [0, 2]
    near = make_tree_view(scene, _camera(1e5))
    for _ in range(20):
        policy.select(near)
    assert policy.select(view).ids.tolist() == [1, 2]


def test_flat_scenes_take_the_coarsest_level_within_the_tolerance(
    make_scene: Make, make_levels: Make, make_view: Make
) -> None:
    """Levels that err by 0, 0.1 and 0.4 m stay within 16 px from 5.8 m and 23.4 m on."""
    levels = make_levels([[900.0, 300.0, 100.0]], error_m=[[0.0, 0.1, 0.4]])
    scene = make_scene([(0.0, 0.0, -z - 1.0) for z in (5.8, 5.9, 23.3, 23.5)], levels=levels)
    policy = ScreenSpaceError()
    policy.reset(scene, 16.0)
    camera = Camera((0.0, 0.0, 0.0), UPRIGHT, 1920, 1080, np.radians(60.0))
    assert policy.select(make_view(scene, camera)).detail.tolist() == [0.0, 1.0, 1.0, 2.0]


@pytest.mark.parametrize("given", [{"tolerance_px": 0.0}, {"memory_bytes": -1.0}])
def test_refuses_senseless_parameters(tileset: Make, given: dict[str, float]) -> None:
    """A tolerance or memory that is not positive is refused by name."""
    with pytest.raises(InputError, match=f"expected {next(iter(given))} in"):
        ScreenSpaceError(**given).reset(tileset(), 16.0)
