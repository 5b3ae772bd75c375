"""Nodes of glTF files whose names say that they are levels of one object."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from lodbench import InputError
from lodbench.models.gltf.gltf_lod import read_gltf_scene
from lodbench.models.meshes.authored_levels import group_levels
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.mesh_file import load_mesh
from lodbench.models.meshes.mesh_types import MeshUnits, read_types
from lodbench.models.meshes.simplify import ChainOptions
from lodbench.models.scene.scene import Scene

FEW = Sampling(vertices=300, surface=300)


def write(path: Path, nodes: list[dict[str, Any]], roots: list[int]) -> Path:
    """Write balls of 1,280, 320 and 80 triangles as meshes 0 to 2, with these nodes."""
    data, meshes, accessors, views = b"", list[Any](), list[Any](), list[Any]()
    for subdivisions in (3, 2, 1):
        ball: Any = trimesh.creation.icosphere(subdivisions=subdivisions)
        for array, kind, shape in (
            (np.asarray(ball.vertices, dtype=np.float32), 5126, "VEC3"),
            (np.asarray(ball.faces, dtype=np.uint32).ravel(), 5125, "SCALAR"),
        ):
            accessors.append(
                {
                    "bufferView": len(views),
                    "componentType": kind,
                    "count": len(array),
                    "type": shape,
                }
            )
            views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
            data += array.tobytes()
        number = len(accessors)
        meshes.append(
            {"primitives": [{"attributes": {"POSITION": number - 2}, "indices": number - 1}]}
        )
    (path / "balls.bin").write_bytes(data)
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": roots}],
        "nodes": nodes,
        "meshes": meshes,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(data), "uri": "balls.bin"}],
    }
    (path / "balls.gltf").write_text(json.dumps(document), encoding="utf-8")
    return path / "balls.gltf"


def read(path: Path, nodes: list[dict[str, Any]], roots: list[int]) -> Scene:
    """Write a file as `write` does, and read it as a scene."""
    return read_gltf_scene(write(path, nodes, roots), FEW)[0]


def triangles(scene: Scene) -> list[float]:
    """Return those of each row of the level table."""
    return scene.types.levels.counts[:, 2].tolist()


@pytest.mark.parametrize(
    "names",
    [
        ("rock_LOD0", "rock_LOD1", "rock_LOD2"),
        ("rock-lod0", "rock-lod1", "rock-lod2"),
        ("Rock LOD1", "Rock LOD2", "Rock LOD3"),
        ("rock_LOD0.001", "rock_LOD1.001", "rock_LOD2.001"),
    ],
)
def test_siblings_are_levels_of_one_object(tmp_path: Path, names: tuple[str, ...]) -> None:
    """In whichever order they come, as roots of the scene."""
    nodes = [{"mesh": i, "name": name} for i, name in enumerate(names)]
    scene = read(tmp_path, nodes, [2, 0, 1])
    assert len(scene) == 1
    assert triangles(scene) == [1280.0, 320.0, 80.0]
    assert scene.types.levels.error_m[0] == 0.0
    assert 0.0 < scene.types.levels.error_m[1] < scene.types.levels.error_m[2]


def test_levels_below_a_node_and_copies_of_them(tmp_path: Path) -> None:
    """Two rocks of two levels below parents that stand apart, and a ball that has none."""
    nodes: list[dict[str, Any]] = [
        {"children": [2, 3], "translation": [10, 0, 0]},
        {"children": [4, 5], "translation": [0, 0, 20]},
        {"mesh": 0, "name": "rock_LOD0"},
        {"mesh": 1, "name": "rock_LOD1"},
        {"mesh": 0, "name": "rock_LOD0.001"},
        {"mesh": 1, "name": "rock_LOD1.001"},
        {"mesh": 2, "name": "ball"},
    ]
    scene = read(tmp_path, nodes, [0, 1, 6])
    assert len(scene) == 3
    assert triangles(scene) == [1280.0, 320.0, 80.0]
    assert scene.type_index.tolist() == [0, 0, 1]
    # glTF's y up becomes z up: what stood at z = 20 stands at y = -20.
    assert scene.position_m.tolist() == [[10, 0, 0], [0, -20, 0], [0, 0, 0]]


def test_a_level_alone_and_levels_of_other_parents_are_objects(tmp_path: Path) -> None:
    """Names make levels only of what stands side by side."""
    nodes: list[dict[str, Any]] = [
        {"children": [2]},
        {"children": [3]},
        {"mesh": 0, "name": "rock_LOD0"},
        {"mesh": 1, "name": "rock_LOD1"},
    ]
    scene = read(tmp_path, nodes, [0, 1])
    assert len(scene) == 2
    assert scene.types.levels.level_count.tolist() == [1, 1]


def test_what_the_extension_says_stands_before_names(tmp_path: Path) -> None:
    """A node with MSFT_lod keeps the levels that it names, in its order."""
    nodes: list[dict[str, Any]] = [
        {"mesh": 0, "name": "rock_LOD0", "extensions": {"MSFT_lod": {"ids": [2]}}},
        {"mesh": 1, "name": "rock_LOD1"},
        {"mesh": 2, "name": "rock_LOD2"},
    ]
    scene = read(tmp_path, nodes, [0, 1])
    assert len(scene) == 2
    assert triangles(scene) == [1280.0, 80.0, 320.0]


@pytest.mark.parametrize(
    ("levels", "said"),
    [((0, 2), r"\[0, 2\]"), ((2, 3), r"\[2, 3\]"), ((0, 0), r"\[0, 0\]")],
)
def test_gaps_and_repeats_are_refused(tmp_path: Path, levels: tuple[int, int], said: str) -> None:
    """By the node's name, with what to do."""
    nodes = [{"mesh": i, "name": f"rock_LOD{level}"} for i, level in enumerate(levels)]
    with pytest.raises(InputError, match=rf"node rock: expected levels .* got {said}; rename"):
        read(tmp_path, nodes, [0, 1])


def test_scene_build_takes_the_levels_of_nodes(tmp_path: Path) -> None:
    """Two balls with three and two levels and a bare one: the type has three, never their sum.

    Of level k each ball stands as its own level k, or as its coarsest: 1,280, 320 and 80 triangles
    of one, 320 and 80 of the other, and 80 of the bare one in all levels.
    """
    names = ("a_LOD0", "a_LOD1", "a_LOD2", "b_LOD0", "b_LOD1", "bare")
    nodes: list[dict[str, Any]] = [
        {"mesh": mesh, "name": name, "translation": [x, 0.0, 0.0]}
        for mesh, name, x in zip((0, 1, 2, 1, 2, 2), names, (0, 0, 0, 4, 4, 8), strict=True)
    ]
    path = write(tmp_path, nodes, list(range(6)))
    groups = group_levels([path])
    (model,) = read_types(groups, MeshUnits(unit_m=1.0), ChainOptions(), FEW)
    assert [len(mesh.faces) for mesh in model.meshes] == [1680, 480, 240]
    assert model.error_m[0] == 0.0 < model.error_m[1] < model.error_m[2] < 0.2
    assert len(load_mesh(path).faces) == 1680
