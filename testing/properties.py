"""Ready properties of policies.

Each is called with what makes a policy, such as its class, and raises with the smallest example
that it finds.  All worlds are without noise, so that what fails is the policy.
"""

from dataclasses import replace

import numpy as np
from hypothesis import strategies as st

from ..models.machine.hardware import Display, HardwareProfile
from ..policies.protocol import Capabilities
from .checks.check_scenes import renumbered
from .example import Example, Factory, Played
from .failure import Failure
from .property import Property
from .worlds import load_steps, still_worlds, worlds

_ROUNDING = 1e-9
_SAME_DETAIL = 1e-6
_EPSILON = 1e-6  # share of its benefit that a frame may lose with more budget


def _moving(capabilities: Capabilities, _rest: int) -> st.SearchStrategy[Example]:
    return worlds(capabilities)


def _resting(capabilities: Capabilities, rest: int) -> st.SearchStrategy[Example]:
    return still_worlds(capabilities, st.integers(rest + 2, rest + 6))


def _stepping(capabilities: Capabilities, rest: int) -> st.SearchStrategy[Example]:
    return load_steps(capabilities, st.integers(rest + 3, rest + 6))


def _growing(capabilities: Capabilities, rest: int) -> st.SearchStrategy[tuple[Example, float]]:
    return st.tuples(
        still_worlds(capabilities, st.just(rest + 1)), st.sampled_from((1.1, 1.5, 2.0, 4.0))
    )


def _shuffled(capabilities: Capabilities, _rest: int) -> st.SearchStrategy[tuple[Example, int]]:
    return st.tuples(worlds(capabilities), st.integers(0, 20))


def _judge_budget(factory: Factory, example: Example, _rest: int) -> Failure | None:
    played = example.play(factory())
    spent = played.log["model_gpu_ms"]
    allowed = np.maximum(example.budget_ms, played.least_ms) * (1.0 + _ROUNDING)
    over = np.flatnonzero(spent > allowed)
    if not len(over):
        return None
    frame = int(over[0])
    return Failure(
        f"frame {frame} takes {spent[frame]:.4g} ms, at most {allowed[frame]:.4g} ms are allowed",
        (("example", example),),
    )


def _judge_lag(factory: Factory, example: Example, _rest: int) -> Failure | None:
    played = example.play(factory())
    log, machine = played.log, example.hardware
    longest_ms = max(example.budget_ms, *played.least_ms, *log["cpu_ms"].tolist())
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
        (("example", example),),
    )


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


def _judge_rest(factory: Factory, example: Example, rest: int) -> Failure | None:
    return _judge_change(example, example.play(factory()), 0, rest)


def _judge_step(factory: Factory, example: Example, rest: int) -> Failure | None:
    return _judge_change(example, example.play(factory()), 1, rest)


def _judge_change(example: Example, played: Played, start: int, rest: int) -> Failure | None:
    """Return where a frame differs from the one in which a policy has to be at rest.

    What arrives from disk is a change too, after which the frames to rest begin again.
    """
    settled = max(start, *played.arrivals, 0) + rest
    for frame in range(settled + 1, len(played.detail)):
        message = _difference(played.detail[settled], played.detail[frame])
        if message is not None:
            since = f"{rest} frames after everything came to rest" if rest else "at rest"
            where = f"from frame {settled} to {frame}, {since}, {message}"
            return Failure(where, (("example", example),))
    return None


def _judge_growth(factory: Factory, drawn: tuple[Example, float], _rest: int) -> Failure | None:
    example, factor = drawn
    larger = replace(example, budget_ms=factor * example.budget_ms)
    less, more = (float(x.play(factory()).log["benefit"][-1]) for x in (example, larger))
    if more >= less * (1.0 - _EPSILON):
        return None
    return Failure(
        f"benefit {less:.6g} with {example.budget_ms:.4g} ms, {more:.6g} with "
        f"{larger.budget_ms:.4g} ms",
        (("less", example), ("more", larger)),
    )


def _judge_order(factory: Factory, drawn: tuple[Example, int], _rest: int) -> Failure | None:
    example, seed = drawn
    scene, number = renumbered(example.scene, np.random.default_rng(seed))
    other = replace(example, scene=scene)
    here, there = example.play(factory()), other.play(factory())
    names = dict(zip(number.tolist(), range(len(number)), strict=True))
    for frame, (one, two) in enumerate(zip(here.detail, there.detail, strict=True)):
        renamed = {names[node]: detail for node, detail in two.items()}
        message = _difference(one, renamed)
        if message is not None:
            return Failure(
                f"frame {frame} with the same nodes in another order: {message}",
                (("example", example), ("renumbered", other)),
            )
    return None


def _judge_reset(factory: Factory, example: Example, _rest: int) -> Failure | None:
    policy = factory()
    first, second = example.play(policy), example.play(policy)
    for frame, (one, two) in enumerate(zip(first.detail, second.detail, strict=True)):
        message = _difference(one, two, tolerance=0.0)
        if message is not None:
            return Failure(
                f"frame {frame} of a second run after reset: {message}", (("example", example),)
            )
    return None


def _difference(
    one: dict[int, float], two: dict[int, float], *, tolerance: float = _SAME_DETAIL
) -> str | None:
    """Return how two frames differ, by the first node that does."""
    for node in sorted(one.keys() | two.keys()):
        before, after = one.get(node), two.get(node)
        if before is None or after is None:
            return f"node {node} is drawn in one and not in the other"
        if abs(before - after) > tolerance:
            return f"node {node} goes from detail {before:g} to {after:g}"
    return None


budget_is_kept = Property(
    "budget_is_kept",
    "With true costs no frame takes longer than the budget, or than the coarsest selection.",
    _moving,
    _judge_budget,
    lambda claims: claims.budget,
)
lag_is_bounded = Property(
    "lag_is_bounded",
    "No frame is shown later than the frames in flight allow when each keeps the budget.",
    _moving,
    _judge_lag,
    lambda claims: claims.budget,
)
nothing_toggles_at_rest = Property(
    "nothing_toggles_at_rest",
    "Where nothing moves nothing changes, once the policy has had its frames to come to rest.",
    _resting,
    _judge_rest,
    lambda claims: claims.settles_frames is not None,
)
load_steps_settle = Property(
    "load_steps_settle",
    "After a cut from nothing to the whole scene the policy comes to rest in its frames.",
    _stepping,
    _judge_step,
    lambda claims: claims.settles_frames is not None,
)
more_budget_is_never_worse = Property(
    "more_budget_is_never_worse",
    "In a frame at rest more budget does not lower the benefit by more than a millionth.",
    _growing,
    _judge_growth,
    lambda claims: claims.monotone,
)
order_does_not_matter = Property(
    "order_does_not_matter",
    "With the objects in another order the same ones are drawn at the same detail.",
    _shuffled,
    _judge_order,
    lambda _claims: True,
)
reset_forgets = Property(
    "reset_forgets",
    "A second run after a reset equals the first.",
    _moving,
    _judge_reset,
    lambda _claims: True,
)

PROPERTIES = (
    budget_is_kept,
    lag_is_bounded,
    nothing_toggles_at_rest,
    load_steps_settle,
    more_budget_is_never_worse,
    order_does_not_matter,
    reset_forgets,
)
"""All properties, in the order in which tests run them."""
