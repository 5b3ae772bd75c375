"""Triangles to pixels: coverage, order in depth, tiles, small ones."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench.render.pictures.raster import Canvas

RED, BLUE = np.array([[1.0, 0.0, 0.0]]), np.array([[0.0, 0.0, 1.0]])


def canvas(width: int = 200, height: int = 150) -> Canvas:
    """Return a black canvas."""
    return Canvas(np.zeros((height, width, 3)))


def triangle(*corners: tuple[float, float, float]) -> np.ndarray:
    """Return one triangle of (x, y, depth) corners."""
    return np.array([corners])


def test_a_right_triangle_covers_half_of_its_square() -> None:
    """Of 100 by 100 pixels, all whose centre lies below the diagonal."""
    picture = canvas()
    picture.draw(triangle((10, 10, 5), (110, 10, 5), (10, 110, 5)), RED)
    covered = picture.color[..., 0] == 1.0
    row, column = np.nonzero(covered)
    assert covered.sum() == pytest.approx(5_000, abs=100)
    assert ((column - 10 + 0.5) + (row - 10 + 0.5) <= 100.0).all()
    assert (picture.depth[covered] == 5.0).all()
    assert np.isinf(picture.depth[~covered]).all()


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_the_nearer_one_is_seen(order: tuple[int, int]) -> None:
    """Whichever is drawn first, and in one call as in two."""
    both = np.concatenate(
        (
            triangle((0, 0, 2), (150, 0, 2), (0, 150, 2)),
            triangle((0, 0, 1), (50, 0, 1), (0, 50, 1)),
        )
    )
    colors = np.concatenate((RED, BLUE))
    apart, together = canvas(), canvas()
    for i in order:
        apart.draw(both[[i]], colors[[i]])
    together.draw(both[list(order)], colors[list(order)])
    assert (apart.color == together.color).all()
    assert apart.color[10, 10].tolist() == [0.0, 0.0, 1.0]
    assert apart.color[60, 60].tolist() == [1.0, 0.0, 0.0]


def test_depth_is_right_in_perspective() -> None:
    """Half way along an edge from depth 1 to depth 3 in the picture, depth is 1 / mean(1, 1/3)."""
    picture = canvas()
    picture.draw(triangle((0, -50, 1), (200, 75, 3), (0, 200, 1)), RED)
    assert picture.depth[75, 100] == pytest.approx(1.5, rel=0.02)


def test_what_lies_outside_is_left_out() -> None:
    """Partly outside it is cut off; wholly outside nothing is drawn."""
    picture = canvas()
    picture.draw(triangle((-500, -500, 1), (900, -500, 1), (-500, 900, 1)), RED)
    assert (picture.color[..., 0] == 1.0).all()
    empty = canvas()
    empty.draw(triangle((-50, 10, 1), (-10, 10, 1), (-20, 40, 1)), RED)
    empty.draw(np.empty((0, 3, 3)), np.empty((0, 3)))
    assert not empty.color.any()


def test_a_triangle_between_pixel_centres_is_seen() -> None:
    """A distant mesh of tiny triangles does not vanish."""
    picture = canvas()
    picture.draw(triangle((20.1, 30.1, 4), (20.2, 30.1, 4), (20.1, 30.2, 4)), RED)
    assert picture.color[30, 20].tolist() == [1.0, 0.0, 0.0]
    assert picture.color.sum() == 1.0


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_tiles_change_nothing(seed: int) -> None:
    """Pixels of a triangle of any size are those whose centre is inside it, tile by tile or not."""
    rng = np.random.default_rng(seed)
    plan = rng.uniform(-50.0, 250.0, (3, 2))
    picture = canvas()
    picture.draw(np.column_stack((plan, np.ones(3)))[None], RED)
    y, x = np.mgrid[0:150, 0:200] + 0.5
    a, edge = plan, np.roll(plan, -1, axis=0) - plan
    side = edge[:, 0, None, None] * (y - a[:, 1, None, None])
    side = side - edge[:, 1, None, None] * (x - a[:, 0, None, None])
    sure = np.abs(side).min(axis=0) > 1e-6
    inside = (side > 0.0).all(axis=0) | (side < 0.0).all(axis=0)
    if np.ptp(plan, axis=0).max() > 4.0:
        drawn = np.isfinite(picture.depth)
        assert np.array_equal(drawn[sure], inside[sure])
