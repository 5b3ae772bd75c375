"""Fixtures of what is drawn: a context, meshes by hand, scenes of them, and their pictures."""

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lodbench.analysis.study.inputs import load_trace
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.meshes.geometry import Geometry, LevelMesh
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.models.scenes.plaza import build_plaza
from lodbench.render.gl.context import Target, open_target
from lodbench.render.gl.draw_list import Picture
from lodbench.render.gl.opengl_machine import GlMachine
from lodbench.render.gl.renderer import Renderer
from lodbench.sim.machine.simulated_machine import FrameTimes, Submitted
from lodbench.traces.cameras.camera_trace import CameraTrace

SKY = (199, 217, 235)
UPRIGHT = (0.0, 0.0, 0.0, 1.0)  # looks along -z, x to the right and y up


@pytest.fixture(scope="module")
def target(egl: None) -> Generator[Target]:
    """Open a context for the tests of one module."""
    opened = open_target("egl", threads=0)
    yield opened
    opened.close()


def build_quad(center_m: Sequence[float] = (0.0, 0.0, 0.0), side_m: float = 2.0) -> LevelMesh:
    """Build a square that faces +z, with texture coordinates."""
    corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * side_m / 2.0
    faces = np.array([(0, 1, 2), (0, 2, 3)])
    uv = corners[:, :2] / side_m + 0.5
    return _mesh(corners + center_m, np.tile((0.0, 0.0, 1.0), (4, 1)), faces, (2,), uv)


def build_cube(
    center_m: Sequence[float] = (0.0, 0.0, 0.0),
    side_m: float = 2.0,
    *,
    parts: Sequence[int] = (12,),
) -> LevelMesh:
    """Build a cube of 24 vertices and 12 triangles, in parts of so many triangles."""
    square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    sides = [(axis, sign) for axis in range(3) for sign in (-1.0, 1.0)]
    corners = np.concatenate([np.insert(square, axis, sign, axis=1) for axis, sign in sides])
    normals = np.repeat([np.insert(np.zeros(2), axis, sign) for axis, sign in sides], 4, axis=0)
    faces = np.concatenate([np.array([(0, 1, 2), (0, 2, 3)]) + 4 * side for side in range(6)])
    uv = np.tile(0.5 * square + 0.5, (6, 1))
    return _mesh(corners * side_m / 2.0 + center_m, normals, faces, parts, uv)


def _mesh(vertices: Any, normals: Any, faces: Any, parts: Sequence[int], uv: Any) -> LevelMesh:
    return LevelMesh(vertices, normals, faces, np.cumsum([0, *parts]), uv)


def build_table(
    meshes: Sequence[Sequence[LevelMesh]],
    *,
    skinned: Sequence[Sequence[bool]] | bool = False,
    textured: float = 0.0,
) -> LevelTable:
    """Build the level table of types by their meshes, a share `textured` of their triangles so."""
    rows: list[list[float]] = []
    for k, levels in enumerate(meshes):
        for i, mesh in enumerate(levels):
            bends = skinned if isinstance(skinned, bool) else skinned[k][i]
            values = {
                "draw_calls": len(mesh.part_start) - 1,
                "vertices": len(mesh.vertices),
                "triangles": len(mesh.faces),
                "skinned_vertices": len(mesh.vertices) if bends else 0,
                "textured_triangles": textured * len(mesh.faces),
            }
            rows.append([float(values.get(name, 0)) for name in LEVEL_PREDICTORS])
    sizes = [len(levels) for levels in meshes]
    return LevelTable(
        np.cumsum([0, *sizes]),
        np.array(rows),
        np.concatenate([np.arange(float(size)) for size in sizes]),
        np.ones(len(rows)),
        np.zeros(len(sizes), dtype=np.bool_),
    )


@dataclass(frozen=True)
class Drawing:
    """A scene of meshes made by hand, and how to draw it."""

    target: Target
    scene: Scene
    geometry: Geometry

    def renderer(self, *, instancing: bool = False) -> Renderer:
        """Return a renderer of the scene."""
        return Renderer(self.target, self.scene, self.geometry, instancing=instancing)

    def picture(self, camera: Camera | None = None, **more: Any) -> Picture:
        """Return a picture of all nodes at their finest in 64 x 64 px, 90° wide, unless told."""
        camera = camera or Camera((0.0, 0.0, 0.0), UPRIGHT, 64, 64, np.pi / 2)
        scene = self.scene
        centers_m = np.asarray(more.get("centers_m", scene.center_m.T))
        ids = np.asarray(more.get("ids", np.arange(len(scene))), dtype=np.int32)
        row = scene.types.levels.start[scene.type_index[ids]] + more.get("level", 0)
        gap = centers_m[:, ids].T - np.array(camera.position_m)
        size = more.get("size_px", (camera.width_px, camera.height_px))
        distance_m = np.linalg.norm(gap, axis=1)
        time_s = more.get("time_s", 0.0)
        mixed, upload_bytes = more.get("mixed", False), more.get("upload_bytes", 0)
        place = (centers_m, ids, row.astype(np.int64), distance_m)
        return Picture(camera, *place, time_s, size, mixed, upload_bytes)

    def pixels(
        self, camera: Camera | None = None, *, instancing: bool = False, **more: Any
    ) -> NDArray[np.uint8]:
        """Draw that picture and return its pixels."""
        return self.renderer(instancing=instancing).picture(self.picture(camera, **more))


class Stepping:
    """A machine from whose frames the trace goes on by a step, whatever they took."""

    def __init__(self, measuring: GlMachine, step_ms: float) -> None:
        self.measuring, self.step_ms = measuring, step_ms

    def begin(self) -> None:
        """Begin a frame."""

    def run(self, frame: Submitted) -> FrameTimes:
        """Measure the frame."""
        self.measuring.run(frame)
        return FrameTimes(0.0, 0.0, self.step_ms)


@pytest.fixture(scope="session")
def stepping() -> type[Stepping]:
    """Return `Stepping`."""
    return Stepping


@pytest.fixture(scope="session")
def quad() -> Callable[..., LevelMesh]:
    """Return `build_quad`."""
    return build_quad


@pytest.fixture(scope="session")
def cube() -> Callable[..., LevelMesh]:
    """Return `build_cube`."""
    return build_cube


@pytest.fixture(scope="module")
def drawing(target: Target, make_scene: Callable[..., Scene]) -> Callable[..., Drawing]:
    """Return a function that makes a scene of the meshes of each type, by level."""

    def make(
        position_m: Any,
        meshes: Sequence[Sequence[LevelMesh]],
        *,
        skinned: Sequence[Sequence[bool]] | bool = False,
        textured: float = 0.0,
        **more: Any,
    ) -> Drawing:
        levels = build_table(meshes, skinned=skinned, textured=textured)
        scene = make_scene(position_m, levels=levels, **more)
        return Drawing(target, scene, tuple(mesh for chain in meshes for mesh in chain))

    return make


@pytest.fixture(scope="session")
def covered() -> Callable[[NDArray[np.uint8]], NDArray[np.bool_]]:
    """Return a function that tells which pixels show anything but the sky."""
    return lambda pixels: (pixels != np.array(SKY, dtype=np.uint8)).any(axis=2)


@pytest.fixture(scope="session")
def plaza() -> tuple[Scene, Geometry]:
    """Return the bundled scene with its meshes."""
    return build_plaza()


@pytest.fixture(scope="session")
def tour(plaza: tuple[Scene, Geometry]) -> CameraTrace:
    """Return the bundled path through it."""
    return load_trace("tour", plaza[0])


@pytest.fixture(scope="session")
def llvmpipe() -> HardwareProfile:
    """Return the bundled profile of the software rasteriser."""
    return load_hardware("llvmpipe")
