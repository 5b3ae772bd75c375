"""Mesh files: formats, parts, textures, and files that are refused."""

import base64
import json
import re
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from lodbench import InputError
from lodbench.models.meshes.mesh_file import load_mesh

QUAD = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"


def write(path: Path, content: str | bytes) -> Path:
    """Write a file and return its path."""
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def refused(path: Path) -> str:
    """Return the message of the refusal, which names the file."""
    with pytest.raises(InputError) as info:
        load_mesh(path)
    assert info.value.path == str(path)
    return info.value.message


def test_numbers_that_overflow_are_refused_without_a_warning(tmp_path: Path) -> None:
    """Of 1e400 numpy would warn beside the refusal, in lines of its own."""
    message = refused(write(tmp_path / "far.obj", QUAD.replace("v 1 1 0", "v 1e400 1 0")))
    assert "expected finite vertices" in message


@pytest.mark.parametrize("suffix", ["obj", "ply", "stl", "off", "glb"])
def test_formats_hold_the_same_box(suffix: str, tmp_path: Path) -> None:
    """A box comes back with 8 positions and 12 triangles from every format."""
    path = tmp_path / f"box.{suffix}"
    trimesh.creation.box((1, 2, 3)).export(path)
    mesh = load_mesh(path)
    assert mesh.name == "box"
    assert (len(mesh.positions), len(mesh.faces)) == (8, 12)
    assert np.ptp(mesh.positions, axis=0) == pytest.approx([1, 2, 3])


def test_quads_become_triangles(tmp_path: Path) -> None:
    """A quadrilateral is two triangles of its area."""
    mesh = load_mesh(write(tmp_path / "quad.obj", QUAD))
    a, b, c = (mesh.positions[mesh.faces[:, i]] for i in range(3))
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).tolist() == [1.0, 1.0]


def textured_scene() -> trimesh.Scene:
    """Return two textured balls of one material and a mirrored plain box beside them."""
    ball = trimesh.creation.icosphere(subdivisions=1)
    material = PBRMaterial(name="skin", baseColorTexture=Image.new("RGB", (8, 4)))
    ball.visual = TextureVisuals(uv=ball.vertices[:, :2], material=material)
    scene = trimesh.Scene()
    scene.add_geometry(ball, geom_name="ball", node_name="one")
    scene.graph.update(
        "two", matrix=trimesh.transformations.translation_matrix((5, 0, 0)), geometry="ball"
    )
    mirror = np.diag((-2.0, 1.0, 1.0, 1.0))
    mirror[0, 3] = 10.0
    scene.add_geometry(trimesh.creation.box(), node_name="three", transform=mirror)
    return scene


def test_nodes_of_a_scene_are_placed_and_grouped_by_material(tmp_path: Path) -> None:
    """Three nodes of two materials are two parts; mirrored faces keep looking outward."""
    path = tmp_path / "group.glb"
    textured_scene().export(path)
    mesh = load_mesh(path)
    assert sorted(np.bincount(mesh.part).tolist()) == [12, 160]
    ball_part = int(np.argmax(np.bincount(mesh.part)))
    assert mesh.textured.tolist() == [i == ball_part for i in range(2)]
    assert mesh.has_uv
    assert np.ptp(mesh.positions[:, 0]) == pytest.approx(12.0)
    whole = trimesh.Trimesh(mesh.positions, mesh.faces, process=False)
    assert whole.is_winding_consistent
    ball = trimesh.creation.icosphere(subdivisions=1)
    assert whole.volume == pytest.approx(2 * ball.volume + 2.0)


def test_texture_bytes_are_those_of_distinct_images(tmp_path: Path) -> None:
    """One image of 8 by 4 texels, used twice: four bytes a texel and a third for its mips."""
    path = tmp_path / "group.glb"
    textured_scene().export(path)
    assert load_mesh(path).texture_bytes == pytest.approx(8 * 4 * 4 * 4 / 3)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("empty.obj", b"", "got 0 bytes"),
        ("comment.obj", "# nothing\n", "expected"),
        ("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "expected"),
        ("bad_index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "expected"),
        ("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "finite vertices"),
        ("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "triangle with an area"),
        ("noise.obj", bytes(range(128, 256)) * 20, "expected"),
        ("noise.glb", b"glTF" + bytes(range(256)), "expected binary glTF 2"),
        ("noise.ply", b"ply\nformat ascii 1.0\nelement vertex 99999999999\n", "damaged"),
        ("noise.stl", b"\xff" * 500, "expected"),
        ("text.stl", "solid\n", "expected"),
        ("noise.off", b"\x00\x01OFF", "damaged"),
        ("words.xyz.txt", "1 2 3\n", "mesh format"),
        ("nothing", "v 0 0 0\n", "mesh format"),
    ],
)
def test_files_that_hold_no_mesh_are_refused(
    name: str, content: str | bytes, message: str, tmp_path: Path
) -> None:
    """Empty, damaged and foreign files are refused with the reason."""
    assert message in refused(write(tmp_path / name, content))


def test_point_clouds_are_refused_as_such(tmp_path: Path) -> None:
    """A file of points says so, instead of a crash about faces."""
    path = tmp_path / "points.ply"
    trimesh.PointCloud(np.eye(3)).export(path)
    assert "expected a mesh with triangles, got PointCloud" in refused(path)


def test_missing_files_and_folders_are_refused(tmp_path: Path) -> None:
    """A path to nothing and a folder are no mesh files."""
    assert "no such file" in refused(tmp_path / "gone.obj")
    assert "no such file" in refused(tmp_path)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
@pytest.mark.parametrize("suffix", ["glb", "stl", "ply"])
def test_truncated_files_are_refused(suffix: str, share: float, tmp_path: Path) -> None:
    """A download that stopped is never a smaller mesh."""
    path = tmp_path / f"box.{suffix}"
    trimesh.creation.box().export(path)
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * share)])
    assert re.match("expected", refused(path))


def glb(accessor: dict[str, Any]) -> bytes:
    """Return a GLB of one triangle, whose index accessor is changed."""
    positions = np.eye(3, dtype="<f4").tobytes()
    indices = np.array([0, 1, 2], dtype="<u4").tobytes()
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": 48}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 12},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": 3, "type": "SCALAR"} | accessor,
        ],
    }
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text
    body += struct.pack("<II", 48, 0x004E4942) + positions + indices
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def test_a_hand_made_glb_is_read(tmp_path: Path) -> None:
    """The triangle that the next test breaks is good as it is."""
    assert len(load_mesh(write(tmp_path / "one.glb", glb({}))).faces) == 1


@pytest.mark.parametrize(
    "accessor", [{"count": 10**9}, {"count": -3}, {"bufferView": 7}, {"componentType": 1}]
)
def test_absurd_accessors_are_refused(accessor: dict[str, Any], tmp_path: Path) -> None:
    """Counts and references beyond the file are damage."""
    assert "expected" in refused(write(tmp_path / "odd.glb", glb(accessor)))


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_flipped_bytes_never_crash(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Whatever a few bytes become, a file is a mesh of finite triangles or an input error."""
    path = tmp_path_factory.mktemp("flip") / "one.glb"
    content = bytearray(glb({}))
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content)
    try:
        mesh = load_mesh(path)
    except InputError:
        return
    assert np.isfinite(mesh.positions).all()
    assert mesh.faces.max() < len(mesh.positions)


def _need_a_library(*_: object, **__: object) -> None:
    raise ModuleNotFoundError("No module named 'no_such_library'")


def _call_wrongly(*_: object, **__: object) -> None:
    len(3)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("loader", "says"),
    [
        (_need_a_library, "no_such_library.*install lodbench anew"),
        (_call_wrongly, "TypeError: object of type 'int' has no len"),
    ],
)
def test_what_the_installation_lacks_is_told_apart_from_damage(
    loader: Callable[..., None], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Any exception is one line with the path, which says what it was."""
    monkeypatch.setattr(trimesh, "load_scene", loader)
    assert re.search(says, refused(write(tmp_path / "quad.obj", QUAD)))


def test_archives_are_no_meshes(tmp_path: Path) -> None:
    """What a few kB inflate to is not known before: an archive is to be unpacked."""
    path = tmp_path / "box.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("box.obj", QUAD + "\n" * 10_000_000)
    assert path.stat().st_size < 100_000
    assert refused(path).endswith("got '.zip'; unpack it")


@pytest.mark.parametrize("count", [2_000_000, 2**31, 2**63 - 1])
def test_elements_without_bytes_are_bounded_before_they_are_made(
    count: int, tmp_path: Path
) -> None:
    """An accessor without a view is zeros, of which 700 bytes can claim 2^31."""
    many = glb({"bufferView": None, "count": count})
    assert f"expected 1 to 1,000,000 elements, got {count}" in refused(
        write(tmp_path / "many.glb", many)
    )


def test_bytes_that_accessors_share_count_each_time(tmp_path: Path) -> None:
    """On one view of 120 kB two thousand accessors are 60 million numbers, four too many."""
    few, many = shared_views(2_000), shared_views(4_000)
    assert len(load_mesh(write(tmp_path / "few.gltf", few)).faces) == 1
    message = refused(write(tmp_path / "many.gltf", many))
    assert "expected at most 100,000,000 numbers in accessors" in message


def shared_views(accessors: int) -> bytes:
    """Return a glTF of one triangle with accessors of 10,000 positions, all on one view."""
    points = np.zeros((10_000, 3), "<f4")
    points[:3] = np.eye(3)
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": accessors}]}],
        "buffers": [
            {
                "byteLength": 120_006,
                "uri": "data:application/octet-stream;base64,"
                + base64.b64encode(points.tobytes() + bytes((0, 0, 1, 0, 2, 0))).decode(),
            }
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 120_000},
            {"buffer": 0, "byteOffset": 120_000, "byteLength": 6},
        ],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 10_000, "type": "VEC3"}]
        * accessors
        + [{"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
    }
    return json.dumps(tree).encode()


def test_a_mesh_beyond_the_memory_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Running out of memory is neither damage nor a traceback."""

    def exhaust(*_: object, **__: object) -> None:
        raise MemoryError

    monkeypatch.setattr(trimesh, "load_scene", exhaust)
    assert "fits into memory" in refused(write(tmp_path / "quad.obj", QUAD))
