"""Paths by name, pattern, file or kind: what is replayed where one path does not do."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from ...base.errors import InputError, is_file, require_whole, text_of
from ...models.scene.scene import Scene
from ...traces.cameras.camera_trace import CameraTrace
from ...traces.cameras.generators.generate import KINDS
from ...traces.cameras.read_trace import split_spec
from ...traces.cameras.shared_screen import MOST_PLAYERS, together
from .inputs import TraceLike, load_trace, made_length_s
from .stages import find_stage

MOST_PATHS = 10_000
"""Paths of one kind; their seeds are that many apart."""

_MAGIC = "*?["

Seconds: TypeAlias = tuple[float, float | None]
"""From and to, on the clock of a path; None for its end."""


def load_paths(
    traces: Sequence[TraceLike],
    scene: Scene,
    place: str = "shrink",
    *,
    paths: int = 1,
    length_s: float | None = None,
    seconds: Seconds | None = None,
    seed: int = 0,
    players: int = 1,
) -> tuple[CameraTrace, ...]:
    """Return the paths of traces, each placed in a scene and cut, with names that differ.

    A kind of movement makes as many paths as are asked for, of other routes, speeds and gazes; more
    paths of one seed begin with the same ones.  The bundled trace, a file and a trace are one path
    each.  A pattern stands for the files that match it, in the order of their names.  What is
    named twice is replayed once.

    Raises `InputError` if there is no trace, a pattern matches nothing, a number is out of range, a
    path has no such seconds, or a trace cannot be loaded or placed.

    Parameters
    ----------
    place
        As `load_trace` takes it.
    paths
        Of each kind of movement, 1 to `MOST_PATHS`.
    length_s
        Of the paths of a kind, whose parts scale with it; None for the kind's own.
    seconds
        The stretch of each path that is kept; None for all of it.
    players
        How many share a screen: so many paths after each other are one.
    """
    require_whole(paths, "paths", 1)
    require_whole(seed, "seed", 0)
    if paths > MOST_PATHS:
        raise InputError(f"paths: expected at most {MOST_PATHS} of a kind, got {paths}; ask fewer")
    if not traces:
        raise InputError("traces: expected a name, a file or a kind, got none; name one")
    found: list[CameraTrace] = []
    for trace in _each_once(traces):
        if isinstance(trace, str) and trace in KINDS:
            length = made_length_s(trace) if length_s is None else length_s
            found += _of_kind(trace, scene, paths, length, seed)
        else:
            found.append(load_trace(trace, scene, place))
    if seconds is not None:
        found = [path.stretch(*seconds) for path in found]
    return tuple(_named_apart(_shared(found, players)))


def _shared(paths: list[CameraTrace], players: int) -> list[CameraTrace]:
    """Return what is replayed where so many players share a screen."""
    require_whole(players, "players", 1)
    if len(paths) % players or players > MOST_PLAYERS:
        raise InputError(
            f"players: expected 1 to {MOST_PLAYERS}, and paths for all of them, got {players} "
            f"and {len(paths)} paths; name a path for each player, or ask for a multiple with paths"
        )
    return [together(paths[at : at + players]) for at in range(0, len(paths), players)]


def _each_once(traces: Sequence[TraceLike]) -> list[TraceLike]:
    """Return what is named, patterns as the files that they match, without repeats."""
    kept: list[TraceLike] = []
    for trace in traces:
        for one in (
            [trace]
            if isinstance(trace, CameraTrace)
            else _expand(text_of(trace, "trace", CameraTrace))
        ):
            # Traces are told apart by identity, names by what they say.
            if not any(one is other or (isinstance(one, str) and one == other) for other in kept):
                kept.append(one)
    return kept


def _expand(spec: str) -> Iterator[str]:
    """Yield the specs of the files that a pattern matches, or the spec itself if it is none."""
    path, selector = split_spec(spec)
    if not set(_MAGIC) & set(str(path)) or is_file(path):
        yield spec
        return
    root = Path(path.anchor)
    found = sorted(str(name) for name in root.glob(str(path.relative_to(root))) if is_file(name))
    if not found:
        raise InputError(f"trace: expected files that match {path}, got none; correct the pattern")
    yield from (name if selector is None else f"{name}#{selector}" for name in found)


def _of_kind(kind: str, scene: Scene, count: int, length_s: float, seed: int) -> list[CameraTrace]:
    stage = find_stage(scene)
    # Seed 0 of a stage is the plain path of the kind, which no draw of paths holds.
    first = seed * MOST_PATHS + 1
    return [stage.move(kind, length_s, first + number) for number in range(count)]


def _named_apart(paths: Sequence[CameraTrace]) -> Iterator[CameraTrace]:
    """Yield the paths, later ones of a name with a number that no path is called by."""
    taken = {path.name for path in paths}
    seen: set[str] = set()
    for path in paths:
        name, number = path.name, 1
        while name in seen or (number > 1 and name in taken):
            number += 1
            name = f"{path.name} ({number})"
        seen.add(name)
        yield path if name == path.name else replace(path, name=name)
