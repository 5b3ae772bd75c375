"""Reading headset paths: choosing one, and from Unity's left hand to the scene's right hand."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from lodbench.base.errors import InputError
from lodbench.traces.cameras.camera_trace import CameraTrace, FloatArray
from lodbench.traces.cameras.formats.headset import read_headset

HEADER = "FrameNumber,HMDPX,HMDPY,HMDPZ,HMDRX,HMDRY,HMDRZ,Participant,Dataset,ViewFrame\n"


def write_rows(folder: Path, rows: list[str]) -> Path:
    """Headset file with the given rows."""
    path = folder / "h.csv"
    path.write_text(HEADER + "".join(f"{row}\n" for row in rows))
    return path


def read_pose(folder: Path, rx: float, ry: float, rz: float) -> CameraTrace:
    """Trace of one sample at Unity's (1, 2, 3) with the given Euler angles."""
    return read_headset(write_rows(folder, [f"1,1,2,3,{rx!r},{ry!r},{rz!r},P1,H1,1"]))


def axes(trace: CameraTrace) -> tuple[FloatArray, FloatArray]:
    """Direction in which the first camera looks, and its up."""
    rotation = Rotation.from_quat(trace.orientation_xyzw[0])
    return rotation.apply([0, 0, -1]), rotation.apply([0, 1, 0])


@pytest.mark.parametrize(
    ("angles", "look", "up"),
    [
        ((0, 0, 0), (0, 1, 0), (0, 0, 1)),
        ((0, 90, 0), (1, 0, 0), (0, 0, 1)),  # Unity's yaw turns to the right
        ((0, 270, 0), (-1, 0, 0), (0, 0, 1)),
        ((90, 0, 0), (0, 0, -1), (0, 1, 0)),  # its pitch looks down
        ((0, 0, 90), (0, 1, 0), (-1, 0, 0)),  # its roll leans the head to the left
        ((90, 90, 0), (0, 0, -1), (1, 0, 0)),  # pitch in the turned head's frame, not the world's
        ((0, 90, 90), (1, 0, 0), (0, 1, 0)),
    ],
)
def test_hand_worked_attitudes(
    tmp_path: Path,
    angles: tuple[float, float, float],
    look: tuple[int, int, int],
    up: tuple[int, int, int],
) -> None:
    """Right, down and left of a person who stands in Unity's world are so in the scene."""
    trace = read_pose(tmp_path, *angles)
    assert trace.position_m.tolist() == [[1.0, 3.0, 2.0]]
    got_look, got_up = axes(trace)
    assert np.allclose(got_look, look, atol=1e-12)
    assert np.allclose(got_up, up, atol=1e-12)


@given(
    angles=st.tuples(*[st.floats(-360.0, 360.0, allow_subnormal=False)] * 3),
)
def test_agrees_with_matrices_in_the_left_handed_frame(
    tmp_path_factory: pytest.TempPathFactory, angles: tuple[float, float, float]
) -> None:
    """Ahead and up worked out in Unity's frame and mirrored at the end are the camera's."""
    ax, ay, az = np.radians(angles)
    about_x = np.array([[1, 0, 0], [0, np.cos(ax), -np.sin(ax)], [0, np.sin(ax), np.cos(ax)]])
    about_y = np.array([[np.cos(ay), 0, np.sin(ay)], [0, 1, 0], [-np.sin(ay), 0, np.cos(ay)]])
    about_z = np.array([[np.cos(az), -np.sin(az), 0], [np.sin(az), np.cos(az), 0], [0, 0, 1]])
    unity = about_y @ about_x @ about_z
    look, up = axes(read_pose(tmp_path_factory.mktemp("h"), *angles))
    assert np.allclose(look, (unity @ [0, 0, 1])[[0, 2, 1]], atol=1e-9)
    assert np.allclose(up, (unity @ [0, 1, 0])[[0, 2, 1]], atol=1e-9)


def test_view_frames_are_thirtieths_of_a_second(tmp_path: Path) -> None:
    """A frame that is missing leaves its time out rather than moving the rest."""
    rows = [f"9,{k},0,0,0,0,0,P1,H1,{k}" for k in (1, 2, 4)]
    trace = read_headset(write_rows(tmp_path, rows))
    assert trace.time_s == pytest.approx([0.0, 1 / 30, 3 / 30])


@pytest.fixture
def crowd(tmp_path: Path) -> Path:
    """File of three people, of whom the first watched two sequences, the rows in turn."""
    keys = ["A,H1", "A,H2", "B,H1", "C,H1"]
    return write_rows(
        tmp_path, [f"1,{i},0,0,0,0,0,{key},{n}" for n in (1, 2) for i, key in enumerate(keys)]
    )


@pytest.mark.parametrize(
    ("selector", "x"), [("B", 2), ("A/H2", 1), ("C/H1", 3), ("first", 0), ("A/H1", 0)]
)
def test_selectors_choose_one_path(crowd: Path, selector: str, x: int) -> None:
    """A participant, a participant and sequence, or simply the first."""
    trace = read_headset(crowd, selector)
    assert trace.position_m[:, 0].tolist() == [x, x]


@pytest.mark.parametrize(
    ("selector", "message"),
    [
        (None, r"one of A/H1, A/H2, B/H1, C/H1, got no choice; .*h.csv#A/H1"),
        ("A", r"one of A/H1, A/H2, got #A, which fits 2 of them"),
        ("Z", r"one of A/H1, A/H2, B/H1, C/H1, got #Z, which fits 0 of them"),
    ],
)
def test_a_choice_must_be_clear(crowd: Path, selector: str | None, message: str) -> None:
    """No choice, two that fit and none that fits list what there is."""
    with pytest.raises(InputError, match=message):
        read_headset(crowd, selector)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEADER, "at least one sample, got only a header"),
        (HEADER.replace("HMDRY", "Yaw"), "h.csv:1: expected one column HMDRY, got 0"),
        (HEADER + "1,0,0,0,0,0,0,P1\n", "h.csv:2: expected 10 columns as in the header, got 8"),
        (HEADER + "1,0,0,0,x,0,0,P1,H1,1\n", "h.csv:2: expected a finite number for HMDRX"),
        (HEADER + '1,0,0,0,"0,0,0,P1,H1,1\n', "h.csv:2: expected"),
    ],
)
def test_broken_files_are_refused(tmp_path: Path, text: str, message: str) -> None:
    """What is missing or broken is named with its line."""
    path = tmp_path / "h.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        read_headset(path)
