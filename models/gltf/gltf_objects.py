"""The objects of a glTF document: nodes with a mesh, or with levels, and where they stand."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ..scene.rotation import rotation_matrix
from .gltf_schema import Document, Node, pick

_MAX_LEVELS = 32
_MAX_OBJECTS = 100_000
Key: TypeAlias = tuple[tuple[tuple[tuple[int, bytes], ...], ...], bytes]
"""What objects of one type have in common."""


@dataclass(frozen=True, slots=True)
class Placed:
    """A mesh with its transform (4, 4) relative to some node."""

    mesh: int
    transform: FloatArray


@dataclass(frozen=True, slots=True)
class Thing:
    """Meshes of each level, finest first, in the frame of the object, and where it stands."""

    name: str
    levels: tuple[tuple[Placed, ...], ...]
    transform: FloatArray

    @property
    def key(self) -> Key:
        """What objects of one type have in common."""
        meshes = tuple(
            tuple((placed.mesh, placed.transform.round(9).tobytes()) for placed in level)
            for level in self.levels
        )
        return meshes, self.transform[:3, :3].round(9).tobytes()


def find_objects(document: Document) -> Iterator[Thing]:
    """Yield the objects of the default scene."""
    count = 0
    for number, transform in _walk(document, document.roots(), np.eye(4), stop_at_levels=True):
        node = document.nodes[number]
        lod = node.extensions.MSFT_lod
        if lod is None and node.mesh is None:
            continue
        ids = node.coarser
        count += 1
        if len(ids) >= _MAX_LEVELS or count > _MAX_OBJECTS:
            raise InputError(
                f"expected at most {_MAX_OBJECTS} objects of {_MAX_LEVELS} levels, got more"
            )
        name = node.name or _mesh_name(document, node) or f"node-{number}"
        if lod is None:
            assert node.mesh is not None
            yield Thing(name, ((Placed(node.mesh, np.eye(4)),),), transform)
            continue
        # A level stands where the finest one does: both give their own place in the parent.
        inverse = _inverse(_local(node), number)
        levels = [_meshes_below(document, number, inverse)]
        levels += [_meshes_below(document, i, inverse) for i in ids]
        # An empty last level means that the object is not drawn from far away.
        yield Thing(name, tuple(level for level in levels if level), transform)


def _mesh_name(document: Document, node: Node) -> str:
    return "" if node.mesh is None else pick(document.meshes, node.mesh, "meshes").name


def _meshes_below(document: Document, number: int, inverse: FloatArray) -> tuple[Placed, ...]:
    walk = _walk(document, [number], inverse, stop_at_levels=False)
    meshes = ((document.nodes[below].mesh, transform) for below, transform in walk)
    return tuple(Placed(mesh, transform) for mesh, transform in meshes if mesh is not None)


def _walk(
    document: Document, roots: list[int], above: FloatArray, *, stop_at_levels: bool
) -> Iterator[tuple[int, FloatArray]]:
    """Yield nodes and their transforms, parents first; not below nodes with levels if told so."""
    parents = dict.fromkeys(roots, above)
    for number in document.walk(roots):
        if number not in parents:  # below a node with levels
            continue
        node = document.nodes[number]
        transform = parents[number] @ _local(node)
        if not np.isfinite(transform).all():
            raise InputError(f"node {number}: expected a finite transform, got another")
        yield number, transform
        if not stop_at_levels or node.extensions.MSFT_lod is None:
            parents |= dict.fromkeys(node.children, transform)


def _local(node: Node) -> FloatArray:
    """Return the (4, 4) transform of a node in its parent."""
    if node.matrix is not None:
        if len(node.matrix) != 16:
            raise InputError(f"matrix: expected 16 numbers, got {len(node.matrix)}")
        return np.array(node.matrix).reshape(4, 4).T
    unit = np.array(node.rotation) / max(float(np.linalg.norm(node.rotation)), 1e-300)
    result = np.eye(4)
    result[:3, :3] = rotation_matrix(unit) * node.scale
    result[:3, 3] = node.translation
    return result


def _inverse(matrix: FloatArray, number: int) -> FloatArray:
    try:
        inverse: FloatArray = np.linalg.inv(matrix).astype(np.float64)
    except np.linalg.LinAlgError as error:
        raise InputError(
            f"node {number}: expected a transform with an inverse, got none"
        ) from error
    return inverse
