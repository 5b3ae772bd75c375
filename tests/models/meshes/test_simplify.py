"""Chains of levels: counts, measured errors, ends, and meshes that are hard to simplify."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.simplify import ChainOptions, build_chain, simplify_surface
from lodbench.models.meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface
from lodbench.models.meshes.type_model import TypeModel, gather_types

SMALL = Sampling(vertices=500, surface=500)


def surface(mesh: trimesh.Trimesh, name: str = "thing") -> SurfaceMesh:
    """Return a mesh of trimesh as one untextured part."""
    part = MeshPart(np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces))
    return clean_surface(name, [part])


def column(model: TypeModel, name: str) -> list[float]:
    """Return the counts of a predictor, level by level."""
    return model.counts[:, LEVEL_PREDICTORS.index(name)].tolist()


def test_sphere_halves_and_errs_more() -> None:
    """Each level has half the triangles; the error grows and stays below the radius."""
    full = surface(trimesh.creation.icosphere(subdivisions=4))
    model = build_chain(full, ChainOptions(levels=6), SMALL)
    assert column(model, "triangles") == [5120, 2560, 1280, 640, 320, 160]
    assert model.error_m[0] == 0.0
    assert (np.diff(model.error_m) >= 0).all()
    assert 0.001 < model.error_m[1] < model.error_m[-1] < 0.15
    # The bounding sphere holds every level, and coarse ones may stand out by their error.
    assert model.radius_m >= 1.0 - 1e-6
    assert model.radius_m <= 1.0 + model.error_m[-1]


def test_error_is_measured_not_taken_from_the_ratio() -> None:
    """A finely divided box loses nothing at any count, a crumpled one of the same counts does."""
    box = trimesh.creation.box()
    for _ in range(4):
        box = box.subdivide()
    crumpled = box.copy()
    crumpled.vertices += np.random.default_rng(1).normal(0.0, 0.02, box.vertices.shape)
    smooth, rough = (
        build_chain(surface(m), ChainOptions(levels=4), SMALL) for m in (box, crumpled)
    )
    assert column(smooth, "triangles") == pytest.approx(column(rough, "triangles"), rel=0.02)
    assert smooth.error_m.max() < 1e-9
    assert rough.error_m[1] > 0.02


@pytest.mark.parametrize("count", range(1, 13))
def test_tiny_meshes_have_one_level(count: int) -> None:
    """Meshes of 1 to 12 triangles are kept as they are."""
    box = trimesh.creation.box()
    full = clean_surface(
        "tiny", [MeshPart(np.asarray(box.vertices), np.asarray(box.faces)[:count])]
    )
    model = build_chain(full, ChainOptions(), SMALL)
    assert column(model, "triangles") == [count]
    assert model.error_m.tolist() == [0.0]


@settings(max_examples=30, deadline=None)
@given(
    triangles=st.lists(st.tuples(*[st.integers(0, 14)] * 3), min_size=1, max_size=120),
    seed=st.integers(0, 99),
)
def test_any_tangle_of_triangles_gives_a_chain(
    triangles: list[tuple[int, int, int]], seed: int
) -> None:
    """Non-manifold tangles with any number of faces on an edge give a valid, ordered chain."""
    points = np.random.default_rng(seed).normal(size=(15, 3))
    try:
        full = clean_surface("tangle", [MeshPart(points, np.array(triangles))])
    except InputError:
        assert all(len(set(face)) < 3 for face in triangles)
        return
    options = ChainOptions(levels=5, min_triangles=4)
    model = build_chain(full, options, Sampling(vertices=50, surface=50))
    sizes = column(model, "triangles")
    assert sizes == sorted(set(sizes), reverse=True)
    types, _ = gather_types([model])  # the level table checks the order
    assert types.levels.level_count.tolist() == [len(sizes)]
    assert np.isfinite(model.error_m).all()


def test_a_chain_stops_where_simplification_stalls() -> None:
    """Separate triangles share no edge to collapse: no level repeats the full mesh."""
    points = np.random.default_rng(0).normal(size=(100, 3, 3))
    soup = MeshPart(points.reshape(-1, 3), np.arange(300).reshape(-1, 3))
    model = build_chain(clean_surface("soup", [soup]), ChainOptions(), SMALL)
    sizes = column(model, "triangles")
    assert len(sizes) == len(set(sizes))
    assert all(b <= 0.95 * a for a, b in pairwise(sizes))


def test_scale_does_not_matter() -> None:
    """A mesh in millimetres gives the same levels as in kilometres, its error scaled."""
    mesh = trimesh.creation.torus(1.0, 0.3, major_sections=40, minor_sections=20)
    models: list[TypeModel] = []
    for scale in (1e-3, 1e3):
        sized: Any = mesh.copy()
        sized.apply_scale(scale)
        models.append(build_chain(surface(sized), ChainOptions(levels=4), SMALL))
    assert column(models[0], "triangles") == column(models[1], "triangles")
    assert models[1].error_m / 1e6 == pytest.approx(models[0].error_m, rel=1e-3)


def test_buffers_are_as_drawn() -> None:
    """Every vertex is used; bytes are 32 a vertex and 4 an index; normals point outward."""
    model = build_chain(
        surface(trimesh.creation.icosphere(subdivisions=3)), ChainOptions(levels=3), SMALL
    )
    for mesh, vertices, triangles in zip(
        model.meshes, column(model, "vertices"), column(model, "triangles"), strict=True
    ):
        assert np.unique(mesh.faces).tolist() == list(range(int(vertices)))
        assert mesh.byte_count == 32 * vertices + 12 * triangles
        outward = np.einsum("ij,ij->i", mesh.normals, mesh.vertices)
        assert outward.min() > 0.9


def test_parts_are_draws() -> None:
    """A type of three materials is drawn by three calls; the textured part's triangles count."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    points, faces = np.asarray(ball.vertices), np.asarray(ball.faces)
    uv = np.stack((np.arctan2(points[:, 1], points[:, 0]), points[:, 2]), axis=1)
    parts = [
        MeshPart(points + np.array((3.0 * i, 0, 0)), faces, material=i, textured=i == 1, uv=uv)
        for i in range(3)
    ]
    full = clean_surface("three", parts, texture_bytes=64.0)
    model = build_chain(full, ChainOptions(levels=4), SMALL)
    assert column(model, "draw_calls") == [3, 3, 3, 3]
    assert column(model, "texture_bytes") == [64] * 4
    share = np.array(column(model, "textured_triangles")) / column(model, "triangles")
    assert share == pytest.approx([1 / 3] * 4, abs=0.03)


def test_a_target_above_the_mesh_changes_nothing() -> None:
    """A mesh with fewer triangles than asked for is returned as it is."""
    full = surface(trimesh.creation.box())
    points, faces = simplify_surface(full.positions, full.faces, 100)
    assert points is full.positions
    assert faces is full.faces


@pytest.mark.parametrize(
    ("levels", "ratio", "least"),
    [(0, 0.5, 32), (33, 0.5, 32), (8, 0.0, 32), (8, 1.0, 32), (8, np.nan, 32), (8, 0.5, 0)],
)
def test_options_out_of_range_are_refused(levels: int, ratio: float, least: int) -> None:
    """Options that make no chain are input errors."""
    with pytest.raises(InputError, match="expected"):
        ChainOptions(levels=levels, ratio=ratio, min_triangles=least)


def test_names_that_repeat_are_numbered() -> None:
    """Two files of one name are two types."""
    box = build_chain(surface(trimesh.creation.box(), "box"), ChainOptions(), SMALL)
    assert gather_types([box, box, box])[0].names == ("box", "box-2", "box-3")
