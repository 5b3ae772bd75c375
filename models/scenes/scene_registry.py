"""The bundled scenes by name."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

from ...base.name_registry import Registry
from ..meshes.geometry import Geometry
from ..scene.scene import Scene

Build: TypeAlias = Callable[[], tuple[Scene, Geometry]]


@dataclass(frozen=True, slots=True)
class BundledScene:
    """A scene that is made by code.

    Attributes
    ----------
    about : what it is, in one line
    build : makes it, the same on every call
    build_sized : makes it of another number of objects, which the name then ends in; or None
    """

    about: str
    build: Build
    build_sized: Callable[[int], tuple[Scene, Geometry]] | None = None


SCENES: Registry[BundledScene] = Registry(
    "scene",
    BundledScene,
    f"{__package__}",
    {
        "atlas": "atlas:ATLAS",
        "calibration-dense": "calibration:CALIBRATION_DENSE",
        "calibration-near": "calibration:CALIBRATION_NEAR",
        "city": "city:CITY",
        "cows": "cows:COWS",
        "crowd-1024": "crowd:CROWD",
        "district": "district:DISTRICT",
        "market": "market:MARKET",
        "ogres": "ogres:OGRES",
        "ogres-trees": "ogres:OGRES_TREES",
        "plaza": "plaza:PLAZA",
        "soda-hall": "soda_hall:SODA_HALL",
        "styria": "styria:STYRIA",
    },
)


def find_builder(name: str) -> Build | None:
    """Return what makes the scene of a name, or None if there is no such name."""
    if name in SCENES:
        return SCENES.find(name).build
    sized = re.fullmatch(r"(.+)-([1-9][0-9]{0,9})", name)
    family = [known for known in SCENES if sized and known.rpartition("-")[0] == sized[1]]
    build = SCENES.find(family[0]).build_sized if family else None
    return partial(build, int(sized[2])) if sized and build else None
