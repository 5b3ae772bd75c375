"""Reading EuRoC ground truth."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lodbench.base.errors import InputError
from lodbench.traces.cameras.formats.euroc import read_euroc

HEADER = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], …\n"
# Rotation of T_BS of cam0 in the data set's sensor.yaml: optical frame to body frame.
CAM0_IN_BODY = [
    [0.0148655429818, -0.999880929698, 0.00414029679422],
    [0.999557249008, 0.0149672133247, 0.025715529948],
    [-0.0257744366974, 0.00375618835797, 0.999660727178],
]


def test_nanoseconds_and_columns(tmp_path: Path) -> None:
    """Times are exact differences of the whole nanoseconds; later columns are not read."""
    path = tmp_path / "a.csv"
    path.write_text(
        HEADER
        + "1403715524907143168,1,2,3,1,0,0,0,9,9,9\n"
        + "1403715524912143104,4,5,6,1,0,0,0,nan,9,9\n"
    )
    trace = read_euroc(path)
    assert trace.time_s.tolist() == [0.0, 4_999_936 / 1e9]
    assert trace.position_m.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert trace.origin_s == 1403715524907143168 / 1e9


@pytest.mark.parametrize("seed", range(3))
def test_camera_is_the_left_camera_to_within_two_degrees(tmp_path: Path, seed: int) -> None:
    """For any attitude the chosen camera differs from cam0 by its small mounting angle only."""
    body = Rotation.random(rng=np.random.default_rng(seed))
    x, y, z, w = body.as_quat().tolist()
    path = tmp_path / "a.csv"
    path.write_text(f"{HEADER}1403715524907143168,0,0,0,{w},{x},{y},{z}\n")
    ours = Rotation.from_quat(read_euroc(path).orientation_xyzw[0])
    optical_to_camera = Rotation.from_matrix(np.diag([1.0, -1.0, -1.0]))
    cam0 = body * Rotation.from_matrix(CAM0_IN_BODY) * optical_to_camera
    assert 1.7 < np.degrees((ours.inv() * cam0).magnitude()) < 1.8


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("1.5,0,0,0,1,0,0,0", "a.csv:2: expected a timestamp in whole nanoseconds, got '1.5'"),
        ("-5,0,0,0,1,0,0,0", "whole nanoseconds"),
        (f"{'9' * 30},0,0,0,1,0,0,0", "whole nanoseconds"),
        ("5,0,0,0,1,0,0", "a.csv:2: expected 7 columns"),
        ("5,0,0,0,1,0,0,", "for q_z, got ''"),
    ],
)
def test_broken_rows_are_refused_with_their_line(tmp_path: Path, row: str, message: str) -> None:
    """A timestamp with a fraction, a short row and an empty field are named."""
    path = tmp_path / "a.csv"
    path.write_text(f"{HEADER}{row}\n")
    with pytest.raises(InputError, match=message):
        read_euroc(path)
