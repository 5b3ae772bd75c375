"""Camera paths as users have them: each file gives its right value."""

from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.traces.cameras.read_trace import format_of, read_trace
from lodbench.traces.cameras.reading.poses import Reading
from lodbench.traces.cameras.trace_stats import trace_stats

pytestmark = pytest.mark.realdata

TIMED = [
    # file, format, poses, poses a second, median speed m/s or None
    ("nerfstudio-camera_path.json", "nerfstudio", 96, 24.0, None),
    ("orbslam3-ns.txt", "tum", 40, 20.0, None),
    ("airsim_rec.txt", "airsim", 7, None, None),
    ("h-unreal-view.csv", "unreal-view", 300, 30.03, 0.67),
    ("h-yaw-pitch-roll.csv", "columns", 300, 30.0, 0.67),
    ("h-cesium.json", "cesium", 300, 30.0, 0.67),
]
TIMELESS = [
    ("nerf-transforms-5.json", "nerf", 5),
    ("3dgs-cameras-5.json", "gaussian-splats", 5),
    ("colmap-images.txt", "colmap", 2),
    ("replica-4x4-traj.txt", "matrices", 5),
]


@pytest.mark.parametrize(("name", "known", "poses", "rate_hz", "speed_m_s"), TIMED)
def test_a_path_with_times(
    data_dir: Path,
    name: str,
    known: str,
    poses: int,
    rate_hz: float | None,
    speed_m_s: float | None,
) -> None:
    """Recognised, in seconds and metres; the hand-made circles have radius 2 m at 1.6 m height."""
    path = data_dir / "wild" / "cameras" / name
    assert format_of(path) == known
    trace = read_trace(str(path))
    stats = trace_stats(trace)
    assert len(trace) == poses
    if rate_hz is not None:
        assert stats.rate_hz == pytest.approx(rate_hz, rel=0.002)
    if speed_m_s is not None:
        assert stats.speed_m_s.p50 == pytest.approx(speed_m_s, rel=0.01)
        radius_m = np.linalg.norm(trace.position_m[:, :2], axis=1)
        assert radius_m == pytest.approx(np.full(poses, 2.0), abs=1e-3)
        assert trace.position_m[:, 2] == pytest.approx(np.full(poses, 1.6))


@pytest.mark.parametrize(("name", "known", "poses"), TIMELESS)
def test_a_path_without_times_is_read_at_a_rate(
    data_dir: Path, name: str, known: str, poses: int
) -> None:
    """The rate is asked for in one line, and with it the path has its poses."""
    path = data_dir / "wild" / "cameras" / name
    assert format_of(path) == known
    with pytest.raises(InputError, match="--rate 30"):
        read_trace(str(path))
    trace = read_trace(str(path), reading=Reading(rate_hz=30.0))
    assert trace_stats(trace).rate_hz == pytest.approx(30.0)
    assert len(trace) == poses


def test_colmap_is_world_to_camera(data_dir: Path) -> None:
    """The camera stands at -R^T t, by hand from the printed quaternion and translation."""
    path = data_dir / "wild" / "cameras" / "colmap-images.txt"
    trace = read_trace(str(path), reading=Reading(rate_hz=1.0))
    w, x, y, z = 0.851773, 0.0165051, 0.503764, -0.142941
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    at = -rotation.T @ np.array([-0.737434, 1.02973, 3.74354])
    assert trace.position_m[0] == pytest.approx([at[0], at[2], -at[1]], abs=1e-5)  # y points down


def test_the_field_of_view_of_nerfstudio_is_taken(data_dir: Path) -> None:
    """50 degrees, as every camera of the file has it."""
    path = data_dir / "wild" / "cameras" / "nerfstudio-camera_path.json"
    assert read_trace(str(path)).fovy_deg == 50.0


def test_damaged_paths_are_read_or_refused_in_one_line(data_dir: Path) -> None:
    """Mutated headset CSV and Parquet: nothing is raised but InputError, and nothing is warned."""
    for path in sorted((data_dir / "wild" / "damaged").glob("trace-*")):
        with suppress(InputError):
            read_trace(str(path))
