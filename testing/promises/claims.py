"""What policies promise if they claim it, and what none may make of faulty timings."""

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from ...base.arrays import FloatArray
from ...models.machine.cost import CostModel
from ...models.machine.frame_cost import FrameCost
from ...models.machine.hardware import Display, HardwareProfile
from ...models.scene.tree import Tree
from ...sim.accounting.accounting import Accounting
from ..examples.example import Example, Factory, Frame, play_fresh
from ..examples.fixed_examples import SIGHT, coarsest
from ..examples.walks import BACK_AND_FORTH, BUDGETS, CUT, growing, long_rest, slow_frames, walks
from .agreement import SAME_DETAIL, difference
from .promise import Failure, promise
from .watchers import FAULTS, faulty_timer

_ROUNDING = 1e-9  # relative
_CHANGES_UNTIL_STUCK = 2  # as `policies.shared.times.reports` has it
_HIDDEN = 0.01  # as there
_EPSILON = 1e-6  # share of its benefit that a frame may lose with more budget


@promise(slow_frames)
def faulty_timings_never_raise_detail(
    factory: Factory, example: Example, _rest: int
) -> Failure | None:
    """Missing and zero reports lead to no more detail than no reports would.

    A stale one may be honest until what is drawn has changed under it twice: what rises after that
    has been seen, by frames that were in flight then, is one rise too many.
    """
    rises = _CHANGES_UNTIL_STUCK + example.hardware.frames_in_flight
    for good in (0, 4):  # the first reports already fail, or some good ones come before
        primitives: dict[str, FloatArray] = {}
        for name, fault in FAULTS.items():
            if name == "stale" and not good:
                continue  # there is nothing to repeat
            played = example.play(factory(), faulty_timer(good, fault))
            if not played.notes.looks_at_timings():
                return None
            share = np.array([frame.selection.render_scale for frame in played.frames]) ** 2
            primitives[name] = share * (played.log["triangles"] + played.log["splats"])
            worse = primitives[name] > primitives["silent"] * (1.0 + _ROUNDING)
            if name == "stale":
                worse = _rises(primitives[name], primitives["silent"]) > rises
            if worse.any():
                at = int(worse.argmax())
                return Failure(
                    f"frame {at}: {name} reports after {good} good ones raise primitives from "
                    f"{primitives['silent'][at]:g} to {primitives[name][at]:g}",
                )
    return None


def _rises(primitives: FloatArray, silent: FloatArray) -> FloatArray:
    """Return how often each frame and those before rose by what no timer can hide, (n,)."""
    level, count, counts = 0.0, 0, list[float]()
    for drawn, without in zip(primitives.tolist(), silent.tolist(), strict=True):
        if drawn > (1.0 + _HIDDEN) * max(level, without):
            level, count = drawn, count + 1
        counts.append(count)
    return np.array(counts)


@promise(walks(*BUDGETS), "budget")
def budget_is_kept(factory: Factory, example: Example, _rest: int) -> Failure | None:
    """With true costs no frame takes, or is predicted to take, longer than the budget.

    Unless the coarsest selection does.
    """
    played = play_fresh(factory, example)
    spent, predicted = played.log["model_gpu_ms"], played.log["predicted_gpu_ms"]
    least = _least_ms(played.frames, example.hardware.gpu) * (1.0 + _ROUNDING)
    allowed = np.maximum(example.budget_ms * (1.0 + _ROUNDING), least)
    over = np.flatnonzero((spent > allowed) | ((predicted > allowed) & (spent > least)))
    if not len(over):
        return None
    at = int(over[0])
    return Failure(
        f"frame {at}: expected at most {allowed[at]:.4g} ms, predicted {predicted[at]:.4g}, drew "
        f"{spent[at]:.4g}",
    )


@promise(walks(*BUDGETS, poses=(SIGHT,), mode="immediate"), "budget")
def lag_is_bounded(factory: Factory, example: Example, _rest: int) -> Failure | None:
    """No frame is shown later than the frames in flight allow when each keeps the budget."""
    played = play_fresh(factory, example)
    log, machine = played.log, example.hardware
    least = _least_ms(played.frames, machine.gpu).max(initial=0.0)
    longest_ms = max(example.budget_ms, least, float(log["cpu_ms"].max()))
    bound_ms = _frames_ahead(machine) * (longest_ms + _refresh_ms(machine.display))
    shown = log["display_ns"] >= 0
    lag_ms = np.where(shown, (log["display_ns"] - log["input_ns"]) * 1e-6, 0.0)
    late = np.flatnonzero(lag_ms > bound_ms * (1.0 + _ROUNDING))
    if not len(late):
        return None
    frame = int(late[0])
    return Failure(
        f"frame {frame} is shown {lag_ms[frame]:.4g} ms after its input; within the budget it "
        f"would be {bound_ms:.4g} ms at most",
    )


def _least_ms(frames: list[Frame], costs: CostModel) -> np.ndarray:
    """Return the noise-free GPU time of the coarsest selection of each frame, (n,)."""
    if not frames:
        return np.zeros(0)
    first = frames[0].view
    accounting = Accounting(
        first.scene, FrameCost(costs, first.scene.types.levels), 0, first.camera, visible_px=1.0
    )
    tallies = [accounting.tally(0, accounting.drawn(coarsest(f.view), f.view)) for f in frames]
    return np.array([tally.gpu_ms for tally in tallies])


def _frames_ahead(machine: HardwareProfile) -> int:
    """Return the frames, itself included, that a frame may have to wait for.

    Those in flight, and with a refresh those in the swapchain that wait to be shown.
    """
    immediate = machine.display.mode == "immediate"
    return machine.frames_in_flight + (1 if immediate else machine.display.images)


def _refresh_ms(display: Display) -> float:
    """Return how long a finished frame may wait for the screen."""
    if display.mode == "immediate":
        return 0.0
    return 1e3 / (display.vrr_min_hz if display.mode == "vrr" else display.refresh_hz)


@promise(walks(0.15, poses=(SIGHT,), frames=lambda rest: rest + 10), "settles_frames")
def nothing_toggles_at_rest(factory: Factory, example: Example, rest: int) -> Failure | None:
    """Where nothing moves nothing changes, once the policy has had its frames to come to rest."""
    return _last_change(factory, example, rest)


@promise(walks(0.5, poses=CUT, frames=long_rest), "settles_frames")
def load_steps_settle(factory: Factory, example: Example, rest: int) -> Failure | None:
    """After a cut to the whole scene the policy comes to rest in its frames."""
    return _last_change(factory, example, rest)


def _last_change(factory: Factory, example: Example, rest: int) -> Failure | None:
    """Return what changes so many frames after the last change of what is to be seen."""
    played = play_fresh(factory, example)
    settled = played.last_change() + rest
    for frame in range(settled + 1, len(played.frames)):
        one, other = played.frames[settled], played.frames[frame]
        message = difference(one, other, tolerance=SAME_DETAIL)
        if message is not None:
            since = f"{rest} frames after a cut and later" if rest else "at rest"
            where = f"from frame {settled} to {frame}, {since}, {message}"
            return Failure(where)
    return None


@promise(growing, "monotone")
def more_budget_is_never_worse(
    factory: Factory, pair: tuple[Example, Example], _rest: int
) -> Failure | None:
    """In a frame at rest more budget does not lower the benefit by more than a millionth."""
    less, more = (float(play_fresh(factory, x).log["benefit"][-1]) for x in pair)
    if more >= less * (1.0 - _EPSILON):
        return None
    poor, rich = pair
    return Failure(
        f"benefit {less:.6g} with {poor.budget_ms:.4g} ms, {more:.6g} with {rich.budget_ms:.4g} ms",
        (("less", poor), ("more", rich)),
    )


@promise(walks(0.3, poses=BACK_AND_FORTH, refresh_hz=10.0), "hysteresis")
def hysteresis_holds(factory: Factory, example: Example, _rest: int) -> Failure | None:
    """Nowhere does a step forward, back and forward again switch a node twice.

    What enters or leaves the view on the way is another matter, and such places are passed over.
    """
    frames = play_fresh(factory, example).frames
    # The last frame at each pose, so that it does not matter how long the camera stands there.
    steps = [list(stay)[-1] for _, stay in groupby(frames, lambda frame: frame.pose)]
    for at in range(len(steps) - 3):
        back, forth, again, end = (frame.pose for frame in steps[at : at + 4])
        if back == again and forth == end:
            node = _undone(steps[at : at + 4])
            if node is not None:
                where = ", ".join(f"{x:g}" for x in back[:3])
                return Failure(f"node {node} switches twice at ({where}) m")
    return None


def _undone(steps: Sequence[Frame]) -> int | None:
    """Return a node of which a change is undone, if the same nodes are in view of all frames."""
    inside = np.array([frame.view.state.inside for frame in steps])
    if (inside != inside[0]).any():
        return None
    change = np.diff([_shown(frame) for frame in steps], axis=0)
    undone = (change < 0.0).any(axis=0) & (change > 0.0).any(axis=0) & inside[0]
    return int(undone.argmax()) if undone.any() else None


def _shown(frame: Frame) -> FloatArray:
    """Return at which detail, or in a tree by a node of which depth, each node is shown, (N,)."""
    scene, drawn = frame.view.scene, frame.drawn
    if scene.flat:
        shown = np.full(len(scene), -1.0)
        shown[drawn.ids] = drawn.detail
        return shown
    tree = Tree(scene)
    cover = tree.cover(drawn.ids)
    return np.where(cover < 0, -1.0, tree.depth[cover])
