"""Known truths about real traces: a hand-held camera, a quadrotor, a car, and 27 people."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lodbench.base.errors import InputError
from lodbench.traces.cameras.camera_trace import CameraTrace, FloatArray
from lodbench.traces.cameras.orientation import view_direction
from lodbench.traces.cameras.read_trace import read_trace
from lodbench.traces.cameras.trace_stats import trace_stats

pytestmark = pytest.mark.realdata


def view_and_up(trace: CameraTrace) -> tuple[FloatArray, FloatArray]:
    """Directions (n, 3) ahead and up of the camera."""
    up: FloatArray = Rotation.from_quat(trace.orientation_xyzw).apply([0.0, 1.0, 0.0])
    return view_direction(trace.orientation_xyzw), up


def along_view(trace: CameraTrace) -> FloatArray:
    """Cosine (n - 1,) between the view direction and each step."""
    step = np.diff(trace.position_m, axis=0)
    view = view_direction(trace.orientation_xyzw)[:-1]
    return np.sum(step * view, axis=1) / np.linalg.norm(step, axis=1)


def test_tum_is_a_hand_held_camera_over_a_desk(data_dir: Path) -> None:
    """30 s at 100 Hz within half a metre, upright, looking down on a desk from 1.3 to 1.8 m."""
    trace = read_trace(str(data_dir / "traces" / "tum-freiburg1-xyz.txt"))
    stats = trace_stats(trace)
    assert (stats.samples, stats.cuts, stats.gaps, stats.repairs) == (3000, 0, 1, ())
    assert stats.duration_s == pytest.approx(30.09, abs=0.01)
    assert stats.rate_hz == pytest.approx(100.0, abs=0.1)
    assert stats.longest_gap_s == pytest.approx(0.11, abs=0.001)
    assert stats.speed_m_s.max < 1.0
    assert 1.3 < stats.low_m[2] < stats.high_m[2] < 1.8
    view, up = view_and_up(trace)
    assert -0.9 < view[:, 2].mean() < -0.4
    assert up[:, 2].min() > 0.4


def test_euroc_is_a_quadrotor_that_lands_where_it_started(data_dir: Path) -> None:
    """83.5 s at 200 Hz, 76 m of flight in a room, upright camera, start and end within 3 cm."""
    trace = read_trace(str(data_dir / "traces" / "euroc-v102.csv"))
    stats = trace_stats(trace)
    assert (stats.samples, stats.gaps, stats.repairs) == (16702, 0, ())
    assert stats.duration_s == pytest.approx(83.505, abs=0.001)
    assert stats.rate_hz == pytest.approx(200.0, abs=0.01)
    assert stats.path_m == pytest.approx(75.89, abs=0.01)
    assert stats.speed_m_s.max < 3.0
    assert np.linalg.norm(trace.position_m[-1] - trace.position_m[0]) < 0.03
    view, up = view_and_up(trace)
    assert up[:, 2].min() > 0.7
    assert np.abs(view[:, 2]).max() < 0.7


def test_kitti_is_a_car_that_drives_ahead(data_dir: Path) -> None:
    """3.72 km in 470.6 s at some 10 Hz, never over 50 km/h, along its view, never leaning much."""
    trace = read_trace(str(data_dir / "traces" / "kitti-00.txt"))
    stats = trace_stats(trace)
    assert (stats.samples, stats.gaps, stats.repairs) == (4541, 0, ())
    assert stats.duration_s == pytest.approx(470.58, abs=0.01)
    assert stats.path_m == pytest.approx(3724.2, abs=0.1)
    assert stats.speed_m_s.max < 50 / 3.6
    assert np.mean(along_view(trace)) > 0.99
    view, up = view_and_up(trace)
    assert np.abs(view[:, 2]).max() < 0.2
    assert up[:, 2].min() > 0.98


def test_people_with_headsets_look_at_the_figure_before_them(data_dir: Path) -> None:
    """27 paths with eyes at 1.6 to 2 m; all look at the figure at the origin, mirrored they don't.

    The mirrored direction is what a wrong sign of Unity's yaw would give.
    """
    path = data_dir / "traces" / "hmd-6dof-h1.csv"
    facing: list[tuple[float, float]] = []
    for number in range(1, 28):
        trace = read_trace(f"{path}#P{number:02d}_V1")
        stats = trace_stats(trace)
        assert stats.rate_hz == pytest.approx(30.0)
        assert (stats.gaps, stats.repairs) == (0, ())
        assert 1.6 < trace.position_m[:, 2].mean() < 2.0
        view, up = view_and_up(trace)
        assert abs(view[:, 2].mean()) < 0.5
        assert up[:, 2].mean() > 0.8
        to_figure = -trace.position_m[:, :2]
        to_figure /= np.linalg.norm(to_figure, axis=1, keepdims=True)
        level = view[:, :2] / np.linalg.norm(view[:, :2], axis=1, keepdims=True)
        mirrored = level * [-1.0, 1.0]
        facing.append((np.sum(level * to_figure, 1).mean(), np.sum(mirrored * to_figure, 1).mean()))
    right, wrong = np.mean(facing, axis=0)
    assert min(cosine for cosine, _ in facing) > 0.7
    assert right > 0.9
    assert wrong < 0.7


def test_headset_file_asks_for_a_choice(data_dir: Path) -> None:
    """Without a selector the 27 paths are listed, shortened; ``first`` takes P01_V1 in H1."""
    path = data_dir / "traces" / "hmd-6dof-h1.csv"
    with pytest.raises(InputError, match=r"P01_V1/H1, .* \(27 in all\), got no choice"):
        read_trace(str(path))
    assert read_trace(f"{path}#first").name == "hmd-6dof-h1#P01_V1/H1"


@pytest.mark.parametrize("file", ["tum-freiburg1-xyz.txt", "euroc-v102.csv", "kitti-00.txt"])
def test_cut_off_real_files_name_the_line(data_dir: Path, tmp_path: Path, file: str) -> None:
    """A real file that ends in the middle of a row is refused at that row."""
    source = data_dir / "traces" / file
    text = source.read_text()
    end = text.index("\n", len(text) // 2) + 30
    (tmp_path / "times.txt").write_text("0\n")
    path = tmp_path / file
    path.write_text(text[:end])
    line = text[:end].count("\n") + 1
    with pytest.raises(InputError, match=rf"{file}:{line}: expected (8|7|12) columns"):
        read_trace(str(path))
