"""COLMAP's `images.txt` and `images.bin`: world to camera, quaternion w first, OpenCV, no times.

Schönberger and Frahm, "Structure-from-motion revisited", CVPR 2016; the form is that of COLMAP's
documentation, "Output format".  Images are taken in the order of their names.
"""

import struct
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .....base.errors import InputError
from .....base.files.text_file import read_bytes
from ...reading.frames import Frame
from ...reading.poses import Poses
from ...reading.rotations import rotations_of
from ...text_lines import parse_numbers, read_lines
from ...trace_format import TraceFormat, refuse_selector

if TYPE_CHECKING:
    from .....base.arrays import FloatArray

_NAMES = ("QW", "QX", "QY", "QZ", "TX", "TY", "TZ")
_FIXED = struct.Struct("<i7di")  # id, pose, id of the camera
_POINT_BYTES = 24
_LARGEST_BYTES = 4_000_000_000


def read_colmap_text(path: Path, selector: str | None = None) -> Poses:
    """Return the poses of `images.txt`; raises `InputError` for a line that is none."""
    refuse_selector(selector, path, "images.txt")
    found: list[tuple[str, int, list[float]]] = []
    points = False  # every second line, which may be blank, has the points of an image
    for line, text in enumerate(read_lines(path), start=1):
        if text.startswith("#"):
            continue
        if points or not text.strip():
            points = False
            continue
        fields = text.split(maxsplit=9)
        if len(fields) < 10:
            message = f"expected ID, {' '.join(_NAMES)}, CAMERA_ID and NAME, got {text[:40]!r}"
            raise InputError(f"{message}; complete the line", path=path, line=line)
        numbers = parse_numbers(fields[1:8], _NAMES, path=path, line=line)
        found.append((fields[9], line, numbers))
        points = True
    return _poses(path, found)


def read_colmap_binary(path: Path, selector: str | None = None) -> Poses:
    """Return the poses of `images.bin`; raises `InputError` if it is cut off."""
    refuse_selector(selector, path, "images.bin")
    data = read_bytes(path, _LARGEST_BYTES)
    found: list[tuple[str, int, list[float]]] = []
    try:
        (count,), at = struct.unpack_from("<Q", data), 8
        for index in range(count):
            _, *pose, _ = _FIXED.unpack_from(data, at)
            at += _FIXED.size
            end = data.index(b"\0", at)
            name = data[at:end].decode("utf-8", "replace")
            (points,) = struct.unpack_from("<Q", data, end + 1)
            at = end + 9 + points * _POINT_BYTES
            found.append((name, index + 1, list(pose)))
    except (struct.error, ValueError) as error:
        message = f"expected images.bin of COLMAP, got one that ends in image {len(found) + 1}"
        raise InputError(f"{message}; copy it again", path=path) from error
    return _poses(path, found)


def _poses(path: Path, found: list[tuple[str, int, list[float]]]) -> Poses:
    found = sorted(found)
    lines = [line for _, line, _ in found]
    table: FloatArray = np.array([numbers for *_, numbers in found]).reshape(-1, 7)
    if not np.isfinite(table).all():
        raise InputError("expected finite poses, got others; reconstruct again", path=path)
    return Poses(
        name=path.stem,
        lines=lines,
        time=None,
        position=table[:, 4:7],
        rotation=rotations_of(table[:, [1, 2, 3, 0]], path, lines),
        frame=Frame("opencv", "-y", inverse=True),
        unit=None,
    )


def _recognises_text(head: list[str]) -> bool:
    if any("QW, QX, QY, QZ, TX, TY, TZ" in line for line in head):
        return True
    fields = next((line for line in head if not line.startswith("#")), "").split()
    return len(fields) == 10 and fields[0].isdigit() and fields[8].isdigit() and "." in fields[9]


def _recognises_binary(head: list[str]) -> bool:
    return head == ["binary images.bin"]


FORMAT = TraceFormat("images.txt of COLMAP, without times", _recognises_text, read_colmap_text)
BINARY = TraceFormat("images.bin of COLMAP, without times", _recognises_binary, read_colmap_binary)
