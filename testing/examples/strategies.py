"""Hypothesis strategies for what a policy meets, which shrink to few objects and little motion.

Numbers are drawn from small grids, and every object has an offset and size of its own beside what
is drawn: simple examples shrink well, and no two objects tie, so that a policy may break ties as it
likes.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from hypothesis import strategies as st

from ...models.machine.cost import CostModel, CpuCostModel
from ...models.machine.hardware import Display, HardwareProfile, Provenance
from ...models.machine.residual import Residual
from ...models.scene.camera import Camera
from ...models.scene.frustum import Culler
from ...models.scene.motion import Centers
from ...models.scene.scene import Scene
from ...policies.frame_times import Completed
from ...policies.view import FrameState, View
from ...traces.cameras.camera_trace import CameraTrace
from ...traces.cameras.orientation import look_along
from .small_scenes import level_table, scene_of, trees

_EYE_M = 1.65
_LEG_S = 0.1


class _Chain(NamedTuple):
    """Levels of a type: triangles of the finest, share that a level keeps, number of levels."""

    triangles: int
    share: float
    levels: int


class _Object(NamedTuple):
    """An object: steps ahead and to the side, size, and which of the types it is modulo."""

    ahead: int
    aside: int
    size: int
    kind: int


_chains = st.builds(
    _Chain,
    st.sampled_from((1000, 2000, 4000, 8000)),
    st.sampled_from((0.5, 0.25, 0.1)),
    st.integers(1, 4),
)
_objects = st.builds(
    _Object, st.integers(0, 40), st.integers(-8, 8), st.integers(0, 6), st.integers(0, 3)
)


@st.composite
def scenes(
    draw: st.DrawFn, *, objects: int = 8, continuous: bool = False, hierarchy: bool = False
) -> Scene:
    """Draw scenes of 1 to `objects` objects ahead of the origin along +x, of 1 to 3 types.

    Parameters
    ----------
    objects
        Most objects of a flat scene, or most roots of a hierarchy.
    continuous
        Types take resolutions instead of levels.
    hierarchy
        Every object is a tree of up to two layers of four children, each node with one level.
    """
    placed: list[_Object] = draw(st.lists(_objects, min_size=1, max_size=objects))
    if hierarchy:
        layers: list[int] = [draw(st.integers(0, 2)) for _ in placed]
        roots_m, radius_m = _places(placed)
        depth, parent, position_m, scale = trees(roots_m, 4.0 * radius_m, layers)
        levels = level_table([[600.0], [400.0], [350.0]], (False,) * 3, (0.5, 0.1, 0.0))
        return scene_of("example", levels, depth, position_m, scale, parent=parent)
    chains: list[_Chain] = draw(st.lists(_chains, min_size=1, max_size=3))
    kind = np.array([item.kind % len(chains) for item in placed])
    soft = [continuous and chain.levels > 1 for chain in chains]
    levels = level_table([_triangles(chain) for chain in chains], soft)
    position_m, scale = _places(placed)
    return scene_of("example", levels, kind, position_m, scale)


def _triangles(chain: _Chain) -> list[float]:
    return [float(round(chain.triangles * chain.share**i)) for i in range(chain.levels)]


def _places(placed: Sequence[_Object]) -> tuple[np.ndarray, np.ndarray]:
    """Return positions (n, 3) and radii (n,) of which no two are alike."""
    order = np.arange(len(placed))
    ahead, aside, size, _ = (np.array(column) for column in zip(*placed, strict=True))
    position_m = np.column_stack(
        (4.0 + ahead + 0.317 * order, 0.7 * aside + 0.053 * (order + 1) ** 1.5, 1.0 + 0.07 * order)
    )
    return position_m, (0.5 + 0.25 * size) * (1.0 + 0.013 * order)


@st.composite
def traces(draw: st.DrawFn, *, legs: int = 10) -> CameraTrace:
    """Draw traces from the origin in 0 to `legs` legs of 0.1 s: a step and a turn each.

    A leg goes 0 to 1 m ahead (10 m/s at most) and turns 45 degrees to either side at most.
    """
    steps: list[tuple[int, int]] = draw(
        st.lists(st.tuples(st.integers(0, 4), st.integers(-3, 3)), max_size=legs)
    )
    heading_rad = np.radians(np.cumsum([0.0, *(15.0 * turn for _, turn in steps)]))
    step_m = np.array([0.0, *(0.25 * step for step, _ in steps)])
    ahead = np.column_stack((np.cos(heading_rad), np.sin(heading_rad)))
    plan_m = np.cumsum(step_m[:, np.newaxis] * ahead, axis=0)
    return CameraTrace(
        "example",
        np.arange(len(step_m), dtype=np.float64) * _LEG_S,
        np.column_stack((plan_m, np.full(len(step_m), _EYE_M))),
        look_along(heading_rad, np.zeros_like(heading_rad)),
        np.zeros(len(step_m), dtype=np.bool_),
    )


@st.composite
def hardware_profiles(draw: st.DrawFn, *, noise: bool = True) -> HardwareProfile:
    """Draw machines of 640 x 360 px, immediate and without noise in the simplest case."""
    microseconds: int = draw(st.sampled_from((1, 2, 5)))
    mode: Any = draw(st.sampled_from(("immediate", "vsync", "mailbox", "vrr")))
    scale: float = draw(st.sampled_from((0.0, 0.03, 0.1))) if noise else 0.0
    residual = Residual("gaussian", scale) if scale else Residual()
    return HardwareProfile(
        "example",
        Provenance("assumed: drawn at random for a test", assumed=True),
        CostModel.of(0.5, {"triangles": 1e-3 * microseconds, "draw_calls": 0.013}),
        CpuCostModel.of(draw(st.sampled_from((0.5, 0.1, 2.0))), {"objects_visited": 1e-5}),
        residual,
        residual,
        display=Display(mode=mode, width_px=640, height_px=360),
        frames_in_flight=draw(st.integers(1, 3)),
    )


@st.composite
def views(draw: st.DrawFn, *, objects: int = 8, continuous: bool = False) -> View:
    """Draw views of flat scenes from the origin, with 0 to 5 completed frames."""
    scene: Scene = draw(scenes(objects=objects, continuous=continuous))
    machine: HardwareProfile = draw(hardware_profiles(noise=False))
    scene = scene.with_costs(machine.gpu)
    heading_rad = np.radians(15.0 * draw(st.integers(-12, 12)))
    turn = look_along(heading_rad, 0.0).tolist()
    camera = Camera((0.0, 0.0, _EYE_M), tuple(turn), 640, 360, np.pi / 3.0)
    work_ms: list[int] = draw(st.lists(st.integers(1, 40), max_size=5))
    times = np.repeat(np.array(work_ms, dtype=np.float64)[:, np.newaxis], 4, axis=1)
    centers = Centers(scene.center_m, scene.motion)
    culler = Culler(centers, scene.radius_m, scene.blocks)
    ids, xyz_m = culler.cull(centers.at(0.0), camera)
    state = FrameState(
        scene,
        camera,
        centers.at(0.0),
        len(work_ms),
        16_666_667 * len(work_ms),
        np.full(len(scene), np.nan),
        Completed(times, len(times)),
        culler.inside,
    )
    return View(state, ids, xyz_m)
