"""`cameras.json` of 3D Gaussian splatting: position and rotation to the world, OpenCV, no times.

Kerbl et al., "3D Gaussian splatting for real-time radiance field rendering", ACM Transactions on
Graphics 2023.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .....base.errors import InputError
from .....base.files.strict_json import read_json
from ...reading.frames import OPENCV
from ...reading.poses import Poses
from ...reading.rotations import nearest_rotations
from ...trace_format import TraceFormat, refuse_selector

_ADVICE = "give the file as it was exported"


@dataclass
class _Camera:
    position: list[float]
    rotation: list[list[float]]
    fy: float | None = None
    height: float | None = None


def read_splats(path: Path, selector: str | None = None) -> Poses:
    """Return the poses; raises `InputError` for a camera without position or rotation."""
    refuse_selector(selector, path, "cameras.json")
    cameras = read_json(path, list[_Camera], "cameras of Gaussian splatting", _ADVICE)
    for at, one in enumerate(cameras):
        if len(one.position) != 3 or [len(row) for row in one.rotation] != [3, 3, 3]:
            message = f"[{at}]: expected 3 numbers and 3 rows of 3, got others"
            raise InputError(f"{message}; {_ADVICE}", path=path)
    lines = range(1, len(cameras) + 1)
    matrices = np.array([one.rotation for one in cameras], dtype=np.float64).reshape(-1, 3, 3)
    rotation, repairs = nearest_rotations(matrices, path, lines)
    first = cameras[0] if cameras else None
    fovy_deg = None
    if first is not None and first.fy and first.height:
        fovy_deg = math.degrees(2.0 * math.atan(0.5 * first.height / first.fy))
    return Poses(
        name=path.stem,
        lines=lines,
        time=None,
        position=np.array([one.position for one in cameras], dtype=np.float64).reshape(-1, 3),
        rotation=rotation,
        frame=OPENCV,
        unit=None,
        fovy_deg=fovy_deg,
        repairs=repairs,
    )


def _recognises(head: list[str]) -> bool:
    text = " ".join(head)
    return text.startswith("[") and '"rotation"' in text and '"position"' in text


FORMAT = TraceFormat("cameras.json of Gaussian splatting, without times", _recognises, read_splats)
