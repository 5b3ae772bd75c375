"""Bounding volumes of 3D Tiles as spheres, worked out by hand."""

import numpy as np
import pytest

from lodbench import InputError
from lodbench.models.tiles.bounding_volumes import bounding_spheres, geodetic_to_ecef, read_volume
from lodbench.models.tiles.tile_schema import Volume

UNIT = np.eye(4)[None]


def sphere_of(volume: Volume, matrix: np.ndarray = UNIT) -> tuple[np.ndarray, float]:
    """Return centre and radius of one volume."""
    kind, numbers = read_volume(volume)
    center, radius = bounding_spheres(np.array([kind]), np.array([numbers]), matrix)
    return center[0], float(radius[0])


def test_a_box_is_held_to_its_corners() -> None:
    """Half axes 1, 2 and 2 about (5, 0, 0): the corner is sqrt(1 + 4 + 4) = 3 away."""
    box = (5.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0)
    center, radius = sphere_of(Volume(box=box))
    assert center.tolist() == [5.0, 0.0, 0.0]
    assert radius == pytest.approx(3.0)


def test_a_transform_moves_and_scales() -> None:
    """Twice as large and moved by 10 along x; a sphere takes the largest of three scales."""
    matrix = np.diag((2.0, 2.0, 2.0, 1.0))[None].copy()
    matrix[0, 0, 3] = 10.0
    box = (5.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0)
    center, radius = sphere_of(Volume(box=box), matrix)
    assert center.tolist() == [20.0, 0.0, 0.0]
    assert radius == pytest.approx(6.0)
    matrix[0, 1, 1] = 7.0
    assert sphere_of(Volume(sphere=(0.0, 0.0, 0.0, 1.5)), matrix)[1] == pytest.approx(10.5)


def test_a_region_holds_all_of_its_surface() -> None:
    """Points of the ellipsoid and of the top height, drawn at random, lie inside the sphere."""
    rng = np.random.default_rng(0)
    for region in (
        (-0.1, 0.6, 0.3, 0.9, 0.0, 500.0),
        (3.1, -1.2, -3.1, 1.2, -50.0, 9e3),  # across the antimeridian
        (2.43, 0.6296, 2.4336, 0.6323, 59.0, 162.0),
        (-np.pi, -np.pi / 2, np.pi, np.pi / 2, 0.0, 0.0),
    ):
        center, radius = sphere_of(Volume(region=region))
        west, south, east, north, low, high = region
        east += 2 * np.pi * (east < west)
        points = geodetic_to_ecef(
            rng.uniform(west, east, 2000),
            rng.uniform(south, north, 2000),
            rng.choice((low, high), 2000),
        )
        assert np.linalg.norm(points - center, axis=1).max() <= radius * (1 + 1e-12)


def test_geodetic_points_known_by_heart() -> None:
    """The equator lies 6,378,137 m from the centre, the pole 6,356,752.3 m."""
    points = geodetic_to_ecef(np.array([0.0, 1.0]), np.array([0.0, np.pi / 2]), np.zeros(2))
    assert points[0].tolist() == [6_378_137.0, 0.0, 0.0]
    assert points[1] == pytest.approx([0.0, 0.0, 6_356_752.314], abs=1e-2)


@pytest.mark.parametrize(
    ("volume", "message"),
    [
        (Volume(), "expected a box, sphere or region"),
        (Volume(sphere=(0.0, 0.0, 0.0, -1.0)), "radius >= 0"),
        (Volume(sphere=(np.inf, 0.0, 0.0, 1.0)), "finite"),
        (Volume(region=(0.0, 1.0, 1.0, 0.0, 0.0, 1.0)), "region west, south"),
        (Volume(region=(0.0, 0.0, 1.0, 1.0, 5.0, 1.0)), "region west, south"),
    ],
)
def test_nonsense_is_refused(volume: Volume, message: str) -> None:
    """What is no volume is named."""
    with pytest.raises(InputError, match=message):
        read_volume(volume)
