"""`transforms.json` of NeRF and instant-ngp: a 4 x 4 matrix a frame, OpenGL camera, z up, no times.

Mildenhall et al., "NeRF: representing scenes as neural radiance fields for view synthesis", ECCV
2020; Müller et al., "Instant neural graphics primitives with a multiresolution hash encoding", ACM
Transactions on Graphics 2022.
"""

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .....base.errors import InputError
from .....base.files.strict_json import read_json
from ...reading.frames import Frame
from ...reading.poses import Poses
from ...reading.rotations import nearest_rotations
from ...trace_format import TraceFormat, refuse_selector

_ADVICE = "give the file as it was exported"


@dataclass
class _Shot:
    transform_matrix: list[list[float]]


@dataclass
class _Transforms:
    frames: list[_Shot] = field(default_factory=list[_Shot])
    camera_angle_x: float | None = None
    fl_y: float | None = None
    w: float | None = None
    h: float | None = None


def read_nerf(path: Path, selector: str | None = None) -> Poses:
    """Return the poses in the file's order; raises `InputError` for a frame that has none."""
    refuse_selector(selector, path, "transforms.json")
    file = read_json(path, _Transforms, "transforms of NeRF", _ADVICE)
    matrices = np.empty((len(file.frames), 4, 4))
    for at, shot in enumerate(file.frames):
        rows = shot.transform_matrix
        if len(rows) not in (3, 4) or any(len(row) != 4 for row in rows):
            message = f"frames[{at}]: expected a matrix of 3 or 4 rows of 4 numbers, got another"
            raise InputError(f"{message}; {_ADVICE}", path=path)
        matrices[at, : len(rows)] = rows
    lines = range(1, len(matrices) + 1)
    rotation, repairs = nearest_rotations(matrices[:, :3, :3], path, lines)
    return Poses(
        name=path.stem,
        lines=lines,
        time=None,
        position=matrices[:, :3, 3],
        rotation=rotation,
        frame=Frame("opengl", "z"),
        unit=None,
        fovy_deg=_fovy_deg(file),
        repairs=repairs,
    )


def _fovy_deg(file: _Transforms) -> float | None:
    """Return the vertical field of view, where the file has enough to know it."""
    if file.fl_y and file.h:
        return math.degrees(2.0 * math.atan(0.5 * file.h / file.fl_y))
    if file.camera_angle_x and file.w and file.h:
        half = math.tan(0.5 * file.camera_angle_x) * file.h / file.w
        return math.degrees(2.0 * math.atan(half))
    return None


def _recognises(head: list[str]) -> bool:
    text = " ".join(head)
    return '"transform_matrix"' in text


FORMAT = TraceFormat("transforms.json of NeRF, without times", _recognises, read_nerf)
