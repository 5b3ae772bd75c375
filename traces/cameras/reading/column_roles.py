"""Which column of a table is what, by the words in its name."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ....base.errors import InputError
from ....base.nearest_names import unknown_name

POSITION = ("x", "y", "z")
QUATERNION = ("qx", "qy", "qz", "qw")
YAW = ("yaw", "pitch", "roll")
EULER = ("rx", "ry", "rz")
_DIRECTIONS = tuple(f"{way}_{axis}" for way in ("forward", "up") for axis in "xyz")
ROLES = ("time", "frame", *POSITION, *QUATERNION, *YAW, *EULER, *_DIRECTIONS)

_TIME = {"time", "timestamp", "timestamps", "t", "stamp", "seconds", "clock", "sec", "unixtime"}
_FRAME = {"frame", "frames", "index", "id", "viewframe", "frameid", "framenumber"}
_UNITS = {
    "ns": "ns", "nanoseconds": "ns", "nanos": "ns", "nsec": "ns",
    "us": "us", "microseconds": "us", "usec": "us", "micros": "us",
    "ms": "ms", "milliseconds": "ms", "millis": "ms", "msec": "ms",
    "s": "s", "sec": "s", "seconds": "s",
}  # fmt: skip
_LENGTHS = {"m": "m", "meters": "m", "metres": "m", "cm": "cm", "mm": "mm", "ft": "ft", "km": "km"}
_PLACES = {
    "", "p", "pos", "position", "t", "trans", "translation", "loc", "location", "camera", "cam",
    "head", "hmd", "hmdp", "view", "world", "player", "center", "eye",
}  # fmt: skip
_QUATERNIONS = {"q", "quat", "quaternion", "rot", "rotation", "orientation", "o", "r", "hmdq"}
_ANGLES = {"rot", "rotation", "r", "euler", "angle", "angles", "orientation", "hmdr", "eulerangles"}
_AHEAD = {"forward", "fwd", "dir", "direction", "look", "ahead", "gaze", "front"}
_TURNS = {"yaw": "yaw", "heading": "yaw", "azimuth": "yaw", "pitch": "pitch", "roll": "roll"}
_WORD = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+")
_GLUED = re.compile(
    r"(hmd[pqr]|pos|position|loc|location|rot|rotation|quat|forward|fwd|up|[tpqro])([xyzw])"
)


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table.

    Attributes
    ----------
    index : int
    unit : str or None
        That its name states.
    """

    index: int
    unit: str | None = None


def find_roles(
    header: Sequence[str], given: Mapping[str, str], path: Path, line: int
) -> dict[str, Column]:
    """Return the columns of a pose by role: position, an orientation, and time where there is one.

    Raises `InputError` if a role that is needed has no column, or two.

    Parameters
    ----------
    given
        Columns that a user names, by role.
    """
    found: dict[str, list[Column]] = {}
    for index, name in enumerate(header):
        role, unit = _role(name)
        if role is not None:
            found.setdefault(role, []).append(Column(index, unit))
    for role, name in given.items():
        if role not in ROLES:
            raise InputError(f"map: {unknown_name(role, list(ROLES))}")
        if name not in header:
            raise InputError(f"map: {unknown_name(name, list(header))}", path=path, line=line)
        found[role] = [Column(header.index(name), _role(name)[1])]
    for axis in "xyz":  # rotation x, y, z is a quaternion where there is a w, else angles
        turns = found.pop(f"turn_{axis}", [])
        if turns:
            found.setdefault(f"q{axis}" if "qw" in found else f"r{axis}", []).extend(turns)
    if not set(QUATERNION) <= set(found):
        found = {role: some for role, some in found.items() if role not in QUATERNION}
    chosen = next(
        (
            some
            for some in (QUATERNION, _DIRECTIONS[:3], ("yaw",), EULER)
            if set(some) <= set(found)
        ),
        None,
    )
    missing = [axis for axis in POSITION if axis not in found]
    if missing or chosen is None:
        what = f"a column of the position's {missing[0]}" if missing else "columns of a turn"
        raise InputError(
            f"expected {what}, got {', '.join(header)[:80]}; name columns as in --map "
            "x=COLUMN,y=COLUMN (turns are qx qy qz qw, yaw pitch roll, rx ry rz or forward_x …)",
            path=path,
            line=line,
        )
    extra = {"yaw": ("pitch", "roll"), "forward_x": _DIRECTIONS[3:]}.get(chosen[0], ())
    clock = next((role for role in ("time", "frame") if role in found), None)
    wanted = [*POSITION, *chosen, *(r for r in extra if r in found), *([clock] if clock else ())]
    for role in wanted:
        if len(found[role]) > 1 and role != clock:
            names = ", ".join(header[column.index] for column in found[role])
            message = f"expected one column for {role}, got {names}; name one as in --map {role}="
            raise InputError(message[:250], path=path, line=line)
    return {role: found[role][0] for role in wanted}


def _role(name: str) -> tuple[str | None, str | None]:
    """Return what a column is by its name, and the unit that the name states."""
    words = [word.lower() for word in _WORD.findall(name)]
    words = [part for word in words for part in _split(word)]
    if not words:
        return None, None
    if any(word in _TURNS for word in words):
        return next(_TURNS[word] for word in words if word in _TURNS), None
    if set(words) & _TIME and words[-1] not in "xyzw":
        unit = next((_UNITS[word] for word in reversed(words) if word in _UNITS), None)
        return "time", unit
    if set(words) & _FRAME and words[-1] not in "xyzw" and len(words) <= 2:
        return "frame", None
    length = next((_LENGTHS[word] for word in words[1:] if word in _LENGTHS), None)
    words = [word for word in words if word not in _LENGTHS or word == words[0]]
    axis, about = words[-1], set(words[:-1])
    if axis not in ("x", "y", "z", "w"):
        return None, None
    return _of_axis(axis, about), length


def _of_axis(axis: str, about: set[str]) -> str | None:
    if axis == "w":
        return "qw" if not about or about & _QUATERNIONS else None
    if about & {"quat", "quaternion", "q", "hmdq"}:
        return f"q{axis}"
    if about & _AHEAD:
        return f"forward_{axis}"
    if "up" in about:
        return f"up_{axis}"
    if about & {"euler", "angle", "angles", "hmdr", "eulerangles"}:
        return f"r{axis}"
    if about & (_QUATERNIONS | _ANGLES):
        return f"turn_{axis}"  # a quaternion if there is a w, else angles
    return axis if not about or about & _PLACES else None


def _split(word: str) -> list[str]:
    """Return the words of such as ``posx``."""
    match = _GLUED.fullmatch(word)
    return [word] if match is None else list(match.groups())
