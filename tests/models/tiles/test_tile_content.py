"""What contents of every format draw, counted by hand from files made here."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest

from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.tiles.tile_content import count_content

GLTF = {
    "asset": {"version": "2.0"},
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [
        {"componentType": 5126, "count": 4, "type": "VEC3"},
        {"componentType": 5123, "count": 6, "type": "SCALAR"},
    ],
}
"""Two triangles of four vertices."""


def glb() -> bytes:
    """Return them as binary glTF."""
    text = json.dumps(GLTF).encode()
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sIIII", b"glTF", 2, 20 + len(text), len(text), 0x4E4F534A) + text


def tile(kind: bytes, features: dict[str, int], body: bytes, extra: bytes = b"") -> bytes:
    """Return a tile with a feature table of JSON and a body."""
    table = json.dumps(features).encode()
    head = kind + struct.pack("<I", 1)
    size = 28 + len(extra) + len(table) + len(body)
    return head + struct.pack("<5I", size, len(table), 0, 0, 0) + extra + table + body


def instanced(body: bytes, embedded: int) -> bytes:
    """Return seven instances of a model."""
    return tile(b"i3dm", {"INSTANCES_LENGTH": 7}, body, struct.pack("<I", embedded))


def composite(*parts: bytes) -> bytes:
    """Return parts in one content."""
    body = b"".join(parts)
    return b"cmpt" + struct.pack("<III", 1, 16 + len(body), len(parts)) + body


def counted(path: Path) -> dict[str, float]:
    """Return the counts that are not zero."""
    counts = count_content(path)
    assert counts is not None
    return {name: n for name, n in zip(LEVEL_PREDICTORS, counts.tolist(), strict=True) if n}


TWO = {"draw_calls": 1.0, "vertices": 4.0, "triangles": 2.0}


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (json.dumps(GLTF).encode(), TWO),
        (glb(), TWO),
        (tile(b"b3dm", {"BATCH_LENGTH": 0}, glb()), TWO),
        (instanced(glb(), 1), {name: 7.0 * n for name, n in TWO.items()}),
        (instanced(b"model.glb  ", 0), {name: 7.0 * n for name, n in TWO.items()}),
        (tile(b"pnts", {"POINTS_LENGTH": 900}, b""), {"draw_calls": 1.0, "splats": 900.0}),
        (
            composite(tile(b"b3dm", {"BATCH_LENGTH": 0}, glb()), instanced(glb(), 1)),
            {name: 8.0 * n for name, n in TWO.items()},
        ),
    ],
    ids=["gltf", "glb", "b3dm", "i3dm", "i3dm-linked", "pnts", "cmpt"],
)
def test_counts_of_a_content(tmp_path: Path, data: bytes, expected: dict[str, float]) -> None:
    """A model is counted once an instance, points are splats, and parts add up."""
    (tmp_path / "model.glb").write_bytes(glb())
    path = tmp_path / "content"
    path.write_bytes(data)
    assert counted(path) == expected


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"vctr",
        b"i3dm",
        instanced(b"../model.glb", 0),
        instanced(b"absent.glb", 0),
        tile(b"pnts", {"POINTS_LENGTH": -1}, b""),
        tile(b"pnts", {}, b""),
        composite(b"b3dm" + struct.pack("<II", 1, 2**31)),
        composite(composite(glb())),
        instanced(glb(), 1)[:40],
    ],
)
def test_what_cannot_be_read_is_none(tmp_path: Path, data: bytes) -> None:
    """Damage, a cycle and a model out of the folder count as a content that cannot be read."""
    path = tmp_path / "content"
    path.write_bytes(data)
    assert count_content(path) is None


def test_the_numbers_are_finite(tmp_path: Path) -> None:
    """Ten million instances are the most that one content may announce."""
    path = tmp_path / "content"
    path.write_bytes(tile(b"i3dm", {"INSTANCES_LENGTH": 10**9}, glb(), struct.pack("<I", 1)))
    assert count_content(path) is None
    path.write_bytes(tile(b"i3dm", {"INSTANCES_LENGTH": 10**7}, glb(), struct.pack("<I", 1)))
    counts = count_content(path)
    assert counts is not None
    assert np.isfinite(counts).all()
