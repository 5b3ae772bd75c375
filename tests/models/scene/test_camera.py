"""The camera's frame and projected areas of spheres, by closed form and by rasterising."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.models.scene.camera import Camera, eccentricity_deg, projected_area_px

UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def camera_of(width_px: int = 800, height_px: int = 600, fovy_deg: float = 60.0) -> Camera:
    """Return a camera at the origin that looks along -z."""
    return Camera((0.0, 0.0, 0.0), UPRIGHT, width_px, height_px, math.radians(fovy_deg))


def area(camera: Camera, center: tuple[float, float, float], radius_m: float) -> float:
    """Return the projected area of one sphere given by right, up and forward coordinates."""
    distance = np.array([math.dist(center, (0, 0, 0))])
    values = projected_area_px(
        np.array([float(center[2])]), distance, np.array([float(radius_m)]), camera
    )
    return float(values[0])


def rasterised(camera: Camera, center: tuple[float, float, float], radius_m: float) -> float:
    """Return the area by casting rays through a grid four times finer than the pixels."""
    steps = 4
    x = (np.arange(camera.width_px * steps) + 0.5) / steps - camera.width_px / 2
    y = (np.arange(camera.height_px * steps) + 0.5) / steps - camera.height_px / 2
    rays = np.stack(np.broadcast_arrays(x[None, :], y[:, None], camera.focal_px), axis=-1)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    along = rays @ np.array(center)
    miss = np.dot(center, center) - along**2
    return float(np.count_nonzero((miss < radius_m**2) & (along > 0))) / steps**2


def test_focal_length_is_that_of_the_field_of_view() -> None:
    """Half the height over the tangent of half the field: 1080 px at 60 degrees give 935.307."""
    assert camera_of(1920, 1080).focal_px == pytest.approx(935.3074360871937)
    assert camera_of(1920, 1080).viewport_px == 1920 * 1080


def test_camera_axes_by_hand() -> None:
    """Turned by 90 degrees about z, right is +y, up is -x, and it still looks along -z."""
    turned = (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5))
    camera = Camera((1.0, 2.0, 3.0), turned, 10, 10, 1.0)
    points = np.array([[1.0, 1.0, 0.0], [3.0, 2.0, 2.0], [3.0, 1.0, 3.0]])
    expected = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 2.0, 0.0]])
    assert camera.to_camera(points) == pytest.approx(expected, abs=1e-12)


@given(st.floats(2.0, 500.0), st.floats(0.01, 1.5))
def test_a_sphere_on_the_axis_is_a_circle(depth_m: float, radius_m: float) -> None:
    """On axis the area is ``pi f² r² / (z² - r²)``, unless that is more than the viewport."""
    camera = camera_of()
    expected = math.pi * (camera.focal_px * radius_m) ** 2 / (depth_m**2 - radius_m**2)
    assert area(camera, (0, 0, depth_m), radius_m) == pytest.approx(min(expected, 480_000))


@pytest.mark.parametrize(
    ("center", "radius_m"),
    [((0, 0, 10), 1), ((3, 0, 10), 1), ((-4, 2.5, 9), 1.2), ((2, -1, 6), 1.5), ((0, 0.4, 3), 0.8)],
)
def test_area_agrees_with_casting_rays(center: tuple[float, float, float], radius_m: float) -> None:
    """Off the axis the image is a longer ellipse; a sphere wholly in view covers its area."""
    camera = camera_of()
    got = area(camera, center, radius_m)
    assert got == pytest.approx(rasterised(camera, center, radius_m), rel=2e-3)


@pytest.mark.parametrize(
    ("center", "radius_m"),
    [
        ((0, 0, 1), 5),  # the eye is inside
        ((0, 0, -1), 2),  # inside, the centre behind
        ((0, 0, 1.05), 1),  # its front is nearer than the near plane
        ((3, 0, 0.5), 1),  # beside the eye, across the plane of the eye
        ((0, 0, 1.2), 1.0),  # in front, but larger than the viewport
        ((0, 0, 0), 0.05),  # centre at the eye
    ],
)
def test_spheres_about_the_eye_count_as_the_whole_viewport(
    center: tuple[float, float, float], radius_m: float
) -> None:
    """Where the image is unbounded or fills the screen, the area is the viewport's, never more."""
    camera = camera_of()
    assert area(camera, center, radius_m) == camera.viewport_px


@given(st.floats(-50, 50), st.floats(-50, 50), st.floats(-50, 50), st.floats(1e-3, 60.0))
def test_area_is_finite_and_within_the_viewport(
    x: float, y: float, z: float, radius_m: float
) -> None:
    """Whatever the sphere, its area is from 0 to the viewport's."""
    assert 0.0 <= area(camera_of(), (x, y, z), radius_m) <= 480_000


@given(st.floats(0.2, 40.0), st.floats(0.0, 3.0), st.floats(1.01, 2.0))
def test_nearer_is_never_smaller(depth_m: float, aside_m: float, factor: float) -> None:
    """Moving a sphere away along the view axis never enlarges it."""
    camera = camera_of()
    near = area(camera, (aside_m, 0, depth_m), 0.5)
    far = area(camera, (aside_m, 0, depth_m * factor), 0.5)
    assert far <= near * (1 + 1e-12)


def test_eccentricity_by_hand() -> None:
    """Ahead is 0 degrees, aside 90, behind 180, and at the eye 0."""
    depth = np.array([5.0, 0.0, -2.0, 1.0, 0.0])
    distance = np.array([5.0, 3.0, 2.0, math.sqrt(2.0), 0.0])
    expected = [0.0, 90.0, 180.0, 45.0]
    assert eccentricity_deg(depth, distance)[:4] == pytest.approx(expected)
    assert eccentricity_deg(depth, distance)[4] == 0.0


@pytest.mark.parametrize(("fovy_rad", "near_m"), [(0.0, 0.1), (math.pi, 0.1), (1.0, 0.0)])
def test_impossible_lenses_are_refused(fovy_rad: float, near_m: float) -> None:
    """A field of view of nothing or of half the world, and a near plane at the eye, are errors."""
    with pytest.raises(InputError, match="expected field of view in"):
        Camera((0.0, 0.0, 0.0), UPRIGHT, 10, 10, fovy_rad, near_m)
