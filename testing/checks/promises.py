"""Checks of what a policy claims, and of what it may not make of faulty timings."""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from ...base.arrays import FloatArray
from ...models.scene.scene import Scene
from ...models.scene.tree import Tree
from .check_scenes import camera_at
from .driver import CheckError, Played, Player, Timer, coarsest, frame_ms, live
from .walks import WALK, Factory, budget_between, difference, fitting_scenes, play, require_claim

_ROUNDING = 1e-9  # relative
_REST = 40  # frames for which nothing may change once a policy has settled
_SIGHT = camera_at(2.0)


def keeps_the_budget(factory: Factory) -> None:
    """Neither predicted nor true times exceed the budget, or else the coarsest selection's time.

    Of all frames of a walk with cuts, from next to no budget to more than is needed.
    """
    require_claim(factory, lambda claims: claims.budget, "budget")
    for scene in fitting_scenes(factory):
        for share in (None, 0.1, 0.4, 0.8, 1.5):
            budget_ms = 1e-6 if share is None else budget_between(scene, share)
            for played in play(factory(), scene, budget_ms):
                least_ms = frame_ms(played.view, coarsest(played.view))
                limit_ms = max(budget_ms, least_ms) * (1.0 + _ROUNDING)
                predicted_ms = played.selection.predicted_ms
                wrong = predicted_ms > limit_ms and played.gpu_ms > least_ms * (1.0 + _ROUNDING)
                if played.gpu_ms > limit_ms or wrong:
                    raise CheckError(
                        f"{scene.name}, frame {played.view.frame}: expected at most {limit_ms:g} "
                        f"ms, predicted {predicted_ms:g}, drew {played.gpu_ms:g}"
                    )


def more_budget_never_lowers_benefit(factory: Factory) -> None:
    """From one budget to a larger one the benefit of a frame does not fall, in flat scenes."""
    require_claim(factory, lambda claims: claims.monotone, "benefit that rises with the budget")
    for scene in filter(lambda scene: scene.flat, fitting_scenes(factory)):
        before, before_ms = 0.0, 0.0
        for share in np.linspace(-0.3, 1.2, 26).tolist():
            budget_ms = max(budget_between(scene, share, _SIGHT), 1e-6)
            benefit = play(factory(), scene, budget_ms, (_SIGHT,) * 2)[-1].benefit
            if benefit < before * (1.0 - _ROUNDING):
                raise CheckError(
                    f"{scene.name}: benefit {before:g} with {before_ms:g} ms, {benefit:g} with "
                    f"{budget_ms:g} ms"
                )
            before, before_ms = benefit, budget_ms


def settles(factory: Factory) -> None:
    """After a cut a camera at rest changes nothing once the claimed number of frames is over."""
    claims = require_claim(factory, lambda claims: claims.settles_frames is not None, "rest")
    frames = claims.settles_frames or 0
    rest = max(_REST, min(frames, 5 * _REST))
    for scene in fitting_scenes(factory):
        for share in (0.15, 0.5):
            walk = (*WALK[6:9], *(_SIGHT,) * (frames + rest + 1))
            played = play(factory(), scene, budget_between(scene, share, _SIGHT), walk)
            settled = played[-rest - 1]
            for later in played[-rest:]:
                if (message := difference(settled, later, tolerance=1e-6)) is not None:
                    raise CheckError(f"{message}, {frames} frames after a cut and later")


def hysteresis_holds(factory: Factory) -> None:
    """Nowhere does a step forward, back and forward again switch a node twice.

    What enters or leaves the view on the way is another matter, and such places are passed over.
    """
    require_claim(factory, lambda claims: claims.hysteresis, "hysteresis")
    step_m = 0.05
    places = [camera_at(step_m * k) for k in range(80)]
    for scene in fitting_scenes(factory):
        for share in (0.3, 1.5):
            budget_ms = budget_between(scene, share)
            player = Player(factory(), scene, budget_ms, step_s=0.1)
            here = [player.play(camera) for camera in places[:1] * 30][-1]
            for back, forth in pairwise(places):
                steps = [here, *(player.play(camera) for camera in (forth, back, forth))]
                here = steps[-1]
                if (node := _undone(steps)) is not None:
                    raise CheckError(
                        f"{scene.name}: node {node} switches twice at {back.position_m[1]:g} m"
                    )


def _undone(steps: Sequence[Played]) -> int | None:
    """Return a node of which a change is undone, if the same nodes are in view of all frames."""
    inside = np.array([played.view.state.inside for played in steps])
    if (inside != inside[0]).any():
        return None
    change = np.diff([_shown(played) for played in steps], axis=0)
    undone = (change < 0.0).any(axis=0) & (change > 0.0).any(axis=0) & inside[0]
    return int(undone.argmax()) if undone.any() else None


def _shown(played: Played) -> FloatArray:
    """Return at which detail, or in a tree by a node of which depth, each node is shown, (N,)."""
    scene, drawn = played.view.scene, played.drawn
    if scene.flat:
        shown = np.full(len(scene), -1.0)
        shown[drawn.ids] = drawn.detail
        return shown
    tree = Tree(scene)
    cover = tree.cover(drawn.ids)
    return np.where(cover < 0, -1.0, tree.depth[cover])


def faulty_timings_never_raise_detail(factory: Factory) -> None:
    """Missing, zero and stale reports lead to no more detail than no reports would.

    Reports fail from the first on, or after some good ones; a frame takes a second, so that
    policies that wait have waited.
    """
    of_each_kind = {scene.flat: scene for scene in fitting_scenes(factory)}
    for scene in of_each_kind.values():
        for share in (0.3, 2.0):
            budget_ms = budget_between(scene, share, _SIGHT)
            for good in (0, 4):
                silent = _primitives(factory, scene, budget_ms, _failing(good, lambda _: []))
                for name, fault in _FAULTS.items():
                    got = _primitives(factory, scene, budget_ms, _failing(good, fault))
                    worse = np.flatnonzero(got > silent * (1.0 + _ROUNDING))
                    if len(worse):
                        at = int(worse[0])
                        raise CheckError(
                            f"{scene.name}, frame {at}: {name} reports after {good} good ones "
                            f"raise primitives from {silent[at]:g} to {got[at]:g}"
                        )


def _stale(good: list[float]) -> list[float]:
    return good[-1:] or [0.0]


_FAULTS: dict[str, Callable[[list[float]], list[float]]] = {
    "missing": lambda _: [np.nan],
    "zero": lambda _: [0.0],
    "stale": _stale,
}
"""What a faulty timer says for a frame, from the good reports before it failed."""


def _failing(good: int, fault: Callable[[list[float]], list[float]]) -> Timer:
    """Return a timer that fails after so many good reports."""

    def reports(times_ms: list[float]) -> list[float]:
        known = live(times_ms)[:good]
        return known + fault(known) * (len(times_ms) - len(known))

    return reports


def _primitives(factory: Factory, scene: Scene, budget_ms: float, timer: Timer) -> np.ndarray:
    """Return the primitives drawn in each frame of a camera at rest."""
    player = Player(factory(), scene, budget_ms, timer=timer, step_s=1.0)
    return np.array([player.play(_SIGHT).primitives for _ in range(18)])
