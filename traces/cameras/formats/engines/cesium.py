"""Cesium's camera as JSON: `destination`, and `orientation` by heading, pitch, roll or directions.

A list, or an object with a list `frames`, of records with `time` in seconds where there is one.  A
destination beyond 1,000 km from the origin is earth-centred: it is taken in metres east, north and
up of the first one.  Nearer ones are local metres with z up.  The heading is clockwise from north
(y) and the pitch up from the horizon, both in radians.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .....base.arrays import FloatArray
from .....base.errors import InputError
from .....base.files.strict_json import decode_json
from .....base.files.text_file import read_text
from ...reading.frames import Frame
from ...reading.poses import Poses
from ...reading.rotations import rotations_along
from ...trace_format import TraceFormat, refuse_selector

_FAR_M = 1e6
_ADVICE = "give records with destination and orientation"


@dataclass
class _Point:
    x: float
    y: float
    z: float


@dataclass
class _Orientation:
    heading: float = 0.0
    pitch: float = 0.0
    roll: float = 0.0
    direction: _Point | None = None
    up: _Point | None = None


@dataclass
class _View:
    destination: _Point
    orientation: _Orientation
    time: float | None = None


@dataclass
class _Views:
    frames: list[_View]
    fps: float | None = None


def read_cesium(path: Path, selector: str | None = None) -> Poses:
    """Return the poses; raises `InputError` for a record without a destination."""
    refuse_selector(selector, path, "Cesium")
    data = read_text(path).encode()
    kind: Any = list[_View] if data.lstrip().startswith(b"[") else _Views
    read = decode_json(data, kind, "views of Cesium", _ADVICE, path=path, first_line=1)
    views: list[_View] = read.frames if isinstance(read, _Views) else read
    lines = range(1, len(views) + 1)
    position = np.array([_numbers(view.destination) for view in views]).reshape(-1, 3)
    timed = [view.time for view in views if view.time is not None]
    if timed and len(timed) < len(views):
        raise InputError("expected a time of every view or of none, got some", path=path)
    far = bool(len(position)) and float(np.linalg.norm(position[0])) > _FAR_M
    axes = _local_axes(position[0]) if far else np.eye(3)
    ahead, up = _directions(views, axes)
    local = (position - position[0]) @ axes.T if far else position
    return Poses(
        name=path.stem,
        lines=lines,
        time=np.array(timed) if timed else None,
        time_unit="s",
        position=local,
        rotation=rotations_along(ahead, up, path, list(lines), left_handed=False),
        frame=Frame("opengl", "z"),
        rate_hz=read.fps if isinstance(read, _Views) else None,
        assumed=("earth-centred positions" if far else "positions in local metres, z up",),
    )


def _numbers(point: _Point) -> list[float]:
    return [point.x, point.y, point.z]


def _local_axes(center: FloatArray) -> FloatArray:
    """Return east, north and up, (3, 3) rows, at a point of a sphere about the origin."""
    up = center / np.linalg.norm(center)
    east = np.cross((0.0, 0.0, 1.0), up)
    size = np.linalg.norm(east)
    east = np.array((1.0, 0.0, 0.0)) if size < 1e-9 else east / size  # at a pole any will do
    return np.stack((east, np.cross(up, east), up))


def _directions(views: list[_View], axes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return directions ahead and up, (n, 3), in local axes."""
    ahead, up = np.empty((len(views), 3)), np.empty((len(views), 3))
    for at, view in enumerate(views):
        turn = view.orientation
        if turn.direction is not None and turn.up is not None:
            ahead[at], up[at] = axes @ _numbers(turn.direction), axes @ _numbers(turn.up)
            continue
        sin_h, cos_h = np.sin(turn.heading), np.cos(turn.heading)
        sin_p, cos_p = np.sin(turn.pitch), np.cos(turn.pitch)
        ahead[at] = sin_h * cos_p, cos_h * cos_p, sin_p
        level_up = np.array((-sin_h * sin_p, -cos_h * sin_p, cos_p))
        right = np.array((cos_h, -sin_h, 0.0))
        up[at] = np.cos(turn.roll) * level_up + np.sin(turn.roll) * right
    return ahead, up


def _recognises(head: list[str]) -> bool:
    text = " ".join(head)
    return '"destination"' in text and '"orientation"' in text


FORMAT = TraceFormat("views of Cesium as JSON", _recognises, read_cesium)
