"""One path, written as each format has it, is read as the same positions and views.

The camera goes round a circle of 2 m at 1.6 m height in 10 s, looks at its middle, and is level.
Expected poses are in the scene frame by hand: at angle a it stands at (2 cos a, 2 sin a, 1.6) and
looks along (-cos a, -sin a, 0); up is z.
"""

import base64
import json
import math
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lodbench.base.arrays import FloatArray
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.orientation import view_direction
from lodbench.traces.cameras.read_trace import format_of, read_trace
from lodbench.traces.cameras.reading.poses import Reading

COUNT, RATE_HZ = 101, 10.0
ANGLE = 2.0 * np.pi * np.arange(COUNT) / (COUNT - 1)
TIME_S = np.arange(COUNT) / RATE_HZ
PLACE = np.stack((2.0 * np.cos(ANGLE), 2.0 * np.sin(ANGLE), np.full(COUNT, 1.6)), axis=1)
AHEAD = np.stack((-np.cos(ANGLE), -np.sin(ANGLE), np.zeros(COUNT)), axis=1)
RIGHT = np.stack((-np.sin(ANGLE), np.cos(ANGLE), np.zeros(COUNT)), axis=1)
UP = np.tile((0.0, 0.0, 1.0), (COUNT, 1))

Z_UP = np.eye(3)
Y_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])  # from the scene: x stays, z becomes y
Y_DOWN = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
Z_DOWN = np.diag([1.0, -1.0, -1.0])
UNREAL = np.diag([1.0, -1.0, 1.0])  # y to the right
UNITY = np.array([[1.0, 0, 0], [0, 0, 1], [0, 1, 0]])


def posed(world: FloatArray, *columns: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return positions and rotations in a file's world, the camera's axes given in the scene."""
    axes = np.stack(columns, axis=2)
    return PLACE @ world.T, world @ axes


def rows4(position: FloatArray, rotation: FloatArray) -> FloatArray:
    """Return 4 x 4 matrices."""
    whole = np.tile(np.eye(4), (COUNT, 1, 1))
    whole[:, :3, :3], whole[:, :3, 3] = rotation, position
    return whole


def lines(table: FloatArray, separator: str = " ") -> str:
    """Return rows of numbers as text."""
    return "\n".join(separator.join(f"{value:.9f}" for value in row) for row in table.tolist())


def nerf() -> str:
    """NeRF: camera to world, OpenGL, z up, with the horizontal field of view."""
    position, rotation = posed(Z_UP, RIGHT, UP, -AHEAD)
    shots = [{"transform_matrix": m} for m in rows4(position, rotation).tolist()]
    wide = {"camera_angle_x": math.radians(90.0), "w": 200, "h": 100}
    return json.dumps({**wide, "frames": shots})


def nerfstudio() -> str:
    """nerfstudio: 16 numbers row by row, and frames a second."""
    position, rotation = posed(Z_UP, RIGHT, UP, -AHEAD)
    flat = rows4(position, rotation).reshape(COUNT, 16).tolist()
    shots = [{"camera_to_world": m, "fov": 50.0, "aspect": 1.5} for m in flat]
    return json.dumps({"camera_path": shots, "fps": RATE_HZ, "seconds": 10})


def splats() -> str:
    """Gaussian splatting: OpenCV axes, y down."""
    position, rotation = posed(Y_DOWN, RIGHT, -UP, AHEAD)
    pairs = zip(position.tolist(), rotation.tolist(), strict=True)
    return json.dumps([{"id": 0, "position": p, "rotation": r} for p, r in pairs])


def inverse(position: FloatArray, rotation: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return world-to-camera poses."""
    turned = np.swapaxes(rotation, 1, 2)
    return -np.einsum("nij,nj->ni", turned, position), turned


def colmap() -> str:
    """COLMAP: world to camera, w first, a blank line for no points."""
    position, rotation = inverse(*posed(Y_DOWN, RIGHT, -UP, AHEAD))
    w_first = Rotation.from_matrix(rotation).as_quat()[:, [3, 0, 1, 2]]
    rows = lines(np.hstack((w_first, position))).split("\n")
    shots = [f"{n} {row} 1 {n:04}.jpg\n" for n, row in enumerate(rows)]  # no points: blank lines
    return "\n".join(["# Image list with two lines of data per image:", *shots])


def open3d_log() -> str:
    """Open3D's log: a line of numbers and four rows."""
    whole = rows4(*posed(Y_DOWN, RIGHT, -UP, AHEAD))
    return "\n".join(f"{n} {n} {n + 1}\n{lines(m)}" for n, m in enumerate(whole))


def open3d_json() -> str:
    """Open3D's trajectory: world to camera, column by column."""
    whole = rows4(*inverse(*posed(Y_DOWN, RIGHT, -UP, AHEAD)))
    columns = np.swapaxes(whole, 1, 2).reshape(COUNT, 16).tolist()
    return json.dumps({"parameters": [{"extrinsic": m} for m in columns]})


def matrices() -> str:
    """4 x 4 matrices, one a line."""
    return lines(rows4(*posed(Y_DOWN, RIGHT, -UP, AHEAD)).reshape(COUNT, 16))


def airsim() -> str:
    """AirSim: the vehicle, north-east-down, milliseconds since 1970."""
    position, rotation = posed(Z_DOWN, AHEAD, RIGHT, -UP)
    w_first = Rotation.from_matrix(rotation).as_quat()[:, [3, 0, 1, 2]]
    stamps = (1597175835440 + 1000 * TIME_S).round().astype(int).tolist()
    rows = lines(np.hstack((position, w_first)), "\t").split("\n")
    head = "TimeStamp\tPOS_X\tPOS_Y\tPOS_Z\tQ_W\tQ_X\tQ_Y\tQ_Z\tRPM"
    return "\n".join([head, *(f"{t}\t{row}\t0" for t, row in zip(stamps, rows, strict=True))])


def unreal() -> str:
    """Unreal's profiler: centimetres, left-handed, time by frame times."""
    table = np.hstack((100.0 * PLACE @ UNREAL, AHEAD @ UNREAL, UP @ UNREAL))
    head = "EVENTS,FrameTime," + ",".join(
        f"View/{part}{axis}" for part in ("Pos", "Forward", "Up") for axis in "XYZ"
    )
    rows = [f",{1000.0 / RATE_HZ},{row}" for row in lines(table, ",").split("\n")]
    return "\n".join([head, *rows, "[Platform],WindowsNoEditor"])


def unity() -> str:
    """Unity: left-handed, y up, quaternions."""
    # Unity's camera looks along its z with y up; its numbers are of a left-handed world.
    position, rotation = posed(UNITY, RIGHT, UP, AHEAD)
    quaternions = Rotation.from_matrix(rotation).as_quat()
    table = np.hstack((TIME_S[:, np.newaxis], position, quaternions))
    return "Time,PosX,PosY,PosZ,RotX,RotY,RotZ,RotW\n" + lines(table, ",")


def unity_euler() -> str:
    """Unity: Euler angles in degrees."""
    # It turns about y only: 0 looks along z, which is the scene's y, and grows to the right.
    turn = np.degrees(np.arctan2(AHEAD[:, 0], AHEAD[:, 1]))
    position = PLACE @ UNITY.T
    table = np.column_stack((TIME_S, position, 0.0 * turn, turn, 0.0 * turn))
    return "time_s;head_x;head_y;head_z;euler_x;euler_y;euler_z\n" + lines(table, ";")


def yaw() -> str:
    """Yaw and pitch of a table, milliseconds."""
    table = np.column_stack((1000.0 * TIME_S, PLACE, np.degrees(ANGLE) + 180.0, 0.0 * ANGLE))
    return "timestamp_ms\tx\ty\tz\tyaw\tpitch\n" + lines(table, "\t")


def tum_with_header() -> str:
    """TUM with a header and commas."""
    _, rotation = posed(Z_UP, RIGHT, -UP, AHEAD)
    table = np.column_stack((TIME_S, PLACE, Rotation.from_matrix(rotation).as_quat()))
    return "timestamp,tx,ty,tz,qx,qy,qz,qw\n" + lines(table, ",")


def chan() -> str:
    """Nuke: degrees, y up, numbers of frames."""
    position, rotation = posed(Y_UP, RIGHT, UP, -AHEAD)
    turns = Rotation.from_matrix(rotation).as_euler("YXZ", degrees=True)[:, [1, 0, 2]]
    table = np.column_stack((position, turns, np.full(COUNT, 40.0)))
    return "\n".join(f"{n + 1} {row}" for n, row in enumerate(lines(table).split("\n")))


def cesium() -> str:
    """Cesium: headings clockwise from north."""
    heading = np.arctan2(AHEAD[:, 0], AHEAD[:, 1])  # clockwise from north
    return json.dumps(
        [
            {
                "time": time,
                "destination": dict(zip("xyz", place, strict=True)),
                "orientation": {"heading": turn, "pitch": 0.0, "roll": 0.0},
            }
            for time, place, turn in zip(
                TIME_S.tolist(), PLACE.tolist(), heading.tolist(), strict=True
            )
        ]
    )


def gltf() -> str:
    """glTF: samplers of a camera node, in an embedded buffer."""
    position, rotation = posed(Y_UP, RIGHT, UP, -AHEAD)
    parts = [TIME_S[:, np.newaxis], position, Rotation.from_matrix(rotation).as_quat()]
    data = b"".join(part.astype("<f4").tobytes() for part in parts)
    starts = np.cumsum([0, *(4 * part.size for part in parts)]).tolist()
    kinds = ("SCALAR", "VEC3", "VEC4")
    return json.dumps(
        {
            "asset": {"version": "2.0"},
            "cameras": [{"type": "perspective", "perspective": {"yfov": math.radians(50.0)}}],
            "nodes": [{"name": "still"}, {"camera": 0}],
            "buffers": [
                {
                    "byteLength": len(data),
                    "uri": "data:application/octet-stream;base64,"
                    + base64.b64encode(data).decode(),
                }
            ],
            "bufferViews": [
                {"buffer": 0, "byteOffset": start, "byteLength": 4 * part.size}
                for start, part in zip(starts, parts, strict=False)
            ],
            "accessors": [
                {"bufferView": n, "componentType": 5126, "count": COUNT, "type": kind}
                for n, kind in enumerate(kinds)
            ],
            "animations": [
                {
                    "samplers": [{"input": 0, "output": 1}, {"input": 0, "output": 2}],
                    "channels": [
                        {"sampler": 0, "target": {"node": 1, "path": "translation"}},
                        {"sampler": 1, "target": {"node": 1, "path": "rotation"}},
                    ],
                }
            ],
        }
    )


TIMELESS = Reading(rate_hz=RATE_HZ)
LEFT = Reading(frame="unity")
CASES: list[tuple[str, str, Callable[[], str], Reading]] = [
    ("transforms.json", "nerf", nerf, TIMELESS),
    ("camera_path.json", "nerfstudio", nerfstudio, Reading()),
    ("cameras.json", "gaussian-splats", splats, TIMELESS),
    ("images.txt", "colmap", colmap, TIMELESS),
    ("trajectory.log", "open3d-log", open3d_log, TIMELESS),
    ("trajectory.json", "open3d-json", open3d_json, TIMELESS),
    ("traj.txt", "matrices", matrices, TIMELESS),
    ("airsim_rec.txt", "airsim", airsim, Reading()),
    ("profile.csv", "unreal-view", unreal, Reading()),
    ("unity.csv", "columns", unity, LEFT),
    ("euler.csv", "columns", unity_euler, Reading()),
    ("yaw.tsv", "columns", yaw, Reading()),
    ("tum.csv", "columns", tum_with_header, Reading()),
    ("shot.chan", "chan", chan, TIMELESS),
    ("cesium.json", "cesium", cesium, Reading()),
    ("camera.gltf", "gltf-camera", gltf, Reading()),
]


def require_circle(trace: CameraTrace, tolerance: float = 2e-6) -> None:
    """Hold positions, times, views and the level to the circle."""
    assert len(trace) == COUNT
    assert trace.time_s == pytest.approx(TIME_S, abs=1e-5)
    assert trace.position_m == pytest.approx(PLACE, abs=tolerance)
    assert view_direction(trace.orientation_xyzw) == pytest.approx(AHEAD, abs=tolerance)
    up = Rotation.from_quat(trace.orientation_xyzw).as_matrix()[:, :, 1]
    assert up == pytest.approx(UP, abs=tolerance)


@pytest.mark.parametrize(("name", "known", "made", "reading"), CASES, ids=[c[0] for c in CASES])
def test_a_circle_is_read_alike_from_every_format(
    name: str, known: str, made: Callable[[], str], reading: Reading, tmp_path: Path
) -> None:
    """The format is recognised by content, and axes, handedness, units and order come right."""
    path = tmp_path / name
    path.write_text(made())
    assert format_of(path) == known
    require_circle(read_trace(str(path), reading=reading))


def test_images_bin_has_the_poses_of_images_txt(tmp_path: Path) -> None:
    """The binary form is read as the text is, with points of other lengths between the images."""
    text, binary = tmp_path / "images.txt", tmp_path / "images.bin"
    text.write_text(colmap())
    records = [struct.pack("<Q", COUNT)]
    rows = [line.split() for line in colmap().split("\n") if line.endswith(".jpg")]
    for n, row in enumerate(rows):
        pose = [float(value) for value in row[1:8]]
        name = row[9].encode() + b"\0"
        points = struct.pack("<Q", n % 3) + bytes(24 * (n % 3))
        records.append(struct.pack("<i7di", n, *pose, 1) + name + points)
    binary.write_bytes(b"".join(records))
    assert format_of(binary) == "colmap-binary"
    read = read_trace(str(binary), reading=TIMELESS)
    require_circle(read)
    assert np.array_equal(read.position_m, read_trace(str(text), reading=TIMELESS).position_m)


def test_fields_of_view_are_those_of_the_files(tmp_path: Path) -> None:
    """90 degrees across at 2 : 1 are 2 atan(1/2) up and down; nerfstudio and glTF state theirs."""
    expected = {nerf: math.degrees(2.0 * math.atan(0.5)), nerfstudio: 50.0, gltf: 50.0, chan: 40.0}
    for made, degrees in expected.items():
        path = tmp_path / made.__name__
        path.write_text(made())
        reading = Reading() if made is gltf else TIMELESS  # glTF has times
        assert read_trace(str(path), reading=reading).fovy_deg == pytest.approx(degrees)


def test_earth_centred_views_become_local_metres(tmp_path: Path) -> None:
    """At 48 degrees north, 100 m to the east and 10 m up are read as 100 m and 10 m."""
    lat, lon = math.radians(48.0), math.radians(11.0)
    up = np.array((math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)))
    east = np.array((-math.sin(lon), math.cos(lon), 0.0))
    start = 6.371e6 * up
    views = [
        {
            "time": time,
            "destination": dict(zip("xyz", (start + step).tolist(), strict=True)),
            "orientation": {"heading": 0.5 * math.pi, "pitch": 0.0, "roll": 0.0},
        }
        for time, step in ((0.0, 0.0 * up), (1.0, 100.0 * east), (2.0, 100.0 * east + 10.0 * up))
    ]
    path = tmp_path / "flight.json"
    path.write_text(json.dumps({"frames": views}))
    trace = read_trace(str(path))
    expected_m = np.array([[0, 0, 0], [100, 0, 0], [100, 0, 10]])
    assert trace.position_m == pytest.approx(expected_m, abs=1e-6)
    assert view_direction(trace.orientation_xyzw)[0] == pytest.approx((1.0, 0.0, 0.0))
    assert "earth-centred positions" in trace.assumed
