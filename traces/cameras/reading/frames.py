"""Axes of cameras and worlds, and the way from them to the scene frame.

A world is turned so that its up axis becomes z.  A left-handed one is mirrored besides, in y of the
turned world: Unreal's x ahead, y right, z up becomes x ahead, y left, z up, and Unity's x right, y
up, z ahead becomes x right, y ahead, z up.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ....base.arrays import FloatArray
from ....base.errors import InputError
from ....base.nearest_names import unknown_name

_UP = {
    "z": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "y": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "x": ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
    "-z": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "-y": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "-x": ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
}
"""Rotations of the world that turn an axis up to z."""

# Right, up and back of the picture, as columns, in the axes of the camera.
_CAMERAS = {
    "opengl": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "opencv": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "unity": ((1, 0, 0), (0, 1, 0), (0, 0, -1)),
    "unreal": ((0, 0, -1), (1, 0, 0), (0, 1, 0)),
    "ned": ((0, 0, -1), (1, 0, 0), (0, -1, 0)),
    "ros": ((0, 0, -1), (-1, 0, 0), (0, 1, 0)),
}


@dataclass(frozen=True, slots=True)
class Frame:
    """How poses are written.

    Attributes
    ----------
    camera : str
        Axes of the camera: ``opengl`` (x right, y up, looks along -z), ``opencv`` (x right, y down,
        along z), ``unity`` (x right, y up, along z), ``unreal`` (x ahead, y right, z up), ``ned``
        (x ahead, y right, z down) or ``ros`` (x ahead, y left, z up).
    up : str
        Axis of the world that points up.
    left_handed : bool
        Whether the world is.
    inverse : bool
        Whether poses take the world to the camera, in place of the camera to the world.
    """

    camera: str
    up: str
    left_handed: bool = False
    inverse: bool = False

    def __str__(self) -> str:
        hand = "left" if self.left_handed else "right"
        way = "w2c" if self.inverse else "c2w"
        return f"{self.camera} camera, {self.up} up, {hand}-handed, {way}"

    @property
    def world(self) -> FloatArray:
        """(3, 3) matrix that takes points of the world to the scene."""
        turn = np.array(_UP[self.up], dtype=np.float64)
        return np.diag((1.0, -1.0, 1.0)) @ turn if self.left_handed else turn

    def to_scene(self, position: FloatArray, rotation: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return positions (n, 3) and rotations (n, 3, 3) of cameras in the scene frame.

        Raises `InputError` if rotations of such a camera in such a world would be mirrored.
        """
        if self.inverse:
            rotation = np.swapaxes(rotation, 1, 2)
            position = -np.einsum("nij,nj->ni", rotation, position)
        camera = np.array(_CAMERAS[self.camera], dtype=np.float64)
        turned = self.world @ rotation @ camera
        if np.linalg.det(turned[0]) < 0.0:
            raise InputError(
                f"frame: expected axes of one handedness, got {self}, which would mirror pictures; "
                "add left-handed or right-handed, or name the axes of the camera"
            )
        return position @ self.world.T, turned


OPENGL = Frame("opengl", "y")
OPENCV = Frame("opencv", "-y")
UNREAL = Frame("unreal", "z", left_handed=True)
UNITY = Frame("unity", "y", left_handed=True)
NED = Frame("ned", "-z")
ROS = Frame("ros", "z")

FRAMES = {
    "opengl": OPENGL,
    "opencv": OPENCV,
    "unreal": UNREAL,
    "unity": UNITY,
    "ned": NED,
    "ros": ROS,
}
"""Conventions by name, with the world that usually goes with the camera."""

_WORDS: dict[str, dict[str, Any]] = {
    **{f"{axis}-up": {"up": axis} for axis in _UP},
    "left-handed": {"left_handed": True},
    "right-handed": {"left_handed": False},
    "c2w": {"inverse": False},
    "w2c": {"inverse": True},
}


def parse_frame(text: str, own: Frame) -> Frame:
    """Return a frame from words such as ``opencv,z-up,w2c``; what they do not say is the file's.

    The order of the words does not matter.

    Raises `InputError` if a word is unknown, or two of them contradict each other.
    """
    said: dict[str, str] = {}  # the word that says each part
    frame, changes = own, dict[str, Any]()
    for word in filter(None, (word.strip().lower() for word in text.split(","))):
        if word not in FRAMES and word not in _WORDS:
            raise InputError(f"frame: {unknown_name(word, [*FRAMES, *_WORDS])}")
        part = next(iter(_WORDS.get(word, ("camera",))))
        if said.setdefault(part, word) != word:
            raise InputError(f"frame: expected one of {said[part]} and {word}, got both; leave one")
        if word in FRAMES:
            frame = replace(FRAMES[word], inverse=own.inverse)
        else:
            changes |= _WORDS[word]
    return replace(frame, **changes)
