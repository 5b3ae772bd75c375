"""Fixtures of unattended runs: a small scene with meshes."""

import numpy as np
import pytest
import trimesh

from lodbench.models.layouts.scene_builder import PlacementOptions, build_scene
from lodbench.models.meshes.geometry import Geometry
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.simplify import ChainOptions, build_chain
from lodbench.models.meshes.surface_mesh import MeshPart, clean_surface
from lodbench.models.scene.scene import Scene


@pytest.fixture(scope="session")
def balls() -> tuple[Scene, Geometry]:
    """Return twenty balls of two levels on a grid."""
    mesh = trimesh.creation.icosphere(subdivisions=2)
    part = MeshPart(np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces))
    ball = clean_surface("ball", [part]).standing(y_up=False)
    model = build_chain(ball, ChainOptions(levels=2), Sampling(100, 100))
    options = PlacementOptions(layout="grid", count=20)
    return build_scene("balls", [model], options, np.random.default_rng(0))
