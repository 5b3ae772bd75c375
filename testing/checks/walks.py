"""What the checks have in common: scenes that a policy fits, budgets, walks, and comparisons."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from unittest import SkipTest

import numpy as np

from ...models.scene.camera import Camera
from ...models.scene.scene import Scene
from ...policies.bounds.full import Full
from ...policies.protocol import Claims, Policy, claims_of, why_not_applicable
from ...policies.selection import Selection
from ...policies.view import View
from .check_scenes import camera_at, scenes
from .driver import Played, Player, coarsest, frame_ms

Factory = Callable[[], Policy]

WALK = (
    *(camera_at(0.3 * k, turned_deg=2.0 * k) for k in range(6)),
    *(camera_at(40.0 - 0.2 * k, turned_deg=170.0) for k in range(4)),  # a cut
    *(camera_at(12.0 + k) for k in range(3)),
)
"""Poses of a walk with two cuts."""


def fitting_scenes(factory: Factory) -> Iterator[Scene]:
    """Yield the scenes that a policy can drive; SkipTest if there are none."""
    capabilities = factory().capabilities
    found = [scene for scene in scenes() if why_not_applicable(capabilities, scene) is None]
    if not found:
        raise SkipTest("fits none of the scenes")
    yield from found


def require_claim(factory: Factory, claimed: Callable[[Claims], bool], what: str) -> Claims:
    """Return a policy's claims; SkipTest unless it claims this one."""
    claims = claims_of(factory())
    if not claimed(claims):
        raise SkipTest(f"claims no {what}")
    return claims


def play(
    policy: Policy, scene: Scene, budget_ms: float, walk: Sequence[Camera] = WALK
) -> list[Played]:
    """Play a walk from a reset."""
    player = Player(policy, scene, budget_ms)
    return [player.play(camera) for camera in walk]


def budgets(view: View) -> tuple[float, float]:
    """Return the time of a view at its coarsest and in full detail."""
    scene = view.scene
    levels = scene.types.levels
    leaf = np.diff(scene.child_start) == 0
    full = np.flatnonzero((leaf | scene.additive) & view.state.inside).astype(np.int32)
    kind = scene.type_index[full]
    finest = Selection(full, levels.continuous[kind].astype(np.float64))
    return frame_ms(view, coarsest(view)), frame_ms(view, finest)


def budget_between(scene: Scene, share: float, camera: Camera = WALK[0]) -> float:
    """Return a budget a share of the way from the coarsest to full detail at a pose."""
    least_ms, full_ms = budgets(Player(Full(), scene, 1.0).show(camera))
    return least_ms + share * (full_ms - least_ms)


def difference(one: Played, other: Played, *, tolerance: float = 0.0) -> str | None:
    """Return how two selections differ, or None.

    With a tolerance only what is drawn counts, and resolutions may differ by so much.
    """
    a, b = (_sorted(played.drawn if tolerance else played.selection) for played in (one, other))
    where = f"{one.view.scene.name}, frame {one.view.frame}"
    if not np.array_equal(a.ids, b.ids):
        odd = np.setxor1d(a.ids, b.ids)
        return f"{where}: node {odd[0]} is drawn only once, of {len(a.ids)} and {len(b.ids)} nodes"
    off = np.abs(a.detail - b.detail) > tolerance
    if off.any():
        at = int(off.argmax())
        return f"{where}: node {a.ids[at]} has detail {a.detail[at]:g} and {b.detail[at]:g}"
    if abs(a.render_scale - b.render_scale) > tolerance:
        return f"{where}: render scale {a.render_scale:g} and {b.render_scale:g}"
    if not tolerance and (a.work, str(a.predicted_ms)) != (b.work, str(b.predicted_ms)):
        return f"{where}: {a.work}, {a.predicted_ms} ms and {b.work}, {b.predicted_ms} ms"
    return None


def _sorted(selection: Selection) -> Selection:
    order = np.argsort(selection.ids)
    return replace(selection, ids=selection.ids[order], detail=selection.detail[order])
