"""A likeness of the detector that Gobbetti and Bouvier walked through: many parts of all sizes.

The model of the paper, the ATLAS experiment at CERN, is not public; its counts are lost.  This one
has about a thousand parts from 0.1 m to 25 m across, nested in a cylinder 25 m across and 44 m long
that lies along x, 3.9 million triangles in all.  All parts are continuous (ordered meshes).
"""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ..continuous.knots import KnotOptions, OrderedSurface, build_continuous
from ..meshes.geometry import Geometry
from ..meshes.mesh_error import Sampling
from ..meshes.type_model import gather_types
from ..scene.scene import Scene
from .parts.atlas_parts import CHAMBER, COIL, FLANGE, FOOT, LAYER, PIPE, WEDGE, WHEEL, make_parts
from .scene_registry import BundledScene

_SEED = 1999
_AXIS_HEIGHT_M = 13.0
_SAMPLING = Sampling(vertices=3_000, surface=1_000)
_KNOTS = KnotOptions(knots=10, min_triangles=24)


@dataclass(frozen=True, slots=True)
class _Ring:
    """Copies of a part about the beam: at equal angles, in several places along it.

    Attributes
    ----------
    part : index of the part
    along_m : places along the beam
    out_m : distance from it
    count : copies at each place
    scale : of each copy
    """

    part: int
    along_m: tuple[float, ...]
    out_m: float
    count: int
    scale: float


_RINGS = (
    _Ring(COIL, (0.0,), 7.3, 8, 1.0),
    _Ring(COIL, (-15.5, 15.5), 4.2, 8, 0.22),
    _Ring(WEDGE, (-4.4, 0.0, 4.4), 3.3, 64, 1.0),
    _Ring(CHAMBER, tuple(np.linspace(-10.0, 10.0, 8).tolist()), 5.2, 16, 0.7),
    _Ring(CHAMBER, tuple(np.linspace(-11.0, 11.0, 8).tolist()), 8.0, 16, 1.05),
    _Ring(CHAMBER, tuple(np.linspace(-12.0, 12.0, 8).tolist()), 10.8, 16, 1.4),
    _Ring(WHEEL, (-21.5, -14.0, -7.8, 7.8, 14.0, 21.5), 0.0, 1, 1.0),
    _Ring(LAYER, (0.0,), 0.0, 1, 1.0),
    _Ring(LAYER, (0.0,), 0.0, 1, 0.55),
    _Ring(LAYER, (0.0,), 0.0, 1, 0.3),
    _Ring(LAYER, (0.0,), 0.0, 1, 0.12),
    _Ring(FLANGE, tuple(np.linspace(-6.0, 6.0, 9).tolist()), 2.2, 16, 0.12),
    _Ring(FLANGE, tuple(np.linspace(-20.0, 20.0, 11).tolist()), 6.4, 16, 0.35),
    _Ring(PIPE, tuple(np.linspace(-11.0, 11.0, 6).tolist()), 9.4, 24, 1.0),
    _Ring(FOOT, tuple(np.linspace(-12.0, 12.0, 9).tolist()), 11.6, 2, 1.0),
)


def build_atlas() -> tuple[Scene, Geometry]:
    """Return the detector with its axis 13 m above the ground."""
    shape_rng, place_rng = np.random.default_rng(_SEED).spawn(2)
    models = [
        build_continuous(OrderedSurface.of(part), _KNOTS, _SAMPLING)
        for part in make_parts(shape_rng)
    ]
    types, geometry = gather_types(models)
    rows = [_place(ring, place_rng) for ring in _RINGS]
    sizes = [len(position) for position, _ in rows]
    scene = Scene.of(
        "atlas",
        types,
        np.repeat([ring.part for ring in _RINGS], sizes),
        np.concatenate([position for position, _ in rows]),
        turn_xyzw=np.concatenate([turn for _, turn in rows]),
        scale=np.repeat([ring.scale for ring in _RINGS], sizes),
    )
    return scene, geometry


def _place(ring: _Ring, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Return positions and turns about the beam of a ring's copies; feet stand below only."""
    start = rng.uniform(0.0, 2.0 * np.pi) if ring.part in (FLANGE, PIPE) else 0.0
    angle = start + 2.0 * np.pi * np.arange(ring.count) / ring.count
    if ring.part == FOOT:
        angle = np.array((0.8, 1.2)) * np.pi
    place, turn = (a.ravel() for a in np.meshgrid(ring.along_m, angle, indexing="ij"))
    y, z = -ring.out_m * np.sin(turn), _AXIS_HEIGHT_M + ring.out_m * np.cos(turn)
    half, zero = turn / 2.0, np.zeros(len(turn))
    return np.stack((place, y, z), axis=1), np.stack(
        (np.sin(half), zero, zero, np.cos(half)), axis=1
    )


ATLAS = BundledScene(
    "1,092 parts of a detector from 0.1 to 25 m, 3.7 million triangles, continuous", build_atlas
)
