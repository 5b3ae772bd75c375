"""Checks that a policy decides by what it is shown and by nothing else."""

import pickle
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ...base.errors import InputError
from ...policies.protocol import Policy
from ...policies.registry import parameters, parse_policy
from ...policies.view import View
from .check_scenes import renumbered
from .driver import CheckError, Played, Player
from .walks import WALK, Factory, budget_between, difference, fitting_scenes, play

_TIGHT = 0.4  # of the way from the coarsest to full detail


def _require_same(ones: list[Played], others: list[Played], *, tolerance: float = 0.0) -> None:
    for one, other in zip(ones, others, strict=True):
        if (message := difference(one, other, tolerance=tolerance)) is not None:
            raise CheckError(message)


def two_instances_agree(factory: Factory) -> None:
    """Two instances decide alike: nothing is left to chance, to a clock or to the class."""
    for scene in fitting_scenes(factory):
        budget_ms = budget_between(scene, _TIGHT)
        one, other = factory(), factory()
        _require_same(play(one, scene, budget_ms), play(other, scene, budget_ms))


def reset_forgets(factory: Factory) -> None:
    """After a reset a second run equals the first, and what was played before leaves no trace."""
    policy = factory()
    chosen = list(fitting_scenes(factory))
    for scene, before in zip(chosen, (*chosen[1:], chosen[0]), strict=True):
        budget_ms = budget_between(scene, _TIGHT)
        first = play(factory(), scene, budget_ms)
        play(policy, before, 0.5 * budget_ms, WALK[::-1])
        _require_same(first, play(policy, scene, budget_ms))


def leaves_the_view_alone(factory: Factory) -> None:
    """Nothing of the view is written to, the policy's own previous selection included."""
    for scene in fitting_scenes(factory):
        player = Player(factory(), scene, budget_between(scene, _TIGHT))
        for camera in WALK:
            view = player.show(camera)
            before = _contents(view)
            copies = {name: array.copy() for name, array in before.items()}
            selection = player.ask(view)
            for name, array in _contents(view).items():
                same = array is before[name] or name.startswith("completed")
                if not (same and np.array_equal(array, copies[name], equal_nan=True)):
                    raise CheckError(f"{scene.name}, frame {view.frame}: {name} was changed")
            player.finish(view, selection)


def _contents(view: View) -> Mapping[str, np.ndarray]:
    """Return the arrays that a view is made of."""
    state = view.state
    found = {
        "ids": view.ids,
        "xyz_m": view.xyz_m,
        "centers_m": state.centers_m,
        "last_detail": state.last_detail,
        "inside": state.inside,
        "completed.work_ms": state.completed.work_ms,
        "completed.gpu_ms": state.completed.gpu_ms,
    }
    if state.previous is not None:
        found |= {"previous.ids": state.previous.ids, "previous.detail": state.previous.detail}
    return found


def renumbering_permutes(factory: Factory) -> None:
    """With the nodes in another order the same ones are drawn at the same detail."""
    for scene in fitting_scenes(factory):
        other, number = renumbered(scene, np.random.default_rng(7))
        old = np.argsort(number).astype(np.int32)
        budget_ms = budget_between(scene, _TIGHT)
        here, there = play(factory(), scene, budget_ms), play(factory(), other, budget_ms)
        _require_same(here, [_named(played, old) for played in there], tolerance=1e-6)


def _named(played: Played, names: np.ndarray) -> Played:
    """Return a frame whose drawn nodes go by other names."""
    return replace(played, drawn=replace(played.drawn, ids=names[played.drawn.ids]))


def pickles(factory: Factory) -> None:
    """Sent to another process, a policy decides like one that has not been."""
    scene = next(fitting_scenes(factory))
    budget_ms = budget_between(scene, _TIGHT)
    try:
        sent: Policy = pickle.loads(pickle.dumps(factory()))  # noqa: S301 - just made
    except Exception as error:
        raise CheckError(f"{type(error).__name__}: {error}") from error
    _require_same(play(factory(), scene, budget_ms), play(sent, scene, budget_ms))


def parameters_round_trip(factory: Factory) -> None:
    """Parameters are stored as given, and a name made of them makes a policy that equals this one.

    Equal in representation too, where a class defines these two.
    """
    policy = factory()
    given = _parameters(policy)
    try:
        made = parse_policy(_spec(policy, given)).make()
    except InputError as error:
        raise CheckError(str(error)) from error
    if _parameters(made) != given:
        raise CheckError(f"parameters {given} come back as {_parameters(made)}")
    cls = type(policy)
    try:
        equal = cls.__eq__ is object.__eq__ or policy == made
        equal &= cls.__repr__ is object.__repr__ or repr(policy) == repr(made)
    except AttributeError as error:
        raise CheckError(f"equality or representation needs a reset: {error}") from error
    if not equal:
        raise CheckError(f"{given} do not make an equal policy: {policy!r} and {made!r}")


def _parameters(policy: Policy) -> dict[str, object]:
    missing = object()
    names = [parameter.name for parameter in parameters(type(policy))]
    values = {name: getattr(policy, name, missing) for name in names}
    lost = [name for name, value in values.items() if value is missing]
    if lost:
        raise CheckError(f"parameter {lost[0]} is not stored under its name")
    return values


def _spec(policy: Policy, given: Mapping[str, object]) -> str:
    """Return the name of a policy on a command line."""
    words = {True: "on", False: "off", None: "none"}
    texts = [
        f"{name}={words[value] if value is None or isinstance(value, bool) else value}"
        for name, value in given.items()
    ]
    cls = type(policy)
    name = f"{cls.__module__}:{cls.__qualname__}"
    return f"{name}:{','.join(texts)}" if texts else name
