"""Meshes, scenes, tilesets and placements, of a few objects."""

import base64
import json
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from seed import Seed, kind_of, one_file, test_module, wild_files

from lodbench.cli.main import run

_INFO = ("scene", "info", "@")
_LEVELS = ("--levels", "2", "--min-triangles", "8")
_BUILD = ("scene", "build", "@", "--out", "out.lodscene", "--count", "3", *_LEVELS)
_PLACE = ("scene", "build", "box.obj", "--placements", "@", "--out", "out.lodscene")
_COMPRESSED = ("BoxDraco.gltf", "BoxMeshopt.glb", "draco-and-plain.gltf")


def _ball() -> Any:
    return trimesh.creation.icosphere(subdivisions=1)


def mesh_seeds(_: Path) -> Iterator[Seed]:
    """Yield a ball in each format."""
    for suffix, kind, options in (
        ("obj", "text", {}),
        ("off", "text", {}),
        ("ply", "bytes", {}),
        ("ply", "text", {"encoding": "ascii"}),
        ("stl", "bytes", {}),
        ("stl_ascii", "text", {}),
        ("glb", "glb", {}),
    ):
        data: Any = _ball().export(file_type=suffix, **options)
        name = f"ball{'-ascii' if kind == 'text' else ''}.{suffix.removesuffix('_ascii')}"
        yield one_file("meshes", name, data, kind, *_BUILD)


def scene_seeds(scratch: Path) -> Iterator[Seed]:
    """Yield scene files of each kind of level, and glTF with levels, sparse, packed or torn."""
    mesh = scratch / "ball.obj"
    mesh.write_text(_ball().export(file_type="obj"))
    for name, words in (
        ("chain", ("build", *_LEVELS, "--count", "4")),
        ("knots", ("build", *_LEVELS, "--count", "4", "--continuous")),
        ("tree", ("build-hlod", "--desired-triangles", "20")),
    ):
        built, (verb, *more) = scratch / f"{name}.lodscene", words
        status = run(["scene", verb, str(mesh), "--out", str(built), "--json", *more])
        if status:
            raise RuntimeError(f"{name}: the scene was not built")
        yield one_file("scenes", built.name, built.read_bytes(), "archive", *_INFO)
    document, binary = levels_document(3)
    document["textures"] = [{}]  # which its material names
    yield one_file("scenes", "levels.glb", _glb(document, binary), "glb", *_INFO)
    document["accessors"][0]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": 1, "componentType": 5125},
        "values": {"bufferView": 0},
    }
    data = base64.b64encode(binary).decode()
    document["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{data}"
    yield one_file("scenes", "sparse.gltf", json.dumps(document), "json", *_INFO)
    document, _ = levels_document(1)
    document["buffers"][0]["uri"] = "absent.bin"
    yield one_file("scenes", "no-buffer.gltf", json.dumps(document), "json", *_INFO)
    for path in wild_files("scenes"):
        if path.name in _COMPRESSED:
            yield one_file("scenes", path.name, path.read_bytes(), kind_of(path), *_INFO)


def levels_document(levels: int) -> tuple[dict[str, Any], bytes]:
    """Return a glTF document of an object of so many levels, and its binary."""
    ball = _ball()
    positions = np.asarray(ball.vertices, "<f4").tobytes()
    corners = np.asarray(ball.faces, "<u4").tobytes()
    shares = [len(ball.faces) // 2**i * 3 for i in range(levels)]
    nodes: list[dict[str, Any]] = [{"mesh": i, "translation": [0, i, 0]} for i in range(levels)]
    if levels > 1:
        nodes[0]["extensions"] = {"MSFT_lod": {"ids": list(range(1, levels))}}
    points: dict[str, Any] = {"bufferView": 0, "componentType": 5126, "count": len(ball.vertices)}
    points |= {"type": "VEC3", "min": [-1, -1, -1], "max": [1, 1, 1]}
    parts = [
        {"attributes": {"POSITION": 0}, "indices": 1 + i, "material": 0} for i in range(levels)
    ]
    document: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": nodes,
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "meshes": [{"primitives": [part]} for part in parts],
        "buffers": [{"byteLength": len(positions) + len(corners)}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(positions)},
            {"buffer": 0, "byteOffset": len(positions), "byteLength": len(corners)},
        ],
        "accessors": [
            points,
            *(
                {"bufferView": 1, "componentType": 5125, "count": share, "type": "SCALAR"}
                for share in shares
            ),
        ],
    }
    return document, positions + corners


def _glb(document: dict[str, Any], binary: bytes) -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def tileset_seeds(_: Path) -> Iterator[Seed]:
    """Yield a tileset with contents of all formats, and implicit ones."""
    tiles = test_module("models/tiles/test_tile_content.py")
    sets = test_module("models/tiles/test_tileset.py")
    region = {"region": [0.1, 0.5, 0.11, 0.51, 0.0, 100.0]}
    move = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 100, 0, 0, 1]
    leaves = [
        sets.tile(2.0, content={"uri": "a.b3dm"}),
        sets.tile(1.0, content={"uri": "b.i3dm"}, transform=move),
        sets.tile(None, contents=[{"uri": "c.cmpt"}, {"uri": "absent.glb"}]),
        {"boundingVolume": region, "geometricError": 1.0, "content": {"uri": "d.json"}},
    ]
    root = sets.tile(16.0, refine="ADD", content={"uri": "m.glb"}, children=leaves)
    batched = tiles.tile(b"b3dm", {"BATCH_LENGTH": 0}, tiles.glb())
    instanced = tiles.instanced(tiles.glb(), 1)
    files = {
        "tileset.json": _tileset(root),
        "m.glb": tiles.glb(),
        "a.b3dm": batched,
        "b.i3dm": instanced,
        "c.cmpt": tiles.composite(batched, instanced),
        "d.json": _tileset(sets.tile(1.0)),
    }
    known = {"json": "json", "glb": "glb"}
    kinds = {name: known.get(name.rpartition(".")[2], "tile") for name in files}
    yield Seed("tilesets", "explicit", files, kinds, _INFO)
    for scheme, flags in (("QUADTREE", "1" * 21), ("OCTREE", 1)):
        files = {
            "tileset.json": _tileset(sets.implicit(3, 3, scheme)),
            "s-0-0-0.subtree": sets.subtree(flags, 0, 0),
        }
        kinds = {"tileset.json": "json", "s-0-0-0.subtree": "tile"}
        yield Seed("tilesets", f"implicit {scheme.lower()}", files, kinds, _INFO)


def _tileset(root: dict[str, Any]) -> bytes:
    document = {"asset": {"version": "1.1"}, "geometricError": 500, "root": root}
    return json.dumps(document).encode()


def placement_seeds(_: Path) -> Iterator[Seed]:
    """Yield places of boxes."""
    box: Any = trimesh.creation.box()
    mesh = box.export(file_type="obj").encode()
    rows = [f"box,{i},{i % 3},0,0,0,0,1,{1 + 0.1 * i},1" for i in range(12)]
    table = "\n".join(["type,x,y,z,qx,qy,qz,qw,scale,importance", *rows])
    records = [
        {"type": "box", "position": [i, 0, 0], "rotation": [0, 0, 0, 1], "scale": 1.0}
        for i in range(12)
    ]
    listed = json.dumps({"instances": records})
    for name, text, kind in (("p.csv", table, "text"), ("p.json", listed, "json")):
        files = {name: text.encode(), "box.obj": mesh}
        yield Seed("placements", name, files, {name: kind}, _PLACE)
