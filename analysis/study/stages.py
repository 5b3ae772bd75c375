"""Where cameras move in a scene: ground and plan of its space, and ways and speeds of its paper.

Most scenes need nothing but the box about them.  In the bundled ones that have streets, corridors
or mountains, a path that knows nothing of these would go through walls or below the ground.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TypeAlias

import numpy as np

from ...base.arrays import FloatArray
from ...models.scene.extent import scene_extent
from ...models.scene.scene import Scene
from ...traces.cameras.camera_trace import CameraTrace
from ...traces.cameras.generators.generate import KINDS, generate
from ...traces.cameras.generators.load_map import LoadMap
from ...traces.cameras.generators.route import follow_route
from ...traces.cameras.generators.tour import tour
from ...traces.cameras.generators.trial import trial
from .scene_load import map_load

Plan: TypeAlias = tuple[float, float]

WALK_M_S, DRIVE_M_S = 1.4, 14.0
"""Speeds along a way: on foot, and ten times as fast, as the HLOD thesis compares (section 6.5)."""

_EYE_M = 1.65
_PACES = 0.7, 1.0  # shares of a speed that seeds draw from
_PACE = 1  # beside the seed, so that paces are not the draws that make the route
_FLIGHT_M, _FLIGHT_SHARE = 60.0, 0.25


@dataclass(frozen=True, slots=True)
class Move:
    """How a kind of movement differs from its defaults; None for those."""

    extent_m: float | None = None
    speed_m_s: float | None = None
    height_m: float | None = None
    on_ground: bool = False


@dataclass(frozen=True, slots=True)
class Stage:
    """The space of a scene.

    Attributes
    ----------
    ground_m : (x, y, z)
        Middle of the plan; z is the ground.
    plan_m : lengths in x and y
    way_m : (n, 2) or None
        What `walk` and `drive` follow.
    moves : Mapping
        By kind of movement.
    load : callable or None
        Returns where the load is within a plan: centre, lengths, way.
    surface : callable or None
        Returns the ground's z at (n, 2) points, where it is not flat.
    """

    ground_m: tuple[float, float, float]
    plan_m: tuple[float, float]
    way_m: FloatArray | None = None
    moves: Mapping[str, Move] = field(default_factory=dict[str, Move])
    surface: Callable[[FloatArray], FloatArray] | None = None
    load: Callable[[Plan, Plan, FloatArray | None], LoadMap] | None = None

    def tour(self) -> CameraTrace:
        """Return the bundled trace over this stage."""
        x, y, z = self.ground_m
        lift = self.moves.get("tour", Move()).height_m or 0.0
        return tour((x, y, z + lift), self.plan_m)

    def move(self, kind: str, duration_s: float, seed: int = 0) -> CameraTrace:
        """Return a generated trace of a kind of movement over this stage.

        Seeds other than 0 give other routes, or starts and directions on the stage's way, at
        speeds of 0.7 to 1 of the kind's.
        """
        rng = np.random.default_rng((seed, _PACE))
        pace = float(rng.uniform(*_PACES)) if seed else 1.0
        if kind == "trial" and self.load is not None:
            return self._trial(self.load, duration_s, seed)
        if self.way_m is not None and kind in ("walk", "drive"):
            way = np.column_stack((self.way_m, np.full(len(self.way_m), self.ground_m[2])))
            return follow_route(
                f"{kind}-{seed}" if seed else kind,
                way[::-1] if seed and rng.random() < 0.5 else way,
                speed_m_s=pace * (WALK_M_S if kind == "walk" else DRIVE_M_S),
                height_m=_EYE_M,
                duration_s=duration_s,
                start=float(rng.random()) if seed else 0.0,
            )
        move = self.moves.get(kind, Move())
        speed_m_s = move.speed_m_s or KINDS[kind].limits.speed_m_s
        trace = generate(
            kind,
            duration_s=duration_s,
            extent_m=move.extent_m or min(self.plan_m),
            center_m=self.ground_m,
            speed_m_s=pace * speed_m_s or None,  # a kind that stands takes no speed
            height_m=move.height_m,
            seed=seed,
        )
        if self.surface is None or not move.on_ground:
            return trace
        position = trace.position_m.copy()
        position[:, 2] += self.surface(position[:, :2]) - self.ground_m[2]
        return replace(trace, position_m=position)

    def _trial(
        self, load: Callable[[Plan, Plan, FloatArray | None], LoadMap], duration_s: float, seed: int
    ) -> CameraTrace:
        x, y, z = self.ground_m
        kind, move = KINDS["trial"], self.moves.get("trial", Move())
        plan = self.plan_m if move.extent_m is None else (move.extent_m, move.extent_m)
        limits = kind.limits
        if move.speed_m_s is not None:
            limits = replace(limits, speed_m_s=move.speed_m_s)
        return trial(
            f"trial-{seed}",
            load((x, y), plan, self.way_m),
            limits,
            height_m=z + (kind.height_m if move.height_m is None else move.height_m),
            duration_s=duration_s,
            seed=seed,
        )


def find_stage(scene: Scene) -> Stage:
    """Return the stage of a bundled scene, or the box about any other."""
    known = _STAGES.get((scene.name, scene.types.names[0]))
    stage = _box(scene) if known is None else known()
    return replace(stage, load=partial(map_load, scene))


def _box(scene: Scene) -> Stage:
    middle, size = scene_extent(scene)
    ground = (float(middle[0]), float(middle[1]), float(middle[2] - 0.5 * size[2]))
    plan = (float(size[0]), float(size[1]))
    # From the usual height, a view 25 degrees down would miss a small scene.
    low = min(_FLIGHT_M, _FLIGHT_SHARE * min(plan))
    return Stage(ground, plan, moves={"fly-over": Move(height_m=low)})


def _atlas() -> Stage:
    moves = {"fly-over": Move(44.0, None, 30.0), "orbit": Move(90.0)}
    return Stage((0.0, 0.0, 0.0), (44.0, 25.0), moves=moves)


def _city() -> Stage:
    from ...models.scenes.city import street_route_m

    # So high and far that every wall is in view: the HLOD thesis' fly-through (section 6.2).
    moves = {"orbit": Move(1500.0, 15.0, 450.0)}
    return Stage((0.0, 0.0, 0.0), (960.0, 800.0), street_route_m(), moves)


def _soda_hall() -> Stage:
    from ...models.scenes.parts.floor_plan import CORRIDOR_M, DEPTH_M, LENGTH_M, route_m

    length, depth = LENGTH_M + CORRIDOR_M, 3.0 * DEPTH_M + 2.0 * CORRIDOR_M
    moves = {"fly-over": Move(140.0, None, 40.0), "orbit": Move(160.0)}
    return Stage((length / 2.0, depth / 2.0, 0.0), (length, depth), route_m(), moves)


def _styria() -> Stage:
    from ...models.scenes.styria import CELL_M, WIDTH_M, styria_heights

    def surface(points_m: FloatArray) -> FloatArray:
        from scipy.ndimage import map_coordinates

        row_column = points_m[:, ::-1].T / CELL_M
        heights: FloatArray = map_coordinates(styria_heights(), row_column, order=1, mode="nearest")
        return heights

    high, middle = 3_200.0, WIDTH_M / 2.0
    far = Move(60_000.0, None, high)
    aloft = dict.fromkeys(("tour", "orbit", "look-around", "dash", "teleport"), far)
    moves = aloft | {
        "trial": Move(60_000.0, 250.0, high),
        "walk": Move(200.0, WALK_M_S, None, on_ground=True),
        "drive": Move(2_000.0, DRIVE_M_S, None, on_ground=True),
        "fly-over": Move(60_000.0, 250.0, high),
        "sudden-turn": Move(5_000.0, 250.0, high),
    }
    return Stage((middle, middle, 0.0), (100_000.0, 100_000.0), None, moves, surface)


# By name and first type, as a scene of one's own may have any name.
_STAGES: dict[tuple[str, str], Callable[[], Stage]] = {
    ("atlas", "coil"): _atlas,
    ("city", "wall-0/0"): _city,
    ("soda-hall", "chair"): _soda_hall,
    ("styria", "patch-0-0"): _styria,
}
