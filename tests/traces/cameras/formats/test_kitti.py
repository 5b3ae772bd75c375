"""Reading KITTI odometry poses and their times."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lodbench.base.errors import InputError
from lodbench.traces.cameras.formats.kitti import read_kitti
from lodbench.traces.cameras.orientation import view_direction

LEVEL = "1 0 0 {x} 0 1 0 {y} 0 0 1 {z}"


def write_poses(folder: Path, rows: list[str], times: str | None = None) -> Path:
    """Poses file ``00.txt`` and, if given, ``times.txt`` beside it."""
    path = folder / "00.txt"
    path.write_text("\n".join(rows) + "\n")
    if times is not None:
        (folder / "times.txt").write_text(times)
    return path


def test_ahead_becomes_y_and_down_becomes_minus_z(tmp_path: Path) -> None:
    """A car 5 m ahead (z), 1 m to the right (x), 2 m down (y) is at (1, 5, -2), looks along +y."""
    path = write_poses(tmp_path, [LEVEL.format(x=0, y=0, z=0), LEVEL.format(x=1, y=2, z=5)], "0\n1")
    trace = read_kitti(path)
    assert trace.position_m.tolist() == [[0, 0, 0], [1, 5, -2]]
    assert np.allclose(view_direction(trace.orientation_xyzw), [0, 1, 0])
    up = Rotation.from_quat(trace.orientation_xyzw).apply([0, 1, 0])
    assert np.allclose(up, [0, 0, 1])


def test_right_turn_looks_right(tmp_path: Path) -> None:
    """The optical frame turned 90 degrees about its downward y looks along the scene's +x."""
    path = write_poses(tmp_path, ["0 0 1 0 0 1 0 0 -1 0 0 0"], "0")
    assert np.allclose(view_direction(read_kitti(path).orientation_xyzw), [1, 0, 0])


def test_times_are_found_by_name_or_named(tmp_path: Path) -> None:
    """NAME-times.txt comes before times.txt, and a selector before both."""
    path = write_poses(tmp_path, [LEVEL.format(x=0, y=0, z=0)] * 2, "0\n1\n")
    assert read_kitti(path).duration_s == 1.0
    (tmp_path / "00-times.txt").write_text("0\n2\n")
    assert read_kitti(path).duration_s == 2.0
    (tmp_path / "other.txt").write_text("0\n3\n")
    assert read_kitti(path, "other.txt").duration_s == 3.0


def test_missing_times_are_not_invented(tmp_path: Path) -> None:
    """Without times the error names the files that would do."""
    path = write_poses(tmp_path, [LEVEL.format(x=0, y=0, z=0)])
    with pytest.raises(InputError, match=r"00-times.txt or times.txt beside it.*00.txt#FILE"):
        read_kitti(path)


def test_times_of_another_sequence_are_refused(tmp_path: Path) -> None:
    """There must be one time for each pose."""
    path = write_poses(tmp_path, [LEVEL.format(x=0, y=0, z=0)], "0\n1\n")
    with pytest.raises(InputError, match=r"times.txt: expected 1 times.*00.txt, got 2"):
        read_kitti(path)


def test_matrix_off_a_rotation_is_mended_and_counted(tmp_path: Path) -> None:
    """A matrix scaled by 1 % is projected on the nearest rotation, here none at all."""
    path = write_poses(tmp_path, ["1.01 0 0 0 0 1.01 0 0 0 0 1.01 0"], "0")
    trace = read_kitti(path)
    assert np.allclose(view_direction(trace.orientation_xyzw), [0, 1, 0], atol=1e-12)
    assert [str(repair) for repair in trace.repairs] == ["1 matrices made rotations"]


@pytest.mark.parametrize(
    "matrix",
    [
        "-1 0 0 0 0 1 0 0 0 0 1 0",
        "0 0 0 0 0 0 0 0 0 0 0 0",
        "2 0 0 0 0 1 0 0 0 0 1 0",
        "1e200 0 0 0 0 1e200 0 0 0 0 1e200 0",
    ],
)
def test_no_rotation_is_refused_with_its_line(tmp_path: Path, matrix: str) -> None:
    """A mirror, a zero matrix and a stretched one cannot be a camera's orientation."""
    path = write_poses(tmp_path, [LEVEL.format(x=0, y=0, z=0), matrix], "0\n1\n")
    with pytest.raises(InputError, match=r"00.txt:2: expected the first three columns to be a rot"):
        read_kitti(path)
