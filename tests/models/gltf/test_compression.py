"""Compressed, sparse and quantised geometry gives the triangles that went in."""

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.gltf import compression
from lodbench.models.gltf.gltf_lod import read_gltf_scene

TRIANGLES = LEVEL_PREDICTORS.index("triangles")
SQUARE = np.array([(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)], dtype="<f4")
CORNERS = np.array([0, 1, 2, 0, 2, 3], dtype="<u2")


def document(data: bytes, views: list[dict[str, Any]], accessors: list[dict[str, Any]]) -> str:
    """Return a glTF of one mesh whose accessor 0 are positions and 1 corners."""
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return json.dumps(
        {
            "asset": {"version": "2.0"},
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "buffers": [{"byteLength": len(data), "uri": uri}],
            "bufferViews": views,
            "accessors": accessors,
        }
    )


def triangles_of(path: Path) -> float:
    """Return the triangles of the only level."""
    scene, _, _ = read_gltf_scene(path)
    return float(scene.types.levels.counts[0, TRIANGLES])


def test_quantised_positions_are_brought_to_their_range(tmp_path: Path) -> None:
    """Normalised shorts of 32767 are 1: the square of such corners is 1 m wide, twice 0.5."""
    points = (SQUARE / 2.0 * 32767).astype("<i2")
    padded = np.zeros((4, 4), dtype="<i2")
    padded[:, :3] = points
    data = padded.tobytes() + CORNERS.tobytes()
    views = [
        {"buffer": 0, "byteOffset": 0, "byteLength": 32, "byteStride": 8},
        {"buffer": 0, "byteOffset": 32, "byteLength": 12},
    ]
    accessors = [
        {
            "bufferView": 0,
            "componentType": 5122,
            "count": 4,
            "type": "VEC3",
            "normalized": True,
        },
        {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
    ]
    path = tmp_path / "a.gltf"
    path.write_text(document(data, views, accessors))
    scene, _, _ = read_gltf_scene(path)
    assert scene.radius_m[0] == pytest.approx(np.sqrt(0.5), rel=1e-4)


def test_a_sparse_accessor_replaces_elements(tmp_path: Path) -> None:
    """Zeros with three corners put in make a square; without them there is no area."""
    index = np.array([1, 2, 3], dtype="<u2")
    data = CORNERS.tobytes() + index.tobytes() + b"\0\0" + SQUARE[1:].tobytes()
    views = [
        {"buffer": 0, "byteOffset": 0, "byteLength": 12},
        {"buffer": 0, "byteOffset": 12, "byteLength": 6},
        {"buffer": 0, "byteOffset": 20, "byteLength": 36},
    ]
    sparse = {
        "count": 3,
        "indices": {"bufferView": 1, "componentType": 5123},
        "values": {"bufferView": 2},
    }
    accessors = [
        {"componentType": 5126, "count": 4, "type": "VEC3", "sparse": sparse},
        {"bufferView": 0, "componentType": 5123, "count": 6, "type": "SCALAR"},
    ]
    path = tmp_path / "a.gltf"
    path.write_text(document(data, views, accessors))
    assert triangles_of(path) == 2.0
    del accessors[0]["sparse"]
    path.write_text(document(data, views, accessors))
    with pytest.raises(InputError, match="a triangle with an area"):
        triangles_of(path)


@pytest.mark.realdata
@pytest.mark.parametrize(
    ("name", "triangles"), [("draco-and-plain.gltf", 14.0), ("BoxMeshopt.glb", 12.0)]
)
def test_compressed_files_have_their_triangles(data_dir: Path, name: str, triangles: float) -> None:
    """Draco beside plain geometry, and meshoptimizer's buffers: nothing is lost."""
    scene, _, _ = read_gltf_scene(data_dir / "wild" / "scenes" / name)
    drawn = scene.types.levels.counts[scene.type_index, TRIANGLES]
    assert float(drawn.sum()) == triangles


@pytest.mark.realdata
@pytest.mark.parametrize(
    ("name", "extension"),
    [
        ("draco-and-plain.gltf", "KHR_draco_mesh_compression"),
        ("BoxMeshopt.glb", "EXT_meshopt_compression"),
    ],
)
def test_without_a_decoder_the_extension_is_named(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch, name: str, extension: str
) -> None:
    """With the package that reads it, and the command that decompresses."""

    def absent(_name: str) -> None:
        return None

    monkeypatch.setattr(compression, "find_spec", absent)
    with pytest.raises(InputError, match=rf"{extension}: .*lodbench\[.*gltf-transform"):
        read_gltf_scene(data_dir / "wild" / "scenes" / name)


@pytest.mark.realdata
@pytest.mark.parametrize(
    ("name", "objects", "triangles"), [("many-cubes.gltf", 501, 6012.0), ("BoxDraco.gltf", 1, 12.0)]
)
def test_without_its_buffer_a_file_has_counts_and_boxes(
    data_dir: Path, name: str, objects: int, triangles: float
) -> None:
    """What the JSON says counts, and the origin tells that there are no meshes."""
    scene, geometry, origin = read_gltf_scene(data_dir / "wild" / "scenes" / name)
    assert len(scene) == objects
    assert float(scene.types.levels.counts[scene.type_index, TRIANGLES].sum()) == triangles
    assert geometry == ()
    assert "boxes in place of meshes" in str(origin.options["buffer_missing"])


def test_damaged_compressed_data_are_refused(tmp_path: Path) -> None:
    """Bytes that are no Draco mesh and no meshoptimizer buffer end in one line."""
    data = bytes(range(64))
    packed = {
        "buffer": 0,
        "byteLength": 64,
        "byteStride": 12,
        "count": 4,
        "mode": "ATTRIBUTES",
    }
    views = [
        {
            "buffer": 0,
            "byteLength": 48,
            "extensions": {"EXT_meshopt_compression": packed},
        },
        {"buffer": 0, "byteOffset": 0, "byteLength": 12},
    ]
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
        {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
    ]
    path = tmp_path / "a.gltf"
    path.write_text(document(data, views, accessors))
    with pytest.raises(InputError, match="EXT_meshopt_compression: expected a buffer"):
        triangles_of(path)
    text = json.loads(document(data, views, accessors))
    draco = {"bufferView": 1, "attributes": {"POSITION": 0}}
    text["meshes"][0]["primitives"][0]["extensions"] = {"KHR_draco_mesh_compression": draco}
    path.write_text(json.dumps(text))
    with pytest.raises(InputError, match="KHR_draco_mesh_compression: expected a mesh"):
        triangles_of(path)
