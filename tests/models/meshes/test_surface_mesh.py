"""Cleaning of meshes: what is merged, dropped, kept and refused."""

import numpy as np
import pytest

from lodbench import InputError
from lodbench.models.meshes.surface_mesh import MeshPart, clean_surface

SQUARE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], dtype=float)
TWO = np.array([(0, 1, 2), (0, 2, 3)])


def test_equal_positions_are_merged() -> None:
    """A square of two triangles with their own corners has four positions."""
    mesh = clean_surface(
        "square", [MeshPart(SQUARE[TWO].reshape(-1, 3), np.arange(6).reshape(2, 3))]
    )
    assert len(mesh.positions) == 4
    assert mesh.dropped == 0
    assert not mesh.has_uv


def test_useless_faces_and_vertices_are_dropped() -> None:
    """Repeated corners, zero areas, repeats of a face and unused vertices go; NaN unused too."""
    vertices = np.concatenate((SQUARE, [(0.5, 0.0, 0.0), (np.nan, 0, 0)]))
    faces = np.array([*TWO.tolist(), (0, 1, 1), (0, 4, 1), (1, 2, 0)])
    mesh = clean_surface("square", [MeshPart(vertices, faces)])
    assert mesh.dropped == 3
    assert len(mesh.faces) == 2
    assert len(mesh.positions) == 4


def test_both_sides_of_a_sheet_are_kept() -> None:
    """A face and its reverse differ: a leaf seen from both sides."""
    faces = np.concatenate((TWO, TWO[:, ::-1]))
    mesh = clean_surface("leaf", [MeshPart(SQUARE, faces)])
    assert len(mesh.faces) == 4
    assert mesh.dropped == 0


@pytest.mark.parametrize(
    ("vertices", "faces", "message"),
    [
        (SQUARE, np.array([(0, 1, 4)]), "indices of 4 vertices"),
        (SQUARE, np.array([(0, 1, -1)]), "indices of 4 vertices"),
        (SQUARE, np.empty((0, 3), dtype=int), "at least one triangle"),
        (SQUARE, np.array([(0, 0, 1)]), "triangle with an area"),
        (SQUARE * np.nan, TWO, "finite vertices"),
        (SQUARE + np.array((np.inf, 0, 0)), TWO, "finite vertices"),
        (SQUARE * 1e160, TWO, r"finite vertices within 1e\+30"),
    ],
)
def test_meshes_that_cannot_be_used_are_refused_by_name(
    vertices: np.ndarray, faces: np.ndarray, message: str
) -> None:
    """The message names the mesh and what is wrong with it."""
    with pytest.raises(InputError, match=f"mesh odd: .*{message}"):
        clean_surface("odd", [MeshPart(vertices, faces)])


def test_parts_of_one_material_are_one() -> None:
    """Three parts of two materials are two parts, textured where one of its pieces is."""
    parts = [
        MeshPart(
            SQUARE + np.array((i, 0, 0)),
            TWO,
            material=m,
            textured=t,
            uv=SQUARE[:, :2] if t else None,
        )
        for i, (m, t) in enumerate([(5, False), (2, True), (5, False)])
    ]
    mesh = clean_surface("three", parts)
    assert mesh.textured.tolist() == [True, False]
    assert np.bincount(mesh.part).tolist() == [2, 4]
    assert mesh.has_uv
    # Corners of the textured square keep its coordinates, others have (0, 0).
    assert np.array_equal(
        mesh.uv[mesh.uv_index[mesh.part == 0]],
        mesh.positions[mesh.faces[mesh.part == 0]][..., :2] - (1, 0),
    )
    assert (mesh.uv[mesh.uv_index[mesh.part == 1]] == 0).all()


def test_y_up_stands_on_the_ground() -> None:
    """A y-up tetrahedron 4 units tall becomes 2 m tall, foot at zero, y turned to z."""
    corners = np.array([(0, 1, 0), (2, 1, 0), (0, 1, 2), (0, 5, 0)], dtype=float)
    faces = np.array([(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)])
    mesh = clean_surface("tetra", [MeshPart(corners, faces)]).standing(y_up=True, height_m=2.0)
    low, high = mesh.positions.min(axis=0), mesh.positions.max(axis=0)
    assert low.tolist() == [-0.5, -0.5, 0.0]
    assert high.tolist() == [0.5, 0.5, 2.0]
    # The apex stands above the file's (0, ., 0): x = 0 is the low end, and -z = 0 the high one.
    apex = mesh.positions[mesh.positions[:, 2] == 2.0][0]
    assert apex.tolist() == [-0.5, 0.5, 2.0]


def test_units_keep_the_size() -> None:
    """A file in millimetres keeps its proportions in metres."""
    mesh = clean_surface("square", [MeshPart(SQUARE * 1000, TWO)])
    assert np.ptp(mesh.standing(y_up=False, unit_m=1e-3).positions, axis=0).tolist() == [1, 1, 0]


def test_a_flat_mesh_has_no_height_to_scale() -> None:
    """A sheet on the ground is refused for a height, and named."""
    with pytest.raises(InputError, match="mesh square: expected a height"):
        clean_surface("square", [MeshPart(SQUARE, TWO)]).standing(y_up=False, height_m=2.0)
