"""Figure 3: what selection takes with a variable for each group, and with variables shared."""

from collections.abc import Mapping

import numpy as np

from ....base.arrays import FloatArray
from ..experiment import Chart, Claim, Constant, Experiment, Findings, Line, verdict_of
from ..trial import Numbers, Trial, trial
from .fig2 import PRINTED
from .selections import MACHINE, SCENE

_BUDGET_MS = 100.0
_AIM = 10.0
_EPSILON = 0.05
_EPSILONS = (0.005, 0.5)
_CULLS_PX = (1.0, 8.0)
_FRAMES, _SWEEP_FRAMES = 40, 8


def _trials(reduced: bool) -> list[Trial]:
    frames, fewer = (2, 1) if reduced else (_FRAMES, _SWEEP_FRAMES)
    sweeps = [("epsilon", value) for value in _EPSILONS] + [("cull_px", v) for v in _CULLS_PX]
    return [
        *(_trial("with", splitting=True, frames=frames),),
        *(_trial("without", splitting=False, frames=frames),),
        *(
            _trial(f"{name} {value:g}", splitting=True, frames=fewer, **{name: value})
            for name, value in ([] if reduced else sweeps)
        ),
        *(
            _trial(f"cull_px {value:g} without", splitting=False, frames=fewer, cull_px=value)
            for value in (() if reduced else _CULLS_PX)
        ),
    ]


def _trial(key: str, *, splitting: bool, frames: int, **more: float) -> Trial:
    arguments = {"budget_ms": _BUDGET_MS, "splitting": splitting, "frames": frames, **more}
    return trial(key, "zach.selections:measure", arguments)


def _work(one: Numbers) -> FloatArray:
    """Return iterations times variables of each frame."""
    return np.array(one["steps"], dtype=np.float64) * np.array(one["variables"])


def _judge(numbers: Mapping[str, Numbers], reduced: bool) -> Findings:
    on, off = numbers["with"], numbers["without"]
    charts = (_chart(on, off),)
    notes = [
        (
            f"Selection took {on['wall_ms']:.0f} ms with splitting and {off['wall_ms']:.0f} "
            "without, median of the processor time of a frame on the machine that wrote this page."
        ),
        (
            f"The price of a comparison in {MACHINE} is calibrated, so that the worst frame "
            "without splitting takes the second that the paper prints: that one matches by "
            "construction."
        ),
    ]
    if not reduced:
        notes.append(_sweep_note(numbers))
    claims = (_ratio_claim(on, off), _loss_claim(on, off), *_time_claims(on, off))
    return Findings(claims, charts, tuple(notes))


def _ratio_claim(on: Numbers, off: Numbers) -> Claim:
    ratio = _work(off).max() / _work(on).max()
    shown = "; ".join(
        f"{name} {max(one['variables']):,} variables, {max(one['steps']):,} iterations, "
        f"{_work(one).max():,.0f} in all"
        for name, one in (("without", off), ("with", on))
    )
    return Claim(
        "work, iterations times variables, at worst: without splitting over with it",
        '"far more favourable", on a logarithmic axis; values not printed',
        f"{ratio:.1f} times ({shown})",
        f"{_AIM:g} times",
        verdict_of(
            ratio >= _AIM, "too few groups share a variable at this epsilon", direction=ratio > 1.0
        ),
    )


def _loss_claim(on: Numbers, off: Numbers) -> Claim:
    trees, all_of_it = (
        100.0 * (1.0 - _worth(on, terrain=terrain) / _worth(off, terrain=terrain))
        for terrain in (False, True)
    )
    return Claim(
        "benefit of the trees lost by sharing variables",
        "less than the threshold chosen",
        f"at most {trees.max():.2f} %, {trees.mean():+.2f} % on average; of trees and terrain "
        f"together at most {all_of_it.max():.3f} %",
        f"{100.0 * _EPSILON:g} %",
        verdict_of(
            bool(trees.max() <= 100.0 * _EPSILON), "the bound does not hold for what is drawn"
        ),
    )


def _worth(one: Numbers, *, terrain: bool) -> FloatArray:
    """Return the benefit of the trees of each frame, and of the terrain with them."""
    trees = np.array(one["tree_benefit"])
    return trees + np.array(one["terrain_benefit"]) if terrain else trees


def _time_claims(on: Numbers, off: Numbers) -> tuple[Claim, Claim]:
    worst_on, worst_off = max(on["select_ms"]), max(off["select_ms"])
    return (
        Claim(
            "selection at worst without splitting (calibrated), 1 GHz",
            "more than 1 s",
            f"{1e-3 * worst_off:.2f} s",
            "1 s, by calibration",
            verdict_of(worst_off > 990.0, "the price was calibrated at another size"),
        ),
        Claim(
            "selection at worst with splitting, at the same price, stays within the frame's budget",
            '"far more favourable"; values not printed',
            f"{worst_on:.0f} ms of {_BUDGET_MS:g}",
            f"{_BUDGET_MS:g} ms",
            verdict_of(
                worst_on <= _BUDGET_MS,
                "other work than that on variables is left, and splitting does not shorten it",
                direction=worst_on < worst_off,
            ),
        ),
    )


def _sweep_note(numbers: Mapping[str, Numbers]) -> str:
    def worst(key: str) -> float:
        return float(_work(numbers[key]).max())

    # The same frames along the path: every fifth of the whole run's.
    stride = _FRAMES // _SWEEP_FRAMES
    off, on = (float(_work(numbers[key])[::stride].max()) for key in ("without", "with"))
    epsilons = ", ".join(
        f"{off / worst(f'epsilon {value:g}'):.1f} at {value:g}" for value in _EPSILONS
    )
    culls = ", ".join(
        f"{worst(f'cull_px {value:g} without') / worst(f'cull_px {value:g}'):.1f} at {value:g} px"
        for value in _CULLS_PX
    )
    return (
        f"The saving by two assumed constants, over every fifth frame: by epsilon {epsilons}, "
        f"against {off / on:.1f} at {_EPSILON:g}; by the size of groups culled {culls}."
    )


def _chart(on: Numbers, off: Numbers) -> Chart:
    saved = _work(off) / _work(on)
    least, most = float(saved.min()), float(saved.max())
    along = np.linspace(0.0, 1.0, len(on["steps"]), endpoint=False).tolist()
    return Chart(
        name="work",
        caption="Iterations times variables along the flight: sharing variables saves the more, "
        f"the more groups are in view, {least:.0f} to {most:.0f} times.",
        x="share of the path",
        y="iterations times variables",
        lines=(
            Line("a variable for each group", along, _work(off).tolist()),
            Line("variables shared", along, _work(on).tolist()),
        ),
        log_y=True,
    )


FIG3 = Experiment(
    id="zach/fig3",
    title="Selection with and without variable splitting",
    setting=f"{SCENE} on {MACHINE} under zach without admission, 100 ms, the gradient as printed, "
    "frames evenly along the flight, every group above the culling size a variable or part of one.",
    constants={
        **PRINTED,
        "ms a comparison": Constant(
            "see the profile", "calibrated", '"longer than 1 second in the worst case"'
        ),
    },
    trials=_trials,
    judge=_judge,
)
