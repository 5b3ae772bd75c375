"""Meshes of levels: what they are checked for."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lodbench import InputError
from lodbench.models.meshes.geometry import LevelMesh

MESH = LevelMesh(
    np.eye(3, dtype=np.float32),
    np.eye(3, dtype=np.float32),
    np.array([[0, 1, 2]], dtype=np.int32),
    np.array([0, 1], dtype=np.int32),
)


def test_bytes_by_hand() -> None:
    """Three vertices of 32 bytes and three indices of 4."""
    assert MESH.byte_count == 108


def test_arrays_are_read_only() -> None:
    """No one changes a mesh that a scene shares."""
    with pytest.raises(ValueError, match="read-only"):
        MESH.vertices[0, 0] = 1.0


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("faces", np.empty((0, 3))),
        ("faces", [[0, 1, 3]]),
        ("faces", [[0, 1, -1]]),
        ("vertices", np.eye(3) * np.nan),
        ("normals", np.eye(3)[:2]),
        ("uv", np.zeros((2, 2))),
        ("part_start", [0]),
        ("part_start", [0, 2]),
        ("part_start", [1, 1]),
        ("part_start", [0, 1, 0, 1]),
    ],
)
def test_arrays_that_do_not_fit_are_refused(name: str, value: Any) -> None:
    """Shapes, ranges and finiteness are checked once, on construction."""
    with pytest.raises(InputError, match="mesh"):
        replace(MESH, **{name: np.asarray(value)})
