"""N_a, the active list: how much less is looked at, and how long objects wait for their level."""

from collections.abc import Mapping, Sequence

import numpy as np

from ..experiment import Chart, Claim, Constant, Experiment, Findings, Line, verdict_of
from ..trial import Numbers, Trial, trial
from .machine import CONSTANTS, SLOTS, manager

_LISTS = (50, 200, 1000)
_REFRESH = 16
_OBJECTS = 3_000
_PATHS = ("drive", "walk")
_SEEDS, _SECONDS = 5, 4.0
_LATE_FRAMES = _REFRESH  # an object waits at most until its slice is looked at


def _trials(reduced: bool) -> Sequence[Trial]:
    lists = (None, *((200,) if reduced else _LISTS), _OBJECTS)
    return [
        trial(
            _key(places, path, seed),
            "gumbau.similarity:measure",
            {
                "policy": manager(more=_list_of(places)),
                "slots": SLOTS,
                "path": path,
                "seed": seed,
                "seconds": 1.5 if reduced else _SECONDS,
            },
        )
        for places in lists
        for path in _PATHS
        for seed in range(1 if reduced else _SEEDS)
    ]


def _list_of(places: int | None) -> str:
    if places is None:
        return ""
    # All objects in every frame, as the paper's algorithm has it without a list.
    return f",active={places},refresh={1 if places == _OBJECTS else _REFRESH}"


def _key(places: int | None, path: str, seed: int) -> str:
    return f"list of {places}, {path}, seed {seed}"


def _judge(numbers: Mapping[str, Numbers], reduced: bool) -> Findings:
    lists = (200,) if reduced else _LISTS
    seeds = range(1 if reduced else _SEEDS)

    def over_seeds(column: str, path: str, places: int | None) -> list[float]:
        return [numbers[_key(places, path, seed)][column] for seed in seeds]

    def mean(column: str, path: str, places: int | None) -> float:
        return float(np.mean(over_seeds(column, path, places)))

    claims: list[Claim] = []
    for path in _PATHS:
        most = {n: max(over_seeds("visited_beyond_new", path, n)) for n in lists}
        bound = {n: n + -(-_OBJECTS // _REFRESH) for n in lists}
        visited = {n: mean("visited", path, n) for n in lists}
        all_of_them = mean("visited", path, None)
        wait = {n: max(over_seeds("wait_max", path, n)) for n in lists}
        claims += [
            Claim(
                f"a frame looks at the list and a slice, not at all objects; {path}",
                "iterating through all those elements is inefficient",
                f"objects looked at: {', '.join(f'{n}: {visited[n]:.0f}' for n in lists)}; without "
                f"a list {all_of_them:.0f} (those in view; the paper {_OBJECTS})",
                "N_a + V / refresh, beside objects that come into view",
                verdict_of(
                    all(most[n] <= bound[n] for n in lists),
                    "more are looked at, " + ", ".join(f"{n}: {most[n]:.0f}" for n in lists),
                ),
            ),
            Claim(
                f"objects do not wait long for the level that they want; {path}",
                "not printed",
                ", ".join(
                    f"{n}: {100 * mean('dissimilar', path, n):.2f} % of objects at another level, "
                    f"a wait of {mean('wait_mean', path, n):.1f} frames, at most {wait[n]:.0f}"
                    for n in lists
                ),
                f"at most {_LATE_FRAMES} frames",
                verdict_of(
                    max(wait.values()) <= _LATE_FRAMES,
                    f"up to {max(wait.values()):.0f} frames: who borrows from an owner that "
                    "extracts shows a level that it did not ask for, until its slice is looked at",
                    direction=min(wait.values()) <= _LATE_FRAMES,
                ),
            ),
        ]
    notes = tuple(
        f"Time of selection on {path} beside looking at all {_OBJECTS}: "
        + ", ".join(
            f"{name} {mean('select_ms', path, n) / mean('select_ms', path, _OBJECTS):.3f}"
            for name, n in (("at those in view", None), *((f"N_a {n}", n) for n in lists))
        )
        + f"; {mean('in_view', path, None):.0f} are in view.  Where culling is done anyway, as "
        "here, a list only pays if it and the slice are fewer than what is in view."
        for path in _PATHS
    )
    chart = Chart(
        name="visited",
        caption="What a list saves: objects looked at in a frame.",
        x="places of the list N_a",
        y="objects looked at",
        lines=tuple(
            Line(path, lists, [mean("visited", path, n) for n in lists]) for path in _PATHS
        ),
        log_x=True,
    )
    return Findings(tuple(claims), (chart,), notes)


ACTIVE_LIST = Experiment(
    id="gumbau/Na",
    title="the active list",
    setting=f"`ogres`, `drive` and `walk` of {_SECONDS:g} s, {_SEEDS} seeds.",
    constants={
        name: one
        for name, one in CONSTANTS.items()
        if name in ("ogres", "machine", "slots N_T", "range", "frame-rate feedback", "field")
    }
    | {"refresh": Constant(f"{_REFRESH} frames", "assumed", "V is refreshed a slice at a time")},
    trials=_trials,
    judge=_judge,
)
