"""Layouts: no two circles overlap, all stand inside the square, the seed decides."""

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from lodbench import InputError
from lodbench.base.arrays import FloatArray
from lodbench.models.layouts.placement import LAYOUTS, place

RADII = st.lists(st.floats(0.05, 20.0), min_size=1, max_size=60).map(np.array)


def free_distances(centers: FloatArray, radius: FloatArray) -> FloatArray:
    """Return the gap between the circles of every pair."""
    first, second = np.triu_indices(len(radius), k=1)
    return pdist(centers) - radius[first] - radius[second]


@pytest.mark.parametrize("layout", LAYOUTS)
@settings(max_examples=40, deadline=None)
@given(radius=RADII, spacing=st.floats(0.0, 5.0), seed=st.integers(0, 2**32))
def test_circles_keep_their_spacing(
    layout: str, radius: FloatArray, spacing: float, seed: int
) -> None:
    """Any two circles are at least the spacing apart, and every object has a place."""
    centers = place(layout, radius, np.random.default_rng(seed), spacing_m=spacing)
    assert centers.shape == (len(radius), 2)
    assert np.isfinite(centers).all()
    assert free_distances(centers, radius).min(initial=np.inf) >= spacing - 1e-9


@pytest.mark.parametrize("layout", LAYOUTS)
@settings(max_examples=25, deadline=None)
@given(radius=RADII, seed=st.integers(0, 2**32))
def test_circles_stand_inside_the_side(layout: str, radius: FloatArray, seed: int) -> None:
    """A side that is wide enough holds every circle whole."""
    side = 4.0 * len(radius) * float(radius.max()) + 100.0
    centers = place(layout, radius, np.random.default_rng(seed), side_m=side)
    assert (np.abs(centers).max(axis=1) + radius).max() <= side / 2.0 + 1e-9


@pytest.mark.parametrize("layout", LAYOUTS)
def test_seed_decides(layout: str) -> None:
    """The same seed gives the same places; another moves what is random."""
    radius = np.random.default_rng(7).uniform(0.5, 2.0, 200)
    one, two, other = (place(layout, radius, np.random.default_rng(s)) for s in (1, 1, 2))
    assert np.array_equal(one, two)
    alike = {"grid": True, "rows": True, "city": True, "scatter": False, "forest": False}
    same = np.array_equal(one, other)
    assert same == alike.get(layout, same)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_side_too_small_is_refused(layout: str) -> None:
    """The message names the layout and the side that would do, which then does."""
    radius = np.ones(100)
    with pytest.raises(InputError, match=f"layout {layout}: expected a side of at least") as info:
        place(layout, radius, np.random.default_rng(0), side_m=15.0)
    needed = float(info.value.message.split("at least ")[1].split(" m")[0])
    place(layout, radius, np.random.default_rng(0), side_m=needed + 0.1)


def test_a_circle_wider_than_the_square_is_refused() -> None:
    """One object that does not fit is refused although it covers little on average."""
    radius = np.array([*[0.1] * 1000, 6.0])
    with pytest.raises(InputError, match="expected a side"):
        place("scatter", radius, np.random.default_rng(0), side_m=11.0)


@pytest.mark.parametrize(
    ("layout", "spacing", "side"),
    [
        ("nonsense", 0.0, None),
        ("grid", -1.0, None),
        ("grid", np.nan, None),
        ("scatter", 0.0, np.nan),
        ("scatter", 0.0, 0.0),
    ],
)
def test_nonsense_is_refused(layout: str, spacing: float, side: float | None) -> None:
    """Unknown layouts and impossible lengths are input errors."""
    with pytest.raises(InputError):
        place(layout, np.ones(3), np.random.default_rng(0), spacing_m=spacing, side_m=side)


def test_grid_of_four_by_hand() -> None:
    """Four circles of radius 1 stand two metres apart about the origin."""
    centers = place("grid", np.ones(4), np.random.default_rng(0))
    assert centers.tolist() == [[-1, -1], [1, -1], [-1, 1], [1, 1]]


def test_rows_have_aisles() -> None:
    """Rows of unit circles touch along a row and leave an aisle of one circle between rows."""
    centers = place("rows", np.ones(50), np.random.default_rng(0))
    lines = np.unique(centers[:, 1])
    assert np.diff(lines).tolist() == [4.0] * (len(lines) - 1)
    for y in lines:
        assert np.allclose(np.diff(np.sort(centers[centers[:, 1] == y, 0])), 2.0)


def test_city_has_streets() -> None:
    """Four blocks of twenty lots leave a street of 10 m, free of circles, on both axes."""
    centers = place("city", np.ones(80), np.random.default_rng(0))
    assert (np.abs(centers) - 1.0).min() == pytest.approx(5.0)
    assert len(np.unique(np.sign(centers), axis=0)) == 4


def test_forest_is_clustered() -> None:
    """Neighbours in a forest are nearer than in a scatter of the same density."""
    radius, rng = np.ones(2_000), np.random.default_rng(3)
    side = 250.0
    nearest = {}
    for layout in ("scatter", "forest"):
        centers = place(layout, radius, rng, side_m=side)
        cells = np.floor((centers + side / 2) / 25.0).astype(int)
        nearest[layout] = np.bincount(cells[:, 0] * 10 + cells[:, 1], minlength=100).var()
    assert nearest["forest"] > 3.0 * nearest["scatter"]


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_hundred_thousand_objects(layout: str) -> None:
    """Work grows with the objects, not with their pairs (5e9 here)."""
    radius = np.exp(np.random.default_rng(5).normal(0.0, 0.5, 100_000))
    begin = time.perf_counter()
    centers = place(layout, radius, np.random.default_rng(0))
    assert len(centers) == 100_000
    assert time.perf_counter() - begin < 20.0
