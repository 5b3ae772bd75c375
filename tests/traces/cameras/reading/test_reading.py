"""Axes, clocks and columns that a file does not state: asked for, or assumed and said."""

from pathlib import Path

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.traces.cameras.read_trace import read_trace
from lodbench.traces.cameras.reading.column_roles import find_roles
from lodbench.traces.cameras.reading.frames import FRAMES, OPENCV, Frame, parse_frame
from lodbench.traces.cameras.reading.poses import Reading
from lodbench.traces.cameras.reading.units import guess_time_unit
from lodbench.traces.cameras.sanity import doubts, sanity_line
from lodbench.traces.cameras.vary import vary

HEADER = "t,x,y,z,qx,qy,qz,qw"


def table(tmp_path: Path, text: str) -> str:
    """Return the path of a file with this text."""
    path = tmp_path / "table.csv"
    path.write_text(text)
    return str(path)


@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_the_world_of_a_frame_keeps_lengths_and_turns_its_up_to_z(frame: Frame) -> None:
    """Its matrix is orthogonal, mirrors only left-handed worlds, and takes the up axis to z."""
    world = frame.world
    assert world @ world.T == pytest.approx(np.eye(3))
    assert np.linalg.det(world) == pytest.approx(-1.0 if frame.left_handed else 1.0)
    axis = np.zeros(3)
    axis["xyz".index(frame.up[-1])] = -1.0 if frame.up.startswith("-") else 1.0
    assert world @ axis == pytest.approx((0.0, 0.0, 1.0))


def test_words_of_a_frame_change_what_they_say() -> None:
    """A name brings its world; words after it change that; what is not said is the file's."""
    assert parse_frame("unity", OPENCV) == Frame("unity", "y", left_handed=True)
    assert parse_frame("z-up, w2c", OPENCV) == Frame("opencv", "z", inverse=True)
    with pytest.raises(InputError, match="did you mean opencv"):
        parse_frame("opencvv", OPENCV)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("y-up,z-up", "expected one of y-up and z-up, got both"),
        ("opencv,c2w,w2c", "expected one of c2w and w2c"),
        ("left-handed,z-up,right-handed", "expected one of left-handed and right-handed"),
        ("unreal,unity", "expected one of unreal and unity"),
    ],
)
def test_words_that_contradict_each_other_are_refused(text: str, says: str) -> None:
    """Which of two came last is no way to say which is meant."""
    with pytest.raises(InputError, match=says):
        parse_frame(text, OPENCV)


def test_the_order_of_the_words_of_a_frame_does_not_matter() -> None:
    """A name after `z-up` does not take the world's up axis back; a word twice says it once."""
    expected = Frame("opencv", "z", inverse=True)
    assert parse_frame("z-up,w2c,opencv,z-up", OPENCV) == expected
    assert parse_frame("opencv,w2c,z-up", OPENCV) == expected


def test_a_mirror_is_refused(tmp_path: Path) -> None:
    """A right-handed camera in a left-handed world would show every picture mirrored."""
    path = table(tmp_path, f"{HEADER}\n0,0,0,0,0,0,0,1\n0.1,1,0,0,0,0,0,1\n")
    with pytest.raises(InputError, match="would mirror pictures"):
        read_trace(path, reading=Reading(frame="opengl,left-handed"))


@pytest.mark.parametrize(
    ("times", "unit"),
    [
        ([0.0, 0.033, 0.066], "s"),
        ([0.0, 16.7, 33.3], "ms"),
        ([0.0, 16_700.0, 33_300.0], "us"),
        ([0.0, 5e7, 1e8], "ns"),
        ([1.4036e18, 1.4036e18 + 5e7], "ns"),
        ([1.597e12, 1.597e12 + 200.0], "ms"),
        ([1.597e9, 1.597e9 + 0.2], "s"),
        ([1.0, 2.0, 3.0], None),  # numbers of frames
        ([5.0], "s"),
    ],
)
def test_the_unit_of_a_clock(times: list[float], unit: str | None) -> None:
    """By its reading since 1970, else by its interval, 1 ms to 1 s."""
    assert guess_time_unit(np.array(times)) == unit


def test_without_times_the_rate_is_asked_for(tmp_path: Path) -> None:
    """Numbers of frames are no times; with a rate they are, and gaps in them are kept."""
    path = table(tmp_path, "frame,x,y,z,yaw\n1,0,0,0,0\n2,1,0,0,0\n4,2,0,0,0\n5,3,0,0,0\n")
    with pytest.raises(InputError, match=r"--rate 30"):
        read_trace(path)
    trace = read_trace(path, reading=Reading(rate_hz=10.0))
    assert trace.time_s == pytest.approx([0.0, 0.1, 0.3, 0.4])
    assert "numbers of frames, 10 a second" in trace.assumed[-1]


@pytest.mark.parametrize("times", ["0,0.02,0.04", "0.5,1.5,2.5"])
def test_a_rate_is_no_divisor_of_times(tmp_path: Path, times: str) -> None:
    """Seconds divided by a rate would be a path many times as fast: refused."""
    rows = "".join(f"{t},{n},0,0,0\n" for n, t in enumerate(times.split(",")))
    path = table(tmp_path, f"time,x,y,z,yaw\n{rows}")
    with pytest.raises(InputError, match="rate: expected a file without times"):
        read_trace(path, reading=Reading(rate_hz=60.0))


def test_units_scale_lengths_and_times(tmp_path: Path) -> None:
    """300 feet are 91.44 m; microseconds said are not taken for milliseconds."""
    path = table(tmp_path, f"{HEADER}\n0,0,0,0,0,0,0,1\n100,300,0,0,0,0,0,1\n")
    trace = read_trace(path, reading=Reading(unit="ft", time_unit="us", frame="opengl,z-up"))
    assert trace.position_m[1] == pytest.approx((91.44, 0.0, 0.0))
    assert trace.duration_s == pytest.approx(1e-4)


def test_named_columns_serve_whatever_they_are_called(tmp_path: Path) -> None:
    """--map names roles; a wrong role or column is answered with the nearest."""
    text = "wann;a;b;c;d\n0.0;1;2;3;90\n0.1;1;2;3;90\n"
    columns = {"time": "wann", "x": "a", "y": "b", "z": "c", "yaw": "d"}
    trace = read_trace(table(tmp_path, text), reading=Reading(columns=columns))
    assert trace.position_m[0] == pytest.approx((1.0, 2.0, 3.0))
    for wrong, told in (({"yaww": "d"}, "yaw"), ({"x": "aa"}, "a")):
        with pytest.raises(InputError, match=f"did you mean {told}|expected one of"):
            read_trace(table(tmp_path, text), reading=Reading(columns={**columns, **wrong}))


@pytest.mark.parametrize(
    ("header", "roles"),
    [
        ("Timestamp,HeadPosX,HeadPosY,HeadPosZ,HeadRotX,HeadRotY,HeadRotZ,HeadRotW", "qx qy qz qw"),
        ("time_ns px py pz qx qy qz qw", "qx qy qz qw"),
        ("t,position.x,position.y,position.z,rotation.x,rotation.y,rotation.z", "rx ry rz"),
        ("time,location_x,location_y,location_z,forward_x,forward_y,forward_z", "forward_x"),
        ("Time (s),X,Y,Z,Heading,Pitch,Roll", "yaw pitch roll"),
    ],
)
def test_columns_are_found_by_the_words_of_their_names(header: str, roles: str) -> None:
    """As headsets, ARCore, Unity and scripts write them."""
    names = header.split(",") if "," in header else header.split()
    found = find_roles(names, {}, Path("table"), 1)
    assert {"x", "y", "z", "time", *roles.split()} <= set(found)
    assert [found[axis].index for axis in "xyz"] == [1, 2, 3]


def test_a_formats_own_axes_are_not_overruled(tmp_path: Path) -> None:
    """TUM states its frame; only its unit may be another, and the message says what to do."""
    path = tmp_path / "path.txt"
    path.write_text("0 1 2 3 0 0 0 1\n0.1 1 2 3 0 0 0 1\n")
    with pytest.raises(InputError, match="--from columns"):
        read_trace(str(path), reading=Reading(frame="unity"))
    halved = read_trace(str(path), reading=Reading(unit="cm"))
    assert halved.position_m[0] == pytest.approx((0.01, 0.02, 0.03))


def test_what_can_hardly_be_is_doubted(tmp_path: Path) -> None:
    """A walk in centimetres is too fast, a turn a frame too sudden; a walk in metres is fine."""
    rows = [f"{n / 30},{n * 4},0,160,{90 * (n % 2)}" for n in range(60)]
    wrong = read_trace(table(tmp_path, "\n".join(["time,x,y,z,yaw", *rows])))
    found = doubts(wrong)
    assert any("median speed of 120" in doubt for doubt in found)
    assert any("2,700 degrees a second" in doubt for doubt in found)
    rows = [f"{n / 30},{n * 0.04},0,1.6,{n}" for n in range(60)]
    right = read_trace(table(tmp_path, "\n".join(["time,x,y,z,yaw", *rows])))
    assert doubts(right) == ()
    assert sanity_line(right).startswith("median speed 1.2 m/s, height 1.6 to 1.6 m")


def test_what_a_reader_took_for_granted_stays_with_the_path(tmp_path: Path) -> None:
    """A stretch and a variation still know the field of view; a stretch says what was assumed."""
    path = tmp_path / "shot.chan"
    path.write_text("\n".join(f"{n} {n} 1 0 0 0 0 40" for n in range(1, 30)))
    trace = read_trace(str(path), reading=Reading(rate_hz=24.0))
    part = trace.stretch(0.2, 1.0)
    assert (part.fovy_deg, part.assumed) == (40.0, trace.assumed)
    assert vary(trace, 1).fovy_deg == 40.0
