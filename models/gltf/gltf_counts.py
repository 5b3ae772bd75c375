"""What drawing a glTF document takes, from its JSON alone."""

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.predictors import LEVEL_PREDICTORS
from ..scene.levels import count_rows
from .gltf_schema import TRIANGLE_FAN, TRIANGLE_STRIP, TRIANGLES, Document, Primitive, pick

_MAX_COUNT = 1 << 31


def count_meshes(document: Document) -> FloatArray:
    """Return what drawing the whole document takes, in the order of `LEVEL_PREDICTORS`.

    Counts come from the JSON alone, so that compressed geometry counts too; sizes of textures are
    not known from it and stay 0.

    Raises `InputError` if nodes form a cycle, or an index or a count is out of range.
    """
    of_mesh: dict[int, FloatArray] = {}
    total = np.zeros(len(LEVEL_PREDICTORS))
    for number in document.walk(document.roots()):
        mesh = document.nodes[number].mesh
        if mesh is not None:
            if mesh not in of_mesh:
                of_mesh[mesh] = count_mesh(document, mesh)
            total += of_mesh[mesh]
    return total


def count_mesh(document: Document, mesh: int) -> FloatArray:
    """Return what drawing one mesh takes, likewise; raises as `count_meshes`."""
    parts = pick(document.meshes, mesh, "meshes").primitives
    return sum((_count(document, part) for part in parts), np.zeros(len(LEVEL_PREDICTORS)))


def _count(document: Document, part: Primitive) -> FloatArray:
    vertices = _counted(document, part.attributes.get("POSITION"))
    corners = vertices if part.indices is None else _counted(document, part.indices)
    strip = max(corners - 2, 0)
    triangles = {TRIANGLES: corners // 3, TRIANGLE_STRIP: strip, TRIANGLE_FAN: strip}.get(
        part.mode, 0
    )
    textured = "TEXCOORD_0" in part.attributes and document.has_texture(part.material)
    return count_rows(
        1,
        draw_calls=1,
        vertices=vertices,
        triangles=triangles,
        skinned_vertices=vertices if "JOINTS_0" in part.attributes else 0,
        textured_triangles=triangles if textured else 0,
    )[0]


def _counted(document: Document, accessor: int | None) -> int:
    if accessor is None:
        return 0
    count = pick(document.accessors, accessor, "accessors").count
    if not 0 <= count <= _MAX_COUNT:
        raise InputError(f"accessor {accessor}: expected a count of 0 to 2^31, got {count}")
    return count
