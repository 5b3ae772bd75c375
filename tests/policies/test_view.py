"""What a policy sees: distances, areas, speeds and angles against hand-worked values."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from lodbench.models.scene.camera import Camera
from lodbench.models.scene.motion import Placed
from lodbench.models.scene.scene import Scene
from lodbench.policies.frame_times import Completed
from lodbench.policies.view import View

MakeScene = Callable[..., Scene]
MakeView = Callable[..., View]
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def camera_at(
    position: tuple[float, float, float] = (0.0, 0.0, 0.0), yaw_deg: float = 0.0
) -> Camera:
    """Return a camera turned about its own up axis, y, by an angle to the left."""
    half = math.radians(yaw_deg) / 2.0
    turned = (0.0, math.sin(half), 0.0, math.cos(half))
    return Camera(position, turned, 100, 100, math.pi / 2)


def test_geometry_by_hand(make_scene: MakeScene, make_view: MakeView) -> None:
    """A sphere of 2 m at (3, 0, -4): 5 m away, nearest 3 m, atan(3 / 4) off the axis."""
    scene = make_scene([(3.0, 0.0, -4.0), (0.0, 0.0, 30.0)], radius_m=2.0)
    view = make_view(scene)
    assert view.ids.tolist() == [0]
    assert len(view) == 1
    assert view.xyz_m.ravel() == pytest.approx([3.0, 0.0, 4.0])
    assert view.distance_m == pytest.approx([5.0])
    assert view.nearest_m == pytest.approx([3.0])
    assert view.eccentricity_deg == pytest.approx([math.degrees(math.atan2(3, 4))])
    assert view.type_index.tolist() == [0]
    assert view.radius_m.tolist() == [2.0]
    area = math.pi * 2500 * 4 * math.sqrt((25 - 4) / (16 - 4)) / (16 - 4)
    assert view.area_px == pytest.approx([area])


def test_what_is_in_the_picture_by_hand(make_scene: MakeScene, make_view: MakeView) -> None:
    """A box from 12.5 to 62.5 px right of the middle is cut at 50: three quarters are left."""
    view = make_view(make_scene([(3.0, 0.0, -4.0), (0.0, 0.0, -40.0)], radius_m=2.0))
    assert view.inside_share == pytest.approx([0.75, 1.0])
    whole = math.pi * 100.0**2 / (np.array([16.0, 1600.0]) - 4.0)
    assert view.covered_px == pytest.approx(0.4 * np.array([0.75, 1.0]) * whole)


def test_a_sphere_about_the_eye_counts_half_and_covers_its_share_of_the_picture(
    make_scene: MakeScene, make_view: MakeView
) -> None:
    """A sphere that reaches the near plane has no box in the picture."""
    view = make_view(make_scene([(0.0, 0.0, -1.0)], radius_m=5.0))
    assert view.inside_share.tolist() == [0.5]
    assert view.covered_px == pytest.approx([0.4 * 10_000.0])


def test_inside_a_sphere_the_nearest_point_is_the_near_plane(
    make_scene: MakeScene, make_view: MakeView
) -> None:
    """With the eye inside, no distance is below the near plane, and the sphere fills the view."""
    view = make_view(make_scene([(0.0, 0.0, -1.0)], radius_m=5.0))
    assert view.nearest_m.tolist() == [0.1]
    assert view.area_px.tolist() == [10_000.0]


def test_the_same_frame_at_other_nodes(make_scene: MakeScene, make_view: MakeView) -> None:
    """``at`` gives any nodes, in any order, in view or not, as if they had been candidates."""
    rng = np.random.default_rng(0)
    scene = make_scene(rng.uniform(-20, 20, (40, 3)), radius_m=0.5)
    view = make_view(scene, camera_at((1.0, 2.0, 3.0), 40.0))
    assert 0 < len(view) < 40
    again = view.at(view.ids[::-1])
    assert again.area_px[::-1] == pytest.approx(view.area_px)
    assert again.distance_m[::-1] == pytest.approx(view.distance_m)
    everything = view.at(np.arange(40))
    assert everything.inside.sum() == len(view)
    assert np.flatnonzero(everything.inside).tolist() == view.ids.tolist()
    offsets = scene.center_m - np.array([1.0, 2.0, 3.0])
    assert everything.distance_m == pytest.approx(np.linalg.norm(offsets, axis=1))


def test_turning_the_camera_moves_everything_alike(
    make_scene: MakeScene, make_view: MakeView
) -> None:
    """A turn of 3 degrees in 0.1 s moves a node on the horizon by 30 degrees a second."""
    scene = make_scene([(0.0, 0.0, -10.0), (4.0, 0.0, -10.0)])
    view = make_view(scene, camera_at(), previous_camera=camera_at(yaw_deg=3.0), step_s=0.1)
    assert view.speed_deg_s == pytest.approx([30.0, 30.0])


def test_moving_the_camera_moves_near_things_more(
    make_scene: MakeScene, make_view: MakeView
) -> None:
    """A step of 1 m aside in 0.5 s turns nodes at 10 and 40 m by the difference of bearings."""
    scene = make_scene([(0.0, 0.0, -10.0), (0.0, 0.0, -40.0)])
    view = make_view(scene, camera_at((1.0, 0.0, 0.0)), previous_camera=camera_at(), step_s=0.5)
    expected = [math.degrees(math.atan2(1, depth)) / 0.5 for depth in (10, 40)]
    assert view.speed_deg_s == pytest.approx(expected)


def test_moving_nodes_move_for_a_camera_at_rest(make_scene: MakeScene, make_view: MakeView) -> None:
    """Apparent speed compares where a node was with where it is."""
    scene = make_scene([(0.0, 0.0, -10.0)])
    before = Placed.at_rest(np.array([[-2.0], [0.0], [-10.0]]))
    view = make_view(
        scene, camera_at(), previous_camera=camera_at(), step_s=0.25, previous_centers=before
    )
    assert view.speed_deg_s == pytest.approx([math.degrees(math.atan2(2, 10)) / 0.25])


def test_there_is_no_speed_in_the_first_frame(make_scene: MakeScene, make_view: MakeView) -> None:
    """Without a frame before, nothing is known to move."""
    assert make_view(make_scene([(0.0, 0.0, -10.0)])).speed_deg_s.tolist() == [0.0]


def test_residency_and_past_detail(make_scene: MakeScene, make_view: MakeView) -> None:
    """Everything is resident unless a loader says otherwise; details are those last drawn."""
    scene = make_scene([(0.0, 0.0, -10.0), (0.0, 0.0, 10.0), (1.0, 0.0, -10.0)])
    view = make_view(scene, detail=[1.0, 2.0, np.nan])
    assert view.resident.tolist() == [True, True]
    assert view.previous_detail == pytest.approx([1.0, np.nan], nan_ok=True)
    loaded = make_view(scene, residency=np.array([False, True, True]))
    assert loaded.resident.tolist() == [False, True]


def test_arrays_are_computed_once_and_read_only(make_scene: MakeScene, make_view: MakeView) -> None:
    """Asking twice gives the same array, which refuses to be written to."""
    view = make_view(make_scene([(0.0, 0.0, -10.0)]))
    assert view.area_px is view.area_px
    with pytest.raises(ValueError, match="read-only"):
        view.area_px[0] = 0.0
    assert "Projected area" in str(View.area_px.__doc__)


def test_completed_frames_by_column() -> None:
    """Rows beyond the count are hidden; the newest work time is the last row's, NaN if none."""
    times = np.arange(12.0).reshape(3, 4)
    completed = Completed(times, 2)
    assert len(completed) == 2
    assert completed.frame.tolist() == [0, 1]
    assert completed.cpu_ms.tolist() == [0.0, 4.0]
    assert completed.gpu_ms.tolist() == [1.0, 5.0]
    assert completed.work_ms.tolist() == [2.0, 6.0]
    assert completed.present_ms.tolist() == [3.0, 7.0]
    assert completed.last_work_ms() == 6.0
    assert math.isnan(Completed(times, 0).last_work_ms())
    with pytest.raises(ValueError, match="read-only"):
        completed.work_ms[0] = 0.0
    times[0, 0] = 9.0  # the timer's own array stays writable
