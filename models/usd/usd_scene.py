"""USD files as flat scenes whose objects have the levels that variants give them.

An object is a mesh, or a prim with a variant set whose name has "lod" in it, and all below it: its
variants are its levels, by the numbers in their names, or by their order where those have none.
Objects of equal meshes, turned and scaled alike, share a type.  Instances are followed; point
instancers and references to files that are not there are counted, and not read.  What moves stands
where it begins; textures and skins are left out.
"""

import hashlib
import os
import re
import sys
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.reader_guard import guarded
from ..meshes.geometry import Geometry
from ..meshes.mesh_error import Sampling
from ..meshes.surface_mesh import MeshPart, clean_surface
from ..meshes.type_model import TypeModel, gather_types, measure_levels
from ..scene.scene import Scene
from ..scene.scene_file import SceneOrigin
from .usd_meshes import mesh_parts

_Y_UP = np.array(((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)))
_MAX_LEVELS, _MAX_OBJECTS = 32, 100_000


@dataclass(frozen=True, slots=True)
class _Object:
    """Parts of each level, finest first, turned and scaled as in the scene; and where it stands."""

    name: str
    levels: tuple[tuple[MeshPart, ...], ...]
    position_m: FloatArray

    @property
    def key(self) -> bytes:
        """What objects of one type have in common."""
        digest = hashlib.sha256()
        for level in self.levels:
            for part in level:
                digest.update(part.vertices.round(9).tobytes() + part.faces.tobytes())
                digest.update(f"{part.material},{len(part.faces)};".encode())
            digest.update(b"|")
        return digest.digest()


def read_usd_scene(
    path: Path, sampling: Sampling | None = None
) -> tuple[Scene, Geometry, SceneOrigin]:
    """Read a ``.usd``, ``.usda``, ``.usdc`` or ``.usdz`` with its levels; errors are measured.

    Raises `InputError` if usd-core is missing; if the file is missing, damaged, or holds no
    triangles; or if the levels of a prim are not ever coarser.
    """
    if not path.is_file():
        raise InputError("expected a file, got no such file", path=path)
    if find_spec("pxr") is None:
        raise InputError("expected usd-core, got none; pip install 'lodbench[usd]'", path=path)
    with guarded(path, "a USD file with meshes", "export it again"):
        return _read(_open(path), path, sampling or Sampling())


def _open(path: Path) -> Any:
    from pxr import Tf, Usd

    library: Any = Usd
    try:
        with _unprinted():
            return library.Stage.Open(str(path))
    except Tf.ErrorException as error:
        said: Any = error.args[0]
        reason = " ".join(str(said.commentary).split())[:160]
        raise InputError(f"expected a USD file, got a damaged one ({reason})") from error


@contextmanager
def _unprinted() -> Generator[None]:
    """Keep the library from printing; what it prints are errors that a stage has as well."""
    sys.stderr.flush()
    before, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    try:
        yield
    finally:
        os.dup2(before, 2)
        os.close(before)
        os.close(nowhere)


def _read(stage: Any, path: Path, sampling: Sampling) -> tuple[Scene, Geometry, SceneOrigin]:
    objects = list(_find_objects(stage))
    if not objects:
        raise InputError("expected a mesh with triangles, got none")
    kinds: dict[bytes, int] = {}
    models: list[TypeModel] = []
    type_index: list[int] = []
    for thing in objects:
        if thing.key not in kinds:
            kinds[thing.key] = len(models)
            surfaces = [clean_surface(thing.name, level) for level in thing.levels]
            models.append(measure_levels(surfaces, sampling))
        type_index.append(kinds[thing.key])
    types, geometry = gather_types(models)
    position = np.stack([thing.position_m for thing in objects])
    scene = Scene.of(path.stem, types, np.array(type_index), position)
    about: dict[str, str | float | bool | None] = {
        "objects_with_levels": sum(len(thing.levels) > 1 for thing in objects),
        "point_instancers_not_read": sum(
            prim.GetTypeName() == "PointInstancer" for prim in stage.Traverse()
        ),
    }
    lost = [" ".join(str(error).split()) for error in stage.GetCompositionErrors()]
    if lost:
        about["references_not_read"] = f"{len(lost)}, first: {lost[0][:120]}"
    return scene, geometry, SceneOrigin("usd", (path.name,), about)


def _find_objects(stage: Any) -> Iterator[_Object]:
    """Yield the objects of a stage, in metres and z up."""
    from pxr import Usd, UsdGeom

    usd: Any = Usd
    geom: Any = UsdGeom
    axes = np.eye(3) if geom.GetStageUpAxis(stage) == geom.Tokens.z else _Y_UP
    to_scene = np.eye(4)
    to_scene[:3, :3] = axes * geom.GetStageMetersPerUnit(stage)
    walk: Any = iter(usd.PrimRange(stage.GetPseudoRoot(), usd.TraverseInstanceProxies()))
    found: list[tuple[Any, tuple[str, list[str]] | None]] = []
    for prim in walk:
        variants = _level_variants(prim)
        if variants is not None or prim.IsA(geom.Mesh):
            walk.PruneChildren()
            found.append((prim.GetPath(), variants))
    if len(found) > _MAX_OBJECTS:
        raise InputError(f"expected at most {_MAX_OBJECTS} objects, got {len(found)}")
    materials: dict[str, int] = {}
    # Only now, as another variant makes the stage anew, which no walk survives.
    for path, variants in found:
        prim = stage.GetPrimAtPath(path)
        place = to_scene @ _matrix(prim)
        linear = place.copy()
        linear[:3, 3] = 0.0
        if variants is None:
            levels = [_parts_below(prim, linear, materials)]
        else:
            levels = _variant_levels(stage, prim, variants, linear, materials)
        drawn = tuple(level for level in levels if level)  # an empty one is not drawn
        if drawn:
            yield _Object(prim.GetName(), drawn, place[:3, 3])


def _level_variants(prim: Any) -> tuple[str, list[str]] | None:
    """Return the variant set of levels of a prim and its variants, finest first."""
    if prim.IsInstanceProxy():
        return None  # all instances have the variant of their prototype
    sets = prim.GetVariantSets()
    for name in sets.GetNames():
        variants: list[str] = sets.GetVariantSet(name).GetVariantNames()
        if "lod" in name.lower() and 1 < len(variants) <= _MAX_LEVELS:
            numbers = [int(digits) for v in variants for digits in re.findall(r"\d+", v)[:1]]
            if len(numbers) == len(variants):
                variants = [v for _, v in sorted(zip(numbers, variants, strict=True))]
            return name, variants
    return None


def _variant_levels(
    stage: Any,
    prim: Any,
    levels: tuple[str, list[str]],
    linear: FloatArray,
    materials: dict[str, int],
) -> list[tuple[MeshPart, ...]]:
    """Return the parts of each variant; the choice is made in memory alone."""
    from pxr import Usd

    usd: Any = Usd
    name, variants = levels
    path, found = prim.GetPath(), list[tuple[MeshPart, ...]]()
    with usd.EditContext(stage, stage.GetSessionLayer()):
        for variant in variants:
            current = stage.GetPrimAtPath(path)
            current.GetVariantSets().GetVariantSet(name).SetVariantSelection(variant)
            found.append(_parts_below(stage.GetPrimAtPath(path), linear, materials))
    return found


def _parts_below(top: Any, linear: FloatArray, materials: dict[str, int]) -> tuple[MeshPart, ...]:
    """Return the triangles at and below a prim, in its frame, of what is drawn in the end."""
    from pxr import Usd, UsdGeom

    usd: Any = Usd
    geom: Any = UsdGeom
    parts: list[MeshPart] = []
    inverse = np.linalg.inv(_matrix(top))
    for prim in usd.PrimRange(top, usd.TraverseInstanceProxies()):
        if not prim.IsA(geom.Mesh):
            continue
        seen: Any = geom.Imageable(prim)
        if seen.ComputeVisibility(usd.TimeCode.EarliestTime()) == geom.Tokens.invisible:
            continue
        if seen.ComputePurpose() in {geom.Tokens.proxy, geom.Tokens.guide}:
            continue
        parts += mesh_parts(prim, linear @ inverse @ _matrix(prim), materials)
    return tuple(parts)


def _matrix(prim: Any) -> FloatArray:
    """Return the (4, 4) transform of a prim to the stage, of column vectors."""
    from pxr import Usd, UsdGeom

    usd: Any = Usd
    geom: Any = UsdGeom
    placed: Any = geom.Imageable(prim).ComputeLocalToWorldTransform(usd.TimeCode.EarliestTime())
    matrix = np.array(placed, dtype=np.float64).T
    if not (np.isfinite(matrix).all() and abs(np.linalg.det(matrix)) > 0.0):
        raise InputError(f"{prim.GetPath()}: expected a transform with an inverse, got none")
    return matrix
