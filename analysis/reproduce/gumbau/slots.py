"""N_T, the number of slots: more of them make levels nearer to those wanted, and change more."""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from ..experiment import Chart, Claim, Experiment, Findings, Line, verdict_of
from ..trial import Numbers, Trial, trial
from .machine import CONSTANTS, manager

_SLOTS = (4, 8, 16, 32, 64, 128)
_PATHS = ("drive", "walk")
_SEEDS, _SECONDS = 5, 4.0


def _trials(reduced: bool) -> Sequence[Trial]:
    return [
        trial(
            _key(slots, path, seed),
            "gumbau.similarity:measure",
            {
                "policy": manager(slots=slots),
                "slots": slots,
                "path": path,
                "seed": seed,
                "seconds": 1.5 if reduced else _SECONDS,
            },
        )
        for slots in (_SLOTS[1::2] if reduced else _SLOTS)
        for path in _PATHS
        for seed in range(1 if reduced else _SEEDS)
    ]


def _key(slots: int, path: str, seed: int) -> str:
    return f"{slots} slots, {path}, seed {seed}"


def _judge(numbers: Mapping[str, Numbers], reduced: bool) -> Findings:
    tried = _SLOTS[1::2] if reduced else _SLOTS
    seeds = range(1 if reduced else _SEEDS)

    def mean(column: str, path: str) -> list[float]:
        return [
            float(np.mean([numbers[_key(slots, path, seed)][column] for seed in seeds]))
            for slots in tried
        ]

    claims: list[Claim] = []
    for path in _PATHS:
        extracted, off = mean("extracted", path), mean("off", path)
        rises = all(a < b for a, b in pairwise(extracted))
        inside = all(one <= 1.0 / slots for one, slots in zip(off, tried, strict=True))
        told = ", ".join(f"{slots}: {n:.2f}" for slots, n in zip(tried, extracted, strict=True))
        claims += [
            Claim(
                f"more slots make more recalculations; {path}",
                "affects the number of recalculations",
                f"levels extracted a frame: {told}",
                "rising with each step",
                verdict_of(rises, "it does not rise with each step"),
            ),
            Claim(
                f"a level shown is similar to the one wanted; {path}",
                "within 1 / N_T by construction",
                "mean difference of factors times N_T: "
                + ", ".join(
                    f"{slots}: {slots * one:.2f}" for slots, one in zip(tried, off, strict=True)
                ),
                "1",
                verdict_of(inside, "a mean difference is beyond one slot"),
            ),
        ]
    chart = Chart(
        name="extractions",
        caption="Twice the slots, about four times the levels extracted a frame.",
        x="slots N_T",
        y="levels extracted a frame",
        lines=tuple(Line(path, tried, mean("extracted", path)) for path in _PATHS),
        log_x=True,
        log_y=True,
    )
    return Findings(tuple(claims), (chart,))


SLOTS_EXPERIMENT = Experiment(
    id="gumbau/NT",
    title="how many slots",
    setting=f"`ogres`, `drive` and `walk` of {_SECONDS:g} s, {_SEEDS} seeds; no active list.",
    constants={
        name: one
        for name, one in CONSTANTS.items()
        if name in ("ogres", "machine", "range", "frame-rate feedback", "field")
    },
    trials=_trials,
    judge=_judge,
)
