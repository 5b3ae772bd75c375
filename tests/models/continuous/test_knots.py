"""Continuous types of meshes: knots, measured errors, materials, and what the table reads."""

import numpy as np
import pytest

from lodbench import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.continuous.knots import KnotOptions, OrderedSurface, build_continuous
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.surface_mesh import SurfaceMesh
from lodbench.models.meshes.type_model import gather_types

SMALL = Sampling(vertices=500, surface=500)


def test_knots_of_a_ball(ball: SurfaceMesh) -> None:
    """Geometrically spaced from 1,280 to 20 triangles; the error rises from 0, measured."""
    surface = OrderedSurface.of(ball)
    model = build_continuous(surface, KnotOptions(knots=7, min_triangles=20), SMALL)
    triangles = model.counts[:, LEVEL_PREDICTORS.index("triangles")]
    assert triangles == pytest.approx(1280 * 0.5 ** np.arange(7), rel=0.05)
    assert model.error_m[0] == 0.0
    assert (np.diff(model.error_m) >= 0.0).all()
    assert 0.0 < model.error_m[1] < model.error_m[-1] < 0.7
    assert model.continuous
    # No vertex is moved: every level's vertices are vertices of the ball.
    full = {tuple(v) for v in model.meshes[0].vertices.tolist()}
    assert {tuple(v) for v in model.meshes[-1].vertices.tolist()} <= full


def test_the_table_reads_between_knots(ball: SurfaceMesh) -> None:
    """At a resolution between two knots counts are interpolated, as of any continuous type."""
    model = build_continuous(OrderedSurface.of(ball), KnotOptions(knots=4), SMALL)
    levels = gather_types([model])[0].levels
    assert levels.continuous.tolist() == [True]
    row, part = levels.position(np.array([0]), np.array([0.7]))
    column = levels.counts[:, LEVEL_PREDICTORS.index("triangles")]
    assert levels.interpolate(column, row, part)[0] == pytest.approx(0.7 * 1280)


@pytest.mark.parametrize("keep_texture", [False, True])
def test_textures_reach_every_level(tube: SurfaceMesh, *, keep_texture: bool) -> None:
    """All triangles stay textured, and vertices at the seam count twice."""
    surface = OrderedSurface.of(tube, keep_texture=keep_texture)
    model = build_continuous(surface, KnotOptions(knots=4, min_triangles=200), SMALL)
    column = [LEVEL_PREDICTORS.index(n) for n in ("triangles", "textured_triangles")]
    assert (model.counts[:, column[0]] == model.counts[:, column[1]]).all()
    vertices = model.counts[:, LEVEL_PREDICTORS.index("vertices")]
    assert vertices[0] == len(tube.positions) + 41
    assert all(mesh.uv is not None for mesh in model.meshes)


def test_full_detail_is_drawn_as_it_came(tube: SurfaceMesh) -> None:
    """At the full count positions, materials and coordinates are those of the mesh, in order."""
    for keep in (False, True):
        surface = OrderedSurface.of(tube, keep_texture=keep)
        faces, part, uv_index = surface.extract(len(tube.faces))
        source = surface.ordered.face_source
        assert (faces == tube.faces[source]).all()
        assert (part == tube.part[source]).all()
        assert (uv_index == tube.uv_index[source]).all()


def test_a_mesh_too_small_for_knots_is_one(ball: SurfaceMesh) -> None:
    """Where the coarsest knot would be finer than the mesh, only the mesh is left."""
    model = build_continuous(OrderedSurface.of(ball), KnotOptions(min_triangles=5_000), SMALL)
    assert model.error_m.tolist() == [0.0]


@pytest.mark.parametrize(("knots", "least"), [(1, 32), (257, 32), (12, 0)])
def test_options_out_of_range_are_refused(knots: int, least: int) -> None:
    """Options that make no type are input errors."""
    with pytest.raises(InputError, match="expected"):
        KnotOptions(knots=knots, min_triangles=least)
