"""glTF files with MSFT_lod as scenes, and what their meshes count."""

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from lodbench import InputError
from lodbench.models.gltf.gltf_counts import count_meshes
from lodbench.models.gltf.gltf_file import parse_glb, read_gltf
from lodbench.models.gltf.gltf_lod import read_gltf_scene
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.mesh_file import load_mesh
from lodbench.models.scene.scene_catalog import open_scene

FEW = Sampling(vertices=500, surface=500)


def accessor(document: dict[str, Any], array: np.ndarray, binary: bytearray) -> int:
    """Append an array to the buffer; return its accessor."""
    kind = {"float32": 5126, "uint32": 5125, "uint16": 5123}[array.dtype.name]
    shape = "SCALAR" if array.ndim == 1 else f"VEC{array.shape[1]}"
    view = {"buffer": 0, "byteOffset": len(binary), "byteLength": array.nbytes}
    binary += array.tobytes() + b"\0" * (-array.nbytes % 4)
    document["bufferViews"].append(view)
    document["accessors"].append(
        {
            "bufferView": len(document["bufferViews"]) - 1,
            "componentType": kind,
            "count": len(array),
            "type": shape,
        }
    )
    return len(document["accessors"]) - 1


def write_balls(path: Path, nodes: list[dict[str, Any]], **more: Any) -> Path:
    """Write a glb with balls of 1,280, 320 and 80 triangles as meshes 0 to 2."""
    document: dict[str, Any] = {"asset": {"version": "2.0"}, "bufferViews": [], "accessors": []}
    document |= {"meshes": [], "nodes": nodes, "scenes": [{"nodes": [0]}], "scene": 0} | more
    binary = bytearray()
    for subdivisions in (3, 2, 1):
        ball = trimesh.creation.icosphere(subdivisions=subdivisions)
        points = accessor(document, np.asarray(ball.vertices, dtype=np.float32), binary)
        corners = accessor(document, np.asarray(ball.faces, dtype=np.uint32).ravel(), binary)
        primitive = {"attributes": {"POSITION": points}, "indices": corners}
        document["meshes"].append({"primitives": [primitive], "name": f"ball-{subdivisions}"})
    document["buffers"] = [{"byteLength": len(binary)}]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(binary), 0x004E4942) + bytes(binary)
    path.write_bytes(b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks)
    return path


def levels(*ids: int) -> dict[str, Any]:
    """Return the extension with these coarser levels."""
    return {"MSFT_lod": {"ids": list(ids)}}


def test_levels_of_a_node(tmp_path: Path) -> None:
    """Three meshes are the levels of one object; errors are measured on the surfaces.

    The middle of a triangle of edge e lies 1 - sqrt(1 - e²/3) below the unit ball; the chords of
    the coarse balls err between 1 and 8 %.
    """
    nodes: list[dict[str, Any]] = [
        {"mesh": 0, "name": "ball", "extensions": levels(1, 2)},
        {"mesh": 1},
        {"mesh": 2},
    ]
    scene, geometry, origin = read_gltf_scene(write_balls(tmp_path / "a.glb", nodes), FEW)
    table = scene.types.levels
    assert scene.types.names == ("ball",)
    assert table.counts[:, 2].tolist() == [1280.0, 320.0, 80.0]
    assert [len(mesh.faces) for mesh in geometry] == [1280, 320, 80]
    assert table.error_m[0] == 0.0
    assert 0.01 < table.error_m[1] < 0.03 < table.error_m[2] < 0.09
    assert scene.radius_m[0] == pytest.approx(1.0, rel=1e-3)
    assert origin.options == {"objects_with_levels": 1}


def test_nodes_place_objects(tmp_path: Path) -> None:
    """Two objects of one type and a larger one of another; y becomes z, and z becomes -y."""
    nodes: list[dict[str, Any]] = [
        {"children": [1, 2, 3], "translation": [10, 0, 0]},
        {"mesh": 0, "translation": [0, 5, 0], "extensions": levels(4)},
        {"mesh": 0, "translation": [0, 0, 7], "extensions": levels(5)},
        {"mesh": 1, "scale": [3, 3, 3]},
        {"mesh": 1, "translation": [0, 5, 0]},
        {"mesh": 1, "translation": [0, 0, 7]},
    ]
    scene, _, _ = read_gltf_scene(write_balls(tmp_path / "a.glb", nodes), FEW)
    assert scene.center_m == pytest.approx(
        np.array([[10, 0, 5], [10, -7, 0], [10, 0, 0]]), abs=1e-6
    )
    assert scene.type_index.tolist() == [0, 0, 1]
    assert scene.radius_m == pytest.approx([1.0, 1.0, 3.0], rel=1e-3)
    assert scene.level_count.tolist() == [2, 2, 1]


def test_a_level_may_be_a_group(tmp_path: Path) -> None:
    """The finest level is two balls below a node without a mesh, the coarsest is nothing."""
    nodes: list[dict[str, Any]] = [
        {"children": [1, 2], "extensions": levels(3, 4)},
        {"mesh": 0},
        {"mesh": 0, "translation": [5, 0, 0]},
        {"mesh": 2},
        {},
    ]
    scene, _, _ = read_gltf_scene(write_balls(tmp_path / "a.glb", nodes), FEW)
    assert scene.types.levels.counts[:, 2].tolist() == [2560.0, 80.0]


def test_roots_without_a_scene(tmp_path: Path) -> None:
    """Where no scene is given, nodes that nobody holds are roots; levels are not."""
    nodes: list[dict[str, Any]] = [{"mesh": 0, "extensions": levels(1)}, {"mesh": 1}, {"mesh": 2}]
    path = write_balls(tmp_path / "a.glb", nodes, scenes=[])
    assert read_gltf(path).document.roots() == [0, 2]


DAMAGE: list[tuple[list[dict[str, Any]], dict[str, Any], str]] = [
    ([{"children": [1]}, {"children": [0], "mesh": 0}], {}, "reached twice"),
    ([{"mesh": 9}], {}, "meshes: expected 0 to 2, got 9"),
    ([{"mesh": 0, "extensions": levels(7)}], {}, "nodes: expected 0 to 0, got 7"),
    ([{"mesh": 0, "children": [-1]}], {}, "nodes: expected 0 to 0, got -1"),
    ([{"mesh": 2, "extensions": levels(1)}, {"mesh": 0}], {}, "expected finest first"),
    ([{"mesh": 0, "extensions": levels(*[1] * 40)}, {"mesh": 1}], {}, "of 32 levels"),
    ([{"mesh": 0, "scale": [1e200, 1e200, 1e200]}], {}, "expected"),
    ([{"mesh": 0, "matrix": [1, 2]}], {}, "16 numbers"),
    ([{}], {}, "a node with a mesh"),
    ([{"mesh": 0}], {"scene": 5}, "scene: expected 0 to 0, got 5"),
    ([{"mesh": 0}], {"asset": {"version": "1.0"}}, "glTF 2.0, got version '1.0'"),
    ([{"mesh": 0}], {"meshes": {"a": 1}}, "a glTF 2.0 document"),
]


@pytest.mark.parametrize(("nodes", "more", "message"), DAMAGE)
def test_damaged_files_are_refused(
    nodes: list[dict[str, Any]], more: dict[str, Any], message: str, tmp_path: Path
) -> None:
    """One line that names the file."""
    path = tmp_path / "a.glb"
    if isinstance(more.get("meshes"), dict):
        path.write_text(json.dumps({"asset": {"version": "2.0"}, **more}), encoding="utf-8")
    else:
        write_balls(path, nodes, **more)
    with pytest.raises(InputError, match=message) as caught:
        read_gltf_scene(path, FEW)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_truncated_files_are_refused(tmp_path: Path) -> None:
    """A file cut anywhere is refused, or, where only padding is lost, read."""
    whole = write_balls(tmp_path / "a.glb", [{"mesh": 0}]).read_bytes()
    for size in (0, 3, 12, 19, 100, len(whole) // 2, len(whole) - 1):
        (tmp_path / "cut.glb").write_bytes(whole[:size])
        with pytest.raises(InputError):
            read_gltf_scene(tmp_path / "cut.glb", FEW)


def test_buffers_stay_in_the_folder(tmp_path: Path) -> None:
    """A buffer that names a file outside is not read."""
    write_balls(tmp_path / "a.glb", [{"mesh": 0}])
    data = (tmp_path / "a.glb").read_bytes()
    size = struct.unpack("<I", data[12:16])[0]
    document = json.loads(data[20 : 20 + size])
    document["buffers"][0]["uri"] = "../secret.bin"
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "a.gltf").write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(InputError, match="in the folder of the glTF"):
        read_gltf_scene(tmp_path / "in" / "a.gltf", FEW)
    document["buffers"][0]["uri"] = "a.bin"
    (tmp_path / "in" / "a.gltf").write_text(json.dumps(document), encoding="utf-8")
    (tmp_path / "in" / "a.bin").write_bytes(data[20 + size + 8 :])
    assert len(read_gltf_scene(tmp_path / "in" / "a.gltf", FEW)[0]) == 1


@pytest.mark.parametrize("text", ["A\u00e9==", "A!==", "A"])
def test_a_buffer_that_is_no_base64_is_refused(text: str, tmp_path: Path) -> None:
    """Letters beyond ASCII, other signs, a length that cannot be: one line that names the file."""
    node = {"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}]}
    mesh = {"primitives": [{"attributes": {"POSITION": 0}}]}
    view = {"buffer": 0, "byteLength": 36}
    points = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}
    buffer = {"byteLength": 36, "uri": f"data:application/octet-stream;base64,{text}"}
    document = {"meshes": [mesh], "accessors": [points], "bufferViews": [view], "buffers": [buffer]}
    path = tmp_path / "a.gltf"
    path.write_text(json.dumps(node | document, ensure_ascii=False), encoding="utf-8")
    with pytest.raises(InputError, match=r"buffer 0: expected base64, got [^\n]+$") as caught:
        read_gltf_scene(path, FEW)
    assert str(caught.value).startswith(str(path))


@pytest.mark.realdata
def test_a_real_file_counts_as_trimesh_loads_it(data_dir: Path) -> None:
    """The milk truck: three objects, two of them wheels of one type, and as many triangles."""
    path = data_dir / "meshes" / "CesiumMilkTruck.glb"
    opened = open_scene(str(path))
    scene = opened.scene
    assert (len(scene), len(scene.types.names)) == (3, 2)
    counted = count_meshes(parse_glb(path.read_bytes())[0])
    placed = scene.types.levels.counts[scene.type_index].sum(axis=0)
    assert placed[2] == counted[2] == len(load_mesh(path).faces)
    assert placed[4] == counted[4] > 0
    assert len(opened.read_geometry()) == 2


@pytest.mark.parametrize(
    ("mode", "corners", "faces"),
    [
        (4, [0, 1, 2, 2, 1, 3], [[0, 1, 2], [2, 1, 3]]),
        (5, [0, 1, 2, 3], [[0, 1, 2], [2, 1, 3]]),
        (6, [0, 1, 3, 2], [[0, 1, 3], [0, 3, 2]]),
    ],
)
def test_lists_strips_and_fans(
    mode: int, corners: list[int], faces: list[list[int]], tmp_path: Path
) -> None:
    """A unit square of two triangles by each mode, all turned the same way, counted alike."""
    document: dict[str, Any] = {"asset": {"version": "2.0"}, "bufferViews": [], "accessors": []}
    binary = bytearray()
    square = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], dtype=np.float32)
    primitive = {
        "attributes": {"POSITION": accessor(document, square, binary)},
        "indices": accessor(document, np.array(corners, dtype=np.uint16), binary),
        "mode": mode,
    }
    uri = "data:application/octet-stream;base64," + base64.b64encode(bytes(binary)).decode()
    document |= {"meshes": [{"primitives": [primitive]}], "nodes": [{"mesh": 0}]}
    document["buffers"] = [{"byteLength": len(binary), "uri": uri}]
    path = tmp_path / "a.gltf"
    path.write_text(json.dumps(document), encoding="utf-8")
    _, (mesh,), _ = read_gltf_scene(path, FEW)
    assert count_meshes(read_gltf(path).document)[2] == len(mesh.faces) == len(faces)
    # The square looks along z in the file, which is -y here.
    assert mesh.normals == pytest.approx(np.tile((0.0, -1.0, 0.0), (4, 1)))


@pytest.mark.parametrize("mode", [0, 1, 2, 3])
def test_points_and_lines_draw_no_surface(mode: int, tmp_path: Path) -> None:
    """A file of nothing else is refused as one without triangles."""
    path = write_balls(tmp_path / "a.glb", [{"mesh": 0}])
    data = path.read_bytes().replace(b'"indices": 1}', b'"mode":' + str(mode).encode() + b"    }")
    assert f'"mode":{mode}'.encode() in data
    path.write_bytes(data)
    with pytest.raises(InputError, match="at least one triangle"):
        read_gltf_scene(path, FEW)
