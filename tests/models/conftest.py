"""Fixtures of the models' tests: a small scene with geometry."""

import numpy as np
import pytest
import trimesh

from lodbench.models.layouts.scene_builder import PlacementOptions, build_scene
from lodbench.models.meshes.geometry import Geometry
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.simplify import ChainOptions, build_chain
from lodbench.models.meshes.surface_mesh import MeshPart, clean_surface
from lodbench.models.meshes.type_model import TypeModel
from lodbench.models.scene.scene import Scene


@pytest.fixture(scope="session")
def ball_models() -> list[TypeModel]:
    """Return a textured ball and a smaller plain one, three and two levels."""
    models: list[TypeModel] = []
    for name, radius, levels in (("ball", 1.0, 3), ("pebble", 0.25, 2)):
        mesh = trimesh.creation.icosphere(subdivisions=2, radius=radius)
        points = np.asarray(mesh.vertices, dtype=float)
        textured = name == "ball"
        part = MeshPart(
            points,
            np.asarray(mesh.faces),
            textured=textured,
            uv=points[:, :2] if textured else None,
        )
        full = clean_surface(name, [part]).standing(y_up=False)
        models.append(build_chain(full, ChainOptions(levels=levels), Sampling(100, 100)))
    return models


@pytest.fixture(scope="session")
def ball_scene(ball_models: list[TypeModel]) -> tuple[Scene, Geometry]:
    """Return ten balls and ten pebbles on a grid."""
    options = PlacementOptions(layout="grid", count=20)
    return build_scene("balls", ball_models, options, np.random.default_rng(0))
