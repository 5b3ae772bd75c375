"""`camera_path.json` of nerfstudio: 16 numbers row by row, frames a second, OpenGL camera, z up.

Tancik et al., "Nerfstudio: a modular framework for neural radiance field development", SIGGRAPH
2023.
"""

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
    camera_to_world: list[float]
    fov: float | None = None


@dataclass
class _CameraPath:
    camera_path: list[_Shot] = field(default_factory=list[_Shot])
    fps: float | None = None


def read_nerfstudio(path: Path, selector: str | None = None) -> Poses:
    """Return the poses; raises `InputError` for a camera without 16 numbers."""
    refuse_selector(selector, path, "camera_path.json")
    file = read_json(path, _CameraPath, "a camera path of nerfstudio", _ADVICE)
    for at, shot in enumerate(file.camera_path):
        if (found := len(shot.camera_to_world)) != 16:
            message = f"camera_path[{at}]: expected 16 numbers of a matrix, got {found}"
            raise InputError(f"{message}; {_ADVICE}", path=path)
    matrices = np.array([shot.camera_to_world for shot in file.camera_path]).reshape(-1, 4, 4)
    lines = range(1, len(matrices) + 1)
    rotation, repairs = nearest_rotations(matrices[:, :3, :3], path, lines)
    fields = [shot.fov for shot in file.camera_path if shot.fov is not None]
    zooms = bool(fields) and max(fields) > min(fields)
    return Poses(
        name=path.stem,
        lines=lines,
        time=None,
        position=matrices[:, :3, 3],
        rotation=rotation,
        frame=Frame("opengl", "z"),
        unit=None,
        rate_hz=file.fps,
        fovy_deg=float(np.median(fields)) if fields else None,
        repairs=repairs,
        assumed=("the median of a field of view that changes",) if zooms else (),
    )


def _recognises(head: list[str]) -> bool:
    text = " ".join(head)
    return '"camera_path"' in text or '"camera_to_world"' in text


FORMAT = TraceFormat("camera_path.json of nerfstudio", _recognises, read_nerfstudio)
