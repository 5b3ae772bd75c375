"""Pictures: things are drawn where a pinhole camera sees them, and the near hides the far."""

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.rotation import rotate

SINE = float(np.sin(np.pi / 4))


def block(left: int, top: int, right: int, bottom: int) -> Any:
    """Return a mask of 64 x 64 px that is true in a rectangle."""
    mask = np.zeros((64, 64), dtype=np.bool_)
    mask[top:bottom, left:right] = True
    return mask


def test_a_square_where_projection_says(drawing: Any, quad: Any, covered: Any) -> None:
    """From x = 0 to 2 m and y = -1 to 1 m at 4 m, focal length 32 px: 16 px to the right."""
    pixels = drawing([(1.0, 0.0, -4.0)], [[quad()]]).pixels()
    assert np.array_equal(covered(pixels), block(32, 24, 48, 40))


def test_up_is_the_top_row(drawing: Any, quad: Any, covered: Any) -> None:
    """From y = 1 to 3 m at 4 m: 8 to 24 px above the middle."""
    pixels = drawing([(0.0, 2.0, -4.0)], [[quad()]]).pixels()
    assert np.array_equal(covered(pixels), block(24, 8, 40, 24))


def test_a_moved_center_moves_the_node(drawing: Any, quad: Any, covered: Any) -> None:
    """1 m at 4 m is 8 px; the position in the scene stays as it was."""
    made = drawing([(0.0, 0.0, -4.0)], [[quad()]])
    pixels = made.pixels(centers_m=made.scene.center_m.T + np.array([[1.0], [0.0], [0.0]]))
    assert np.array_equal(covered(pixels), block(32, 24, 48, 40))


def test_scale_and_turn_about_the_origin_of_the_type(drawing: Any, quad: Any, covered: Any) -> None:
    """A square at x = 1 m, turned by 90° about z and scaled by 2, stands 2 m above the node."""
    made = drawing(
        [(0.0, 0.0, -8.0)],
        [[quad((1.0, 0.0, 0.0), 1.0)]],
        scale=2.0,
        orientation_xyzw=(0.0, 0.0, SINE, SINE),
    )
    assert np.array_equal(covered(made.pixels()), block(28, 20, 36, 28))


def test_far_from_the_origin(drawing: Any, quad: Any, covered: Any) -> None:
    """1,000 km away single precision would jump by centimetres; relative to the eye it does not."""
    eye = (1e6 + 1 / 3, -1e6 + 1 / 7, 5e5)
    camera = Camera(eye, (0.0, 0.0, 0.0, 1.0), 64, 64, np.pi / 2)
    pixels = drawing([(eye[0] + 1.0, eye[1], eye[2] - 4.0)], [[quad()]]).pixels(camera)
    assert np.array_equal(covered(pixels), block(32, 24, 48, 40))


@pytest.mark.parametrize("nearest", [0, 1])
def test_the_near_hides_the_far(drawing: Any, quad: Any, nearest: int) -> None:
    """Whichever type is drawn first, the pixel in the middle is that of the nearer square."""
    made = drawing(
        [(0.0, 0.0, -3.0 - nearest), (0.0, 0.0, -4.0 + nearest)], [[quad()], [quad()]], kind=[0, 1]
    )
    both = made.pixels()
    alone, other = (made.pixels(ids=[node])[32, 32] for node in (nearest, 1 - nearest))
    assert both[32, 32].tolist() == alone.tolist()
    assert alone.tolist() != other.tolist()


@pytest.mark.parametrize("instancing", [False, True])
def test_nothing_ahead(drawing: Any, cube: Any, covered: Any, instancing: bool) -> None:
    """What stands behind the camera is not seen, and a frame of no objects shows the sky."""
    made = drawing([(0.0, 0.0, 5.0)], [[cube()]])
    assert not covered(made.pixels(instancing=instancing)).any()
    assert not covered(made.pixels(instancing=instancing, ids=[])).any()


@settings(max_examples=25)
@given(
    turn=st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: sum(x * x for x in q) > 0.1),
    look=st.tuples(*[st.floats(-0.3, 0.3)] * 3),
    center=st.tuples(*[st.floats(-2.0, 2.0)] * 3),
)
def test_any_pose(drawing: Any, cube: Any, covered: Any, turn: Any, look: Any, center: Any) -> None:
    """A small cube off its node's origin is seen where the camera's own projection puts it."""
    q = np.array(turn) / np.linalg.norm(turn)
    gaze = np.array((*look, 1.0)) / np.linalg.norm((*look, 1.0))
    camera = Camera((0.5, -0.5, 1.0), tuple(gaze.tolist()), 128, 128, np.pi / 2)
    node = np.array((0.3, 0.2, -9.0))
    middle = node + 1.5 * rotate(q[None], np.array([center]))[0]
    right, up, forward = camera.to_camera(middle[:, None])[:, 0]
    x, y = 64.0 + 64.0 * right / forward, 64.0 - 64.0 * up / forward
    assume(8.0 < x < 120.0 and 8.0 < y < 120.0 and forward > 2.0)
    made = drawing([node], [[cube(center, 0.4)]], scale=1.5, orientation_xyzw=q, radius_m=4.0)
    mask = covered(made.pixels(camera))
    rows, columns = np.nonzero(mask)
    assert columns.mean() + 0.5 == pytest.approx(x, abs=1.0)
    assert rows.mean() + 0.5 == pytest.approx(y, abs=1.0)


def test_instancing_draws_the_same(drawing: Any, cube: Any, quad: Any) -> None:
    """Bit for bit, with two types, two levels, parts, bones and texture."""
    rng = np.random.default_rng(5)
    n = 60
    made = drawing(
        rng.uniform((-6, -6, -14), (6, 6, -5), (n, 3)),
        [[cube(parts=(4, 8)), cube(side_m=1.5)], [cube(parts=(2, 10)), quad()]],
        kind=rng.integers(0, 2, n),
        scale=rng.uniform(0.3, 0.8, n),
        skinned=[[False, False], [True, False]],
        textured=0.5,
    )
    level = rng.integers(0, 2, n)
    one, each = (made.pixels(instancing=wanted, level=level) for wanted in (True, False))
    assert np.array_equal(one, each)
    assert len(np.unique(one.reshape(-1, 3), axis=0)) > 20


@pytest.mark.parametrize(("skinned", "textured"), [(True, 0.0), (False, 1.0), (True, 1.0)])
def test_variants_of_the_shading(drawing: Any, cube: Any, skinned: bool, textured: float) -> None:
    """Bones and texture each show in the picture, together too."""
    at = [(0.4, 0.3, -3.5)]
    plain = drawing(at, [[cube()]]).pixels()
    other = drawing(at, [[cube()]], skinned=skinned, textured=textured).pixels()
    assert (plain != other).any(axis=2).mean() > 0.02
    if skinned and textured:
        bent = drawing(at, [[cube()]], skinned=True).pixels()
        assert (bent != other).any(axis=2).mean() > 0.02


def test_bones_move_with_time(drawing: Any, cube: Any) -> None:
    """Half a step later the picture is another, a whole step later the same."""
    made = drawing([(0.0, 0.0, -3.5)], [[cube()]], skinned=True)
    start, half, whole = (made.pixels(time_s=time_s) for time_s in (0.0, 0.5, 1.0))
    assert not np.array_equal(start, half)
    assert np.abs(start.astype(int) - whole.astype(int)).max() <= 2


def test_a_type_that_is_skinned_at_its_finest_only(drawing: Any, cube: Any) -> None:
    """Each node is drawn as if alone, though the levels of one type need two programs."""
    made = drawing(
        [(-1.5, 0.0, -4.0), (1.5, 0.0, -4.0)], [[cube(), cube()]], skinned=[[True, False]]
    )
    left, right = (made.pixels(ids=[node], level=node) for node in (0, 1))
    both = made.pixels(level=np.array([0, 1]))
    assert np.array_equal(both[:, :32], left[:, :32])
    assert np.array_equal(both[:, 32:], right[:, 32:])
    assert not np.array_equal(both[:, 32:], made.pixels()[:, 32:])


@pytest.mark.parametrize("instancing", [False, True])
def test_each_skinned_node_has_its_own_bones(drawing: Any, cube: Any, instancing: bool) -> None:
    """Among nodes without bones, whatever is drawn before it, it bends as if alone."""
    corners = [(-2.0, 2.0, -5.0), (2.0, 2.0, -5.0), (-2.0, -2.0, -5.0), (2.0, -2.0, -5.0)]
    made = drawing(corners, [[cube()], [cube()]], kind=[0, 1, 0, 1], skinned=[[False], [True]])
    together = made.pixels(instancing=instancing)
    for node, (x, y, _) in enumerate(corners):
        part = (slice(0, 32) if y > 0 else slice(32, 64), slice(32, 64) if x > 0 else slice(0, 32))
        alone = made.pixels(instancing=instancing, ids=[node])
        assert np.array_equal(together[part], alone[part])


def test_a_smaller_framebuffer_is_shown_at_full_size(drawing: Any, quad: Any, covered: Any) -> None:
    """At half the size a fourth of the samples is shaded, and the square stands where it stood."""
    made = drawing([(1.0, 0.0, -4.0)], [[quad()]])
    renderer = made.renderer()
    small, full = (made.picture(size_px=size) for size in ((32, 32), (64, 64)))
    samples = [renderer.draw(renderer.prepare(p)).shaded_samples for p in (small, full)]
    assert samples == [8 * 8, 16 * 16]
    pixels = renderer.picture(small)
    assert pixels.shape == (64, 64, 3)
    assert covered(pixels)[25:39, 33:47].all()
    assert not covered(pixels)[:22].any()


def test_many_sizes_make_room_for_each_other(drawing: Any, quad: Any) -> None:
    """Twenty sizes in turn, twice, have their own framebuffers: a fourth of each side is hit."""
    made = drawing([(0.0, 0.0, -4.0)], [[quad()]])
    renderer = made.renderer()
    for side in (*range(8, 168, 8), *range(8, 168, 8)):
        timing = renderer.draw(renderer.prepare(made.picture(size_px=(side, side))))
        assert timing.shaded_samples == (side // 4) ** 2


def test_scenes_without_meshes(drawing: Any, quad: Any) -> None:
    """One line says how many meshes are missing, and what to record instead."""
    made = drawing([(0.0, 0.0, -4.0)], [[quad(), quad()]])
    with pytest.raises(InputError, match="expected 2 meshes to draw, one for each level, got 0"):
        type(made)(made.target, made.scene, ()).renderer()
