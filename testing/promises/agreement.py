"""What every policy promises: it plays, and it decides by what it is shown and nothing else."""

import pickle
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from ...base.errors import InputError
from ...base.foreign_text import describe_error
from ...policies.registry import parameters, parse_policy
from ...policies.selection import Selection
from ..examples.example import Example, Factory, Frame, Played, play_fresh
from ..examples.fixed_examples import NEXT_TO_NOTHING, PLENTY, TIGHT
from ..examples.small_scenes import renumbered
from ..examples.walks import EMPTY_WALK, LONE_WALK, after_another, first_walk, shuffled, walks
from .promise import Failure, promise
from .watchers import AllResident, Guarded, Unstreamed

SAME_DETAIL = 1e-6
"""Two resolutions that differ by less are the same where costs were added in another order."""


def difference(one: Frame, other: Frame, *, tolerance: float = 0.0) -> str | None:
    """Return how two selections differ, or None.

    With a tolerance only what is drawn counts, and resolutions may differ by so much.
    """
    if tolerance:
        a, b = one.drawn, other.drawn
    else:
        a, b = _ascending(one.selection), _ascending(other.selection)
    if not np.array_equal(a.ids, b.ids):
        odd = np.setxor1d(a.ids, b.ids)
        return f"node {odd[0]} is drawn in only one of two, of {len(a.ids)} and {len(b.ids)} nodes"
    off = np.abs(a.detail - b.detail) > tolerance
    if off.any():
        at = int(off.argmax())
        return f"node {a.ids[at]} has detail {a.detail[at]:g} and {b.detail[at]:g}"
    if abs(a.render_scale - b.render_scale) > tolerance:
        return f"render scale {a.render_scale:g} and {b.render_scale:g}"
    if not tolerance and (a.work, str(a.predicted_ms)) != (b.work, str(b.predicted_ms)):
        return f"{a.work}, {a.predicted_ms} ms and {b.work}, {b.predicted_ms} ms"
    return None


def _ascending(selection: Selection) -> Selection:
    order = np.argsort(selection.ids)
    return replace(selection, ids=selection.ids[order], detail=selection.detail[order])


def _compare(
    ones: Sequence[Frame],
    others: Sequence[Frame],
    where: str,
    runs: tuple[tuple[str, Example], ...] = (),
    tolerance: float = 0.0,
) -> Failure | None:
    """Return the first frame in which two replays differ."""
    for frame, (one, other) in enumerate(zip(ones, others, strict=True)):
        message = difference(one, other, tolerance=tolerance)
        if message is not None:
            return Failure(f"frame {frame}{where}: {message}", runs)
    return None


@promise(walks(TIGHT, PLENTY))
def valid_selections(factory: Factory, example: Example, _rest: int) -> None:
    """Every selection of a walk with cuts is valid, with a little budget and with plenty."""
    play_fresh(factory, example)


@promise(walks(TIGHT, poses=EMPTY_WALK))
def empty_frames(factory: Factory, example: Example, _rest: int) -> None:
    """Frames without candidates play, in the beginning or between others."""
    play_fresh(factory, example)


@promise(walks(TIGHT, PLENTY, poses=LONE_WALK, lone=True))
def one_object(factory: Factory, example: Example, _rest: int) -> None:
    """Scenes of a single object play, in view and out of it."""
    play_fresh(factory, example)


@promise(walks(NEXT_TO_NOTHING))
def next_to_no_budget(factory: Factory, example: Example, _rest: int) -> None:
    """Budgets of a nanosecond play; one of 0 is refused before a policy hears of it."""
    play_fresh(factory, example)


@promise(walks(PLENTY, memory_share=0.4), needs_loader=True)
def draws_what_is_resident(factory: Factory, example: Example, _rest: int) -> None:
    """Nothing is drawn whose data are not in memory, by a policy that needs a loader."""
    play_fresh(factory, example)


@lru_cache(maxsize=16)
def _play_guarded(factory: Factory, example: Example) -> Played[Guarded]:
    """Replay an example under another instance, of which is noted what it changes."""
    return example.play(factory(), Guarded)


@promise(walks(TIGHT))
def two_instances_agree(factory: Factory, example: Example, _rest: int) -> Failure | None:
    """Two instances decide alike: nothing is left to chance, to a clock or to the class."""
    first, second = play_fresh(factory, example), _play_guarded(factory, example)
    where = " of a second instance"
    return _compare(first.frames, second.frames, where)


@promise(after_another)
def reset_forgets(factory: Factory, pair: tuple[Example, Example], _rest: int) -> Failure | None:
    """Repeat a run after a reset, and both are equal whatever was played before."""
    before, example = pair
    policy = factory()
    earlier = before.play(policy)
    first = earlier if before is example else play_fresh(factory, example)
    second = example.play(policy)
    where = " of a second run after reset"
    return _compare(first.frames, second.frames, where, (("example", example),))


@promise(walks(TIGHT))
def leaves_the_view_alone(factory: Factory, example: Example, _rest: int) -> Failure | None:
    """Nothing of the view is written to, the policy's own previous selection included."""
    changed = _play_guarded(factory, example).notes.changed
    if not changed:
        return None
    frame, name = changed[0]
    return Failure(f"frame {frame}: {name} was changed")


@promise(walks(TIGHT))
def everything_resident(factory: Factory, example: Example, _rest: int) -> Failure | None:
    """Where all nodes are in memory a policy decides as if nothing was streamed."""
    streams = factory().capabilities.loader
    plain = example.play(factory(), Unstreamed) if streams else play_fresh(factory, example)
    resident = example.play(factory(), AllResident)
    where = " with everything in memory"
    return _compare(plain.frames, resident.frames, where)


@promise(shuffled)
def order_does_not_matter(
    factory: Factory, drawn: tuple[Example, int], _rest: int
) -> Failure | None:
    """With the objects in another order the same ones are drawn at the same detail."""
    example, seed = drawn
    scene, old = renumbered(example.scene, seed)
    other = replace(example, scene=scene)
    here, there = play_fresh(factory, example), other.play(factory())
    renamed = [_renamed(frame, old) for frame in there.frames]
    runs = (("example", example), ("renumbered", other))
    where = " with the same nodes in another order"
    return _compare(here.frames, renamed, where, runs, SAME_DETAIL)


def _renamed(frame: Frame, names: np.ndarray) -> Frame:
    """Return what is drawn in a frame under other names, as a frame in which nothing is culled."""
    view, drawn = frame.view, frame.drawn
    everything = replace(view.state, inside=np.ones(len(names), dtype=np.bool_))
    seen = type(view)(everything, view.ids, view.xyz_m)
    return Frame(seen, replace(drawn, ids=names[drawn.ids]))


@promise(first_walk)
def pickles(factory: Factory, example: Example, _rest: int) -> Failure | None:
    """Sent to another process, a policy decides like one that has not been."""
    try:
        sent: Any = pickle.loads(pickle.dumps(factory()))  # noqa: S301 - just made
    except Exception as error:  # noqa: BLE001 - a user's class may raise anything
        return Failure(describe_error(error), cause=error)
    here, there = play_fresh(factory, example), example.play(sent)
    return _compare(here.frames, there.frames, " once sent")


@promise(lambda _policy, _rest: ((),))
def parameters_round_trip(factory: Factory, _example: object, _rest: int) -> Failure | None:
    """Parameters are stored as given; a policy made of them, or named by them, has the same."""
    # They are compared alone: what else a policy holds, such as arrays, is its own business.
    policy = factory()
    cls = type(policy)
    names = [parameter.name for parameter in parameters(cls)]
    lost = [name for name in names if not hasattr(policy, name)]
    if lost:
        return Failure(f"parameter {lost[0]} is not stored under its name")
    given = {name: getattr(policy, name) for name in names}
    try:
        copies = [cls(**given)]
        if all(isinstance(value, str | int | float | None) for value in given.values()):
            copies.append(parse_policy(_spec(cls, given)).make())
        for made in copies:
            back = {name: getattr(made, name) for name in names}
            if not all(_same(given[name], back[name]) for name in names):
                return Failure(f"parameters {given} come back as {back}")
            if cls.__repr__ is not object.__repr__ and repr(policy) != repr(made):
                return Failure(f"{given} do not make an equal policy: {policy!r} and {made!r}")
    except InputError as error:
        return Failure(str(error))
    except AttributeError as error:
        return Failure(f"equality or representation needs a reset: {error}", cause=error)
    return None


def _same(one: object, other: object) -> bool:
    """Return whether two values are equal, arrays by what they hold."""
    return type(one) is type(other) and np.array_equal(np.asarray(one), np.asarray(other))


def _spec(cls: type[Any], given: dict[str, Any]) -> str:
    """Return what a command line calls a class with these parameters."""
    words = {True: "on", False: "off", None: "none"}
    texts = [
        f"{name}={words[value] if value is None or isinstance(value, bool) else value}"
        for name, value in given.items()
    ]
    name = f"{cls.__module__}:{cls.__qualname__}"
    return f"{name}:{','.join(texts)}" if texts else name
