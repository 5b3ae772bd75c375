"""Fixtures of the policies' tests: views of hierarchies, and a city of streets like the thesis'."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.models.levels import LevelTable
from lodbench.models.predictors import LEVEL_PREDICTORS
from lodbench.models.scene import ObjectTypes, Scene
from lodbench.policies.view import View
from lodbench.traces.camera import CameraTrace
from lodbench.traces.orientation import look_along

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
        shares = rng.dirichlet(np.full(parts, 12.0))
        for part in range(parts):
            offset_m = ((part + 0.5) / parts - 0.5) * length_m
            where_m = middle_m + offset_m * along
            self.grow(rng, node, where_m, along, length_m / parts, triangles * shares[part])


@pytest.fixture(scope="session")
def city() -> Scene:
    """Return 114 facades about 5 x 5 blocks as trees of at most 5 levels, about 2,300 nodes."""
    rng = np.random.default_rng(20)
    nodes = _Growing()
    sides = [(block, side) for block in range(_BLOCKS**2) for side in range(5)][:114]
    for block, side in sides:
        corner_m = np.array(divmod(block, _BLOCKS)) * _PITCH_M
        along = np.array([1.0, 0.0] if side % 2 else [0.0, 1.0])
        across = along[::-1] * (45.0 if side % 4 < 2 else -45.0) * (side < 4)
        triangles = float(np.exp(rng.normal(np.log(13_400.0), 1.25)).clip(600.0, 250_000.0))
        nodes.grow(rng, -1, corner_m + across, along, 90.0, triangles)
    n = len(nodes.parent)
    counts = np.zeros((n, len(LEVEL_PREDICTORS)))
    counts[:, LEVEL_PREDICTORS.index("draw_calls")] = 1.0
    counts[:, LEVEL_PREDICTORS.index("triangles")] = nodes.triangles
    textured = np.array(nodes.triangles) * rng.uniform(0.5, 1.0, n)
    counts[:, LEVEL_PREDICTORS.index("textured_triangles")] = textured
    levels = LevelTable(
        np.arange(n + 1),
        counts,
        np.array(nodes.error_m),
        300.0 * np.array(nodes.triangles),
        np.zeros(n, dtype=bool),
    )
    names = tuple(f"piece-{i}" for i in range(n))
    types = ObjectTypes(names, np.zeros((n, 3)), np.array(nodes.radius_m), levels)
    upright = np.tile((0.0, 0.0, 0.0, 1.0), (n, 1))
    return Scene(
        "city",
        types,
        np.arange(n),
        np.array(nodes.center_m),
        upright,
        np.ones(n),
        np.ones(n),
        np.array(nodes.parent),
        np.zeros(n, dtype=bool),
    )


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
        heading = turn + 0.0 * np.sin(0.8 * time_s)
        cut = np.zeros(len(time_s), dtype=bool)
        return CameraTrace(
            "street", time_s, position_m, look_along(heading, np.zeros_like(heading)), cut
        )

    return build
