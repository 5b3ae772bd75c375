"""Levels of detail that a glTF file tells by the names of its nodes, as Blender exports to engines.

Siblings ``rock_LOD0``, ``rock_LOD1`` … are one object, of which the engine (Unity's LODGroup,
Godot's visibility ranges) shows one at a time.  Here they become what ``MSFT_lod`` says of such
nodes.
"""

import re
from collections.abc import Sequence

import msgspec

from ...base.errors import InputError
from ..meshes.authored_levels import LEVEL_NAME
from .gltf_schema import Document, Lod, Node, NodeExtensions, pick

# Blender numbers the copies of a name: rock_LOD0.001.
_NAME = re.compile(rf"{LEVEL_NAME.pattern}(?P<copy>[._]\d{{3}})?", re.IGNORECASE)


def join_named_levels(document: Document) -> Document:
    """Return a document whose nodes named as levels are one node with levels.

    Nodes that have ``MSFT_lod``, or are a level by it, stay as they are, and so does a level alone.

    Raises `InputError` if a level is missing among a node's, or comes twice.
    """
    told = {i for node in document.nodes for i in node.coarser}
    told |= {number for number, node in enumerate(document.nodes) if node.coarser}
    nodes = list(document.nodes)

    def without_levels(siblings: Sequence[int]) -> list[int]:
        """Return siblings but for the coarser levels, which their finest takes over."""
        coarser: set[int] = set()
        for group in _groups(document, siblings, told):
            finest, *others = group
            lod = NodeExtensions(MSFT_lod=Lod(others))
            nodes[finest] = msgspec.structs.replace(nodes[finest], extensions=lod)
            coarser.update(others)
        return [number for number in siblings if number not in coarser]

    for number, node in enumerate(document.nodes):
        kept = without_levels(node.children)
        if len(kept) < len(node.children):
            nodes[number] = msgspec.structs.replace(nodes[number], children=kept)
    roots = document.roots()
    kept = without_levels(roots)
    if len(kept) == len(roots) and nodes == document.nodes:
        return document
    scene = msgspec.structs.replace(document.scenes[0], nodes=kept) if document.scenes else None
    scenes = [] if scene is None else [scene]
    return msgspec.structs.replace(document, nodes=nodes, scenes=scenes, scene=0)


def _groups(document: Document, siblings: Sequence[int], told: set[int]) -> list[list[int]]:
    """Return nodes of one name by level, finest first, of each name that has several."""
    found: dict[tuple[str, str], list[tuple[int, int]]] = {}
    for number in siblings:
        node: Node = pick(document.nodes, number, "nodes")
        match = _NAME.fullmatch(node.name)
        if match is not None and number not in told:
            key = match["name"], match["copy"] or ""
            found.setdefault(key, []).append((int(match["level"]), number))
    groups: list[list[int]] = []
    for (name, _), levels in found.items():
        if len(levels) < 2:
            continue
        levels.sort()
        said = [level for level, _ in levels]
        if said != list(range(said[0], said[0] + len(said))) or said[0] > 1:
            raise InputError(
                f"node {name}: expected levels one after the other from LOD0, got {said}; rename "
                "nodes that are no levels"
            )
        groups.append([number for _, number in levels])
    return groups
