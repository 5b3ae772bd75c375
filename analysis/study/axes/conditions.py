"""Axes of a study's conditions: replay options, the display, and draws of the machine."""

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, fields
from typing import Any, cast

import numpy as np

from ....base.errors import InputError, require_whole
from ....models.machine.hardware import HardwareProfile
from ....models.scene.rig import Eyes
from ....sim.machine.faults import Faults
from ....sim.replay import ReplayOptions
from ..runs import choose_draws
from .grid import Axis, Cell, Exclusions

DEFAULTS: dict[str, Any] = {
    item.name: item.default if item.default_factory is MISSING else item.default_factory()
    for item in fields(ReplayOptions)
    if item.name != "frames"  # a run ends with its path, so that all policies see the same
} | {"budget_ms": None, "fovy_deg": None}
"""What a replay has unless a study says otherwise.

A budget of None is one refresh, a field of view of None what the path states, or the usual one.
"""

MACHINE = ("display", "refresh_hz", "frames_in_flight", "pacing", "latency_limit")
"""What may be otherwise than a profile has it; None leaves it."""


def several(given: Any) -> tuple[Any, ...]:
    """Return one value or a sequence of them as a tuple."""
    if isinstance(given, np.ndarray):
        return tuple(cast("list[Any]", given.tolist()))
    many = isinstance(given, (list, tuple, range))
    return tuple(cast("Sequence[Any]", given)) if many else (given,)


def option_axis(name: str, given: Any) -> Axis:
    """Return an axis of a replay option; raises `InputError` as `ReplayOptions` does."""
    values = several(given)
    for value in values:
        if value is not None or name not in {"budget_ms", "fovy_deg", "seed"}:
            checked: dict[str, Any] = {"budget_ms": 1.0, name: value}
            ReplayOptions(**checked)
    return Axis(name, values, tuple(map(_cell, values)))


def machine_axes(*given: Any) -> tuple[Axis, ...]:
    """Return the axes of `MACHINE`, in their order."""
    axes = zip(MACHINE, map(several, given), strict=True)
    return tuple(Axis(name, values, values) for name, values in axes)


def named_axis(name: str, given: Any) -> Axis:
    """Return an axis of things that have names, or of a mapping of names to things."""
    if isinstance(given, Mapping):
        named = cast("Mapping[str, Any]", given)
        return Axis(name, tuple(named.values()), tuple(named))
    values = several(given)
    return Axis(name, values, tuple(map(_name_of, values)))


def draw_axis(
    draws: int | Iterable[int | None], profiles: Mapping[str, HardwareProfile]
) -> tuple[Axis, Exclusions]:
    """Return the axis of draws of the machine, and the draws that each profile leaves out.

    Raises `InputError` if a profile has no such draw.

    Parameters
    ----------
    draws
        Draws, None for the mean; or a number of them, spread over those of each profile.
    profiles
        By what the axis of hardware calls them.
    """
    if isinstance(draws, int):
        require_whole(draws, "draws", 0)
        chosen = {key: choose_draws(item, draws) or [None] for key, item in profiles.items()}
    else:
        chosen = {key: list(several(draws)) for key in profiles}
    for key, some in chosen.items():
        for draw in some:
            profiles[key].truth(draw)
    values = tuple(dict.fromkeys(draw for some in chosen.values() for draw in some))
    values = tuple(sorted(values, key=lambda draw: -1 if draw is None else draw))
    left_out = {key: [draw for draw in values if draw not in chosen[key]] for key in profiles}
    exclusions = [{"hardware": (key,), "draw": some} for key, some in left_out.items() if some]
    return Axis("draw", values, values), exclusions


def _name_of(thing: Any) -> str:
    """Return the text that names a thing, or the name that a loaded one has."""
    if isinstance(thing, (str, os.PathLike)):
        return os.fsdecode(cast("str | os.PathLike[str]", thing))
    name: object = getattr(thing, "name", None)
    if not isinstance(name, str):
        raise InputError(f"study: expected a name, a path or a thing that has one, got {thing!r}")
    return name


def _cell(value: Any) -> Cell:
    """Return what results say of a value."""
    if isinstance(value, Faults):
        return _text(value)
    return str(value) if isinstance(value, Eyes) else value


def _text(faults: Faults) -> str:
    """Return faults as a command line names them."""
    changed = [item for item in fields(faults) if getattr(faults, item.name) != item.default]
    return ",".join(f"{item.name}={getattr(faults, item.name):g}" for item in changed) or "none"
