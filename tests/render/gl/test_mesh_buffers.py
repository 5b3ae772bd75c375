"""Meshes on the device: those that are asked for, each once, and the same when buffers grow."""

from typing import Any

import numpy as np
import pytest

from lodbench.render.gl import mesh_buffers
from lodbench.render.gl.mesh_buffers import Meshes


def test_only_what_is_drawn_is_uploaded(drawing: Any, cube: Any, quad: Any) -> None:
    """Of four levels one is drawn; its vertices are all that the counts know."""
    made = drawing([(0.0, 0.0, -3.0)] * 2, [[cube(), quad()], [cube(), quad()]], kind=[0, 1])
    meshes = Meshes(made.target.context, made.scene, made.geometry)
    assert meshes.parts == {}
    assert meshes.load([3, 3]) is False
    assert meshes.vertices == {3: 4}
    meshes.load([3, 2])
    assert meshes.vertices == {3: 4, 2: 24}
    meshes.load_all()
    assert [meshes.vertices[row] for row in range(4)] == [24, 4, 24, 4]
    assert [sum(part.indices for part in meshes.parts[row]) for row in range(4)] == [36, 6, 36, 6]


def test_ranges_of_the_index_buffer_do_not_overlap(drawing: Any, cube: Any, quad: Any) -> None:
    """In the order in which levels were asked for, one behind the other."""
    made = drawing([(0.0, 0.0, -3.0)], [[cube(parts=(4, 8)), quad()]])
    meshes = Meshes(made.target.context, made.scene, made.geometry)
    meshes.load([1])
    meshes.load([0])
    ranges = [(part.first, part.indices) for row in (1, 0) for part in meshes.parts[row]]
    assert ranges == [(0, 6), (6, 12), (18, 24)]


@pytest.mark.parametrize("skinned", [False, True])
def test_pictures_stay_the_same_when_buffers_grow(
    drawing: Any, cube: Any, quad: Any, monkeypatch: pytest.MonkeyPatch, skinned: bool
) -> None:
    """Room for four vertices at first: each level that comes moves all others."""
    chain = [cube(), cube(side_m=1.0), quad()]
    made = drawing([(0.2, 0.1, -4.0)], [chain], skinned=skinned, textured=1.0)
    levels = [2, 0, 1, 2]
    roomy = made.renderer()
    expected = [roomy.picture(made.picture(level=level)) for level in levels]
    monkeypatch.setattr(mesh_buffers, "_LEAST", 4)
    tight = made.renderer()
    for level, picture in zip(levels, expected, strict=True):
        assert (tight.picture(made.picture(level=level)) == picture).all()
    assert not (expected[0] == expected[1]).all()
    assert np.unique(expected[1].reshape(-1, 3), axis=0).shape[0] > 1
