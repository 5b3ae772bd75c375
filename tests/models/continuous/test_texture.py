"""Texture-preserving collapse: classes, companions, seams, and its error in texture space."""

from dataclasses import replace

import numpy as np
import pytest
from texture_meter import TextureMeter

from lodbench.models.continuous.knots import OrderedSurface
from lodbench.models.continuous.ordered_mesh import order_mesh
from lodbench.models.continuous.texture import DrawnVertices, contract_textured, fixed_positions
from lodbench.models.meshes.mesh_error import ErrorMeter, Sampling
from lodbench.models.meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface


def classes_of(mesh: SurfaceMesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return Peng's three classes of positions: fixed, companioned, regular."""
    drawn = DrawnVertices.of(mesh)
    fixed, split = fixed_positions(mesh, drawn), np.bincount(drawn.position)
    return fixed, ~fixed & (split == 2), ~fixed & (split == 1)


def test_classes_of_the_tube(tube: SurfaceMesh) -> None:
    """Both ends are fixed, the seam's 39 positions between them companioned, all else regular."""
    fixed, companioned, regular = classes_of(tube)
    ends = np.isin(tube.positions[:, 2], (0.0, 6.0))
    x, y, z = tube.positions.T
    seam = np.isclose(np.cos(np.arctan2(y, x) - 0.8 * z), 1.0)
    assert (fixed == ends).all()
    assert (companioned == seam & ~ends).all()
    assert companioned.sum() == 39
    assert (regular == ~seam & ~ends).all()
    assert len(DrawnVertices.of(tube).position) == len(tube.positions) + 41


def test_classes_of_a_sheet(sheet: SurfaceMesh) -> None:
    """On a sheet without a seam the 80 positions of the border are fixed."""
    fixed, companioned, regular = classes_of(sheet)
    assert fixed.sum() == 80
    assert regular.sum() == 19 * 19
    assert not companioned.any()


def test_three_charts_fix_a_vertex() -> None:
    """Where three materials meet, a position is drawn three times and never moves."""
    rim = [(np.cos(a), np.sin(a), 0.0) for a in np.arange(6) * np.pi / 3.0]
    points = np.array([(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), *rim])
    faces = [[(0, 2 + i, 2 + (i + 1) % 6), (1, 2 + (i + 1) % 6, 2 + i)] for i in range(6)]
    parts = [
        MeshPart(points, np.array(faces[2 * m] + faces[2 * m + 1]), material=m) for m in range(3)
    ]
    mesh = clean_surface("gem", parts)
    fixed, companioned, regular = classes_of(mesh)
    poles = mesh.positions[:, 2] != 0.0
    assert (fixed == poles).all()
    assert companioned.sum() == 3
    assert regular.sum() == 3


def test_companions_go_together(tube: SurfaceMesh) -> None:
    """Both drawn vertices at a seam go in one step, to the two of another position on its side."""
    drawn, done = contract_textured(tube)
    seam = np.flatnonzero(np.bincount(drawn.position) == 2)
    gone = 0
    for position in seam.tolist():
        a, b = np.flatnonzero(drawn.position == position)
        assert done.vertex_step[a] == done.vertex_step[b]
        if done.vertex_step[a] < done.steps:
            gone += 1
            ends = done.target[[a, b]]
            assert drawn.position[ends[0]] == drawn.position[ends[1]]
            u = tube.uv[drawn.uv_index[[a, b]], 0]
            assert tube.uv[drawn.uv_index[ends], 0].tolist() == u.tolist()  # 0 stays 0, 1 stays 1
    assert gone > 10


def test_no_triangle_spans_the_seam(tube: SurfaceMesh) -> None:
    """No triangle is stretched back over the image: in u, none is half as wide."""
    surface = OrderedSurface.of(tube, keep_texture=True)
    for count in (1_500, 800, 300):
        _, _, uv_index = surface.extract(count)
        assert np.ptp(tube.uv[uv_index][:, :, 0], axis=1).max() < 0.5


@pytest.mark.parametrize("count", [1_200, 600, 300])
def test_texture_error_is_below_plain_collapse(tube: SurfaceMesh, count: int) -> None:
    """At equal triangles the seam costs the plain collapse more than twice the texture error."""
    meter = TextureMeter(tube, points=3_000)
    errors: list[float] = []
    for keep in (True, False):
        surface = OrderedSurface.of(tube, keep_texture=keep)
        faces, part, uv_index = surface.extract(count)
        assert len(faces) >= count - 2
        errors.append(meter.error_uv(tube.positions, faces, part, uv_index))
    assert errors[0] < 0.5 * errors[1]


def test_texture_error_by_hand(sheet: SurfaceMesh) -> None:
    """An image shifted by a tenth of its width errs by a tenth everywhere."""
    uv = sheet.positions[:, :2] / 20.0
    faces = sheet.faces.astype(np.int64)
    full = clean_surface("image", [MeshPart(sheet.positions, faces, textured=True, uv=uv)])
    full = replace(full, uv=np.concatenate((full.uv, full.uv + np.array((0.1, 0.0)))))
    meter = TextureMeter(full, points=500)
    for shift, error in ((0, 0.0), (len(uv), 0.1)):
        measured = meter.error_uv(full.positions, full.faces, full.part, full.uv_index + shift)
        assert measured == pytest.approx(error, abs=1e-9)


@pytest.mark.parametrize("count", [1_000, 600, 400])
def test_animated_costs_serve_all_poses(tube: SurfaceMesh, bending: np.ndarray, count: int) -> None:
    """Costs averaged over a bending animation leave a quarter less error in its poses (fig. 2)."""
    meters = [ErrorMeter(pose, tube.faces, Sampling(1_000, 1_000)) for pose in bending]
    errors: list[float] = []
    for poses in (None, bending):
        drawn, contraction = contract_textured(tube, poses)
        ordered = order_mesh(drawn.corner, contraction)
        faces = drawn.position[ordered.vertex_source[ordered.extract(count)]]
        each = [meter.error_m(pose, faces) for meter, pose in zip(meters, bending, strict=True)]
        errors.append(float(np.mean(each)))
    assert errors[1] < 0.75 * errors[0]
