"""Fixtures of the policies' tests: views of hierarchies, a city like the thesis', a street."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import ObjectTypes, Scene
from lodbench.policies.view import View
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.orientation import look_along

_WANTED = 900.0  # triangles of a node
_FACTOR = 4
_BLOCKS = 5
_PITCH_M = 110.0  # from one street to the next


@pytest.fixture(scope="session")
def make_tree_view(make_view: Callable[..., View]) -> Callable[..., View]:
    """Return a function like `make_view` whose candidates are the roots in the frustum."""

    def build(scene: Scene, *args: Any, **more: Any) -> View:
        view = make_view(scene, *args, **more)
        roots = scene.roots
        return view.at(roots[view.state.inside[roots]])

    return build


@pytest.fixture(scope="session")
def old_machine(make_hardware: Callable[..., HardwareProfile]) -> HardwareProfile:
    """Return a machine without noise for a budget of 30 ms, with a slow disk and little memory."""
    machine = make_hardware(
        {"triangles": 8e-5, "draw_calls": 0.01},
        base_ms=3.0,
        cpu={"objects_visited": 1e-5, "comparisons": 1e-6, "draw_calls": 1e-3},
        cpu_base_ms=2.0,
        width_px=1280,
        height_px=1024,
    )
    return replace(machine, memory_bytes=2.5e8, disk_bytes_per_s=40e6, disk_latency_ms=8.0)


class _Growing:
    """Nodes of a city while it is being built; a list a column."""

    def __init__(self) -> None:
        self.parent: list[int] = []
        self.center_m: list[tuple[float, float, float]] = []
        self.radius_m: list[float] = []
        self.triangles: list[float] = []
        self.error_m: list[float] = []

    def grow(
        self,
        rng: np.random.Generator,
        parent: int,
        middle_m: np.ndarray,
        along: np.ndarray,
        length_m: float,
        triangles: float,
    ) -> None:
        """Add a piece of a facade and, while it has more triangles than wanted, its parts."""
        node = len(self.parent)
        finest = triangles <= _FACTOR * _WANTED
        drawn = triangles if finest else _WANTED * float(rng.uniform(0.6, 1.5))
        self.parent.append(parent)
        self.center_m.append((*(middle_m.tolist()), 6.0))
        self.radius_m.append(0.5 * length_m + 6.0)  # holds the parts' spheres
        self.triangles.append(drawn)
        self.error_m.append(0.0 if finest else 0.02 * float(np.sqrt(triangles / drawn)))
        if finest:
            return
        parts = _FACTOR if rng.random() < 0.9 else 3
        shares: list[float] = rng.dirichlet(np.full(parts, 12.0)).tolist()
        for part in range(parts):
            offset_m = ((part + 0.5) / parts - 0.5) * length_m
            where_m = middle_m + offset_m * along
            self.grow(rng, node, where_m, along, length_m / parts, triangles * shares[part])

    def scene(self, name: str, rng: np.random.Generator) -> Scene:
        """Return the scene of what has grown: a type a node, half to all of it textured."""
        n = len(self.parent)
        counts = np.zeros((n, len(LEVEL_PREDICTORS)))
        counts[:, LEVEL_PREDICTORS.index("draw_calls")] = 1.0
        counts[:, LEVEL_PREDICTORS.index("triangles")] = self.triangles
        textured = np.array(self.triangles) * rng.uniform(0.5, 1.0, n)
        counts[:, LEVEL_PREDICTORS.index("textured_triangles")] = textured
        size_bytes = 300.0 * np.array(self.triangles)
        never = np.zeros(n, dtype=bool)
        levels = LevelTable(np.arange(n + 1), counts, np.array(self.error_m), size_bytes, never)
        names = tuple(f"piece-{i}" for i in range(n))
        types = ObjectTypes(names, np.zeros((n, 3)), np.array(self.radius_m), levels)
        return Scene(
            name,
            types,
            np.arange(n),
            np.array(self.center_m),
            np.tile((0.0, 0.0, 0.0, 1.0), (n, 1)),
            np.ones(n),
            np.ones(n),
            np.array(self.parent),
            never,
        )


@pytest.fixture(scope="session")
def city() -> Scene:
    """Return 114 facades about 5 x 5 blocks as trees of at most 5 levels, 2,297 nodes."""
    rng = np.random.default_rng(19)
    nodes = _Growing()
    sides = [(block, side) for block in range(_BLOCKS**2) for side in range(5)][:114]
    for block, side in sides:
        corner_m = np.array(divmod(block, _BLOCKS)) * _PITCH_M
        along = np.array([1.0, 0.0] if side % 2 else [0.0, 1.0])
        across = along[::-1] * (45.0 if side % 4 < 2 else -45.0) * (side < 4)
        triangles = float(np.clip(rng.lognormal(math.log(13_400.0), 1.25), 600.0, 250_000.0))
        nodes.grow(rng, -1, corner_m + across, along, 90.0, triangles)
    return nodes.scene("city", rng)


@pytest.fixture(scope="session")
def chains() -> Scene:
    """Return 800 objects about a street, each a chain of five nodes: the hierarchy of 1993."""
    rng = np.random.default_rng(3)
    nodes = _Growing()
    for _ in range(800):
        side_m = float(rng.uniform(20.0, 100.0)) * (1.0 if rng.random() < 0.5 else -1.0)
        where_m = (float(rng.uniform(-200.0, 250.0)), 0.5 * _PITCH_M + side_m, 3.0)
        radius_m = float(rng.uniform(2.0, 6.0))
        full = float(rng.lognormal(math.log(20_000.0), 0.6))
        for level in range(5):
            triangles = full / 3.0 ** (4 - level)
            nodes.parent.append(len(nodes.parent) - 1 if level else -1)
            nodes.center_m.append(where_m)
            nodes.radius_m.append(radius_m)
            nodes.triangles.append(triangles)
            nodes.error_m.append(0.0 if level == 4 else 1.5 * radius_m / float(np.sqrt(triangles)))
    return nodes.scene("chains", rng)


@pytest.fixture(scope="session")
def make_street_trace() -> Callable[..., CameraTrace]:
    """Return a function that makes a trace along a street and round a corner, at a speed."""

    def build(speed_m_s: float, seconds: float) -> CameraTrace:
        time_s = np.arange(0.0, seconds, 0.1)
        along_m = speed_m_s * time_s
        corner_m = 2.0 * _PITCH_M
        x_m = np.minimum(along_m, corner_m) - 0.5 * _PITCH_M
        y_m = np.maximum(along_m - corner_m, 0.0) + 0.5 * _PITCH_M
        position_m = np.stack((x_m, y_m, np.full_like(x_m, 1.7)), axis=1)
        # The head turns a little while walking, and by a right angle at the corner.
        turn = np.clip((along_m - corner_m) / 5.0, 0.0, 1.0) * 0.5 * np.pi
        heading = turn + 0.1 * np.sin(0.8 * time_s)
        cut = np.zeros(len(time_s), dtype=bool)
        return CameraTrace(
            "street", time_s, position_m, look_along(heading, np.zeros_like(heading)), cut
        )

    return build
