"""Figures 2 and 4: predicted and actual rendering times on a flight, at three budgets."""

from collections.abc import Mapping, Sequence
from statistics import fmean

import numpy as np

from ..experiment import Chart, Claim, Constant, Experiment, Findings, Line, verdict_of
from ..trial import Numbers, Trial, trial
from .selections import MACHINE, SCENE

PRINTED = {
    "c_splat, c_tree, c_vertex": Constant("0.35, 2.45, 0.06 us", "printed", "section 5.3"),
    "k": Constant("1/16", "printed", "section 5.3"),
    "trees, most in a group": Constant("1.4 million, 64", "printed", "section 4"),
    "heights": Constant("2,049 x 2,049 over 120 km", "printed", "section 4"),
    "vertices sent for a patch": Constant("2,112", "assumed", "33 x 33 heights in 32 strips"),
    "relief, forest and path": Constant("smooth noise; 40 s across all of it, 200 m up", "assumed"),
    "splats of a tree": Constant("512", "assumed"),
    "cull_px": Constant("2 px", "assumed"),
    "epsilon": Constant("0.05 of the groups' greatest benefit", "assumed"),
    "barrier": Constant("0.001", "assumed", '"a small constant"'),
}
"""Constants of all experiments of the paper."""

_BUDGET_MS = 100.0
_OTHERS_MS = (80.0, 150.0)
_GAP_PCT = (1.0, 15.0)


def _fig2_trials(reduced: bool) -> list[Trial]:
    seconds = 1.0 if reduced else 40.0
    return [
        trial("flight", "zach.selections:replayed", {"budget_ms": _BUDGET_MS, "seconds": seconds})
    ]


def _judge_fig2(numbers: Mapping[str, Numbers], _reduced: bool) -> Findings:
    one = numbers["flight"]
    claims = (
        *_budget_claims(one, _BUDGET_MS),
        _gap_claim(one, "all", "predicted_ms", "simulated_ms"),
        _gap_claim(one, "vegetation alone", "trees_predicted_ms", "trees_ms"),
    )
    return Findings(claims, _charts(one), _notes(one))


def _notes(one: Numbers) -> tuple[str, ...]:
    trees, splats, vertices = (fmean(one[name]) for name in ("trees", "splats", "vertices"))
    quarter = len(one["trees"]) // 4 + 1
    early, late = fmean(one["trees"][:quarter]), fmean(one["trees"][-quarter:])
    return (
        (
            f"Of {_BUDGET_MS:g} ms the mean frame spends {6e-5 * vertices:.0f} on terrain and "
            f"{2.45e-3 * trees:.0f} on setting up {trees:,.0f} trees, which have "
            f"{splats / max(trees, 1.0):.1f} splats each.  The gap is what the optimizer gives to "
            "trees that do not get a whole splat; costs themselves are exact here, as the machine "
            "is simulated by the printed constants."
        ),
        (
            f"The path, which is not printed, decides how much time trees have: {early:,.0f} "
            f"of them in its first quarter, with terrain in view as far as the other edge, and "
            f"{late:,.0f} in its last.  An increment of terrain is worth more than a tree as long "
            "as there is one, by the printed benefits as they are read here."
        ),
    )


def _charts(one: Numbers) -> tuple[Chart, ...]:
    return tuple(
        Chart(
            name=name,
            caption=caption,
            x="time along the path, s",
            y="ms",
            lines=(
                Line("predicted", one["at_s"], one[predicted]),
                Line("simulated", one["at_s"], one[simulated]),
            ),
        )
        for name, caption, predicted, simulated in (
            (
                "total",
                "Every frame takes less than is predicted, by the splats that are less than whole.",
                "predicted_ms",
                "simulated_ms",
            ),
            (
                "vegetation",
                "The vegetation alone, which all of the gap belongs to.",
                "trees_predicted_ms",
                "trees_ms",
            ),
        )
    )


def _budget_claims(one: Numbers, budget_ms: float) -> tuple[Claim, Claim]:
    predicted, simulated = np.array(one["predicted_ms"]), np.array(one["simulated_ms"])
    frames = len(predicted)
    under = int((simulated <= predicted).sum())
    kept = int((predicted <= budget_ms).sum())
    return (
        Claim(
            f"{budget_ms:g} ms: the actual time is at or under the predicted one",
            "in the figure; values not printed",
            f"{under} of {frames} frames",
            "every frame",
            verdict_of(under == frames, "something is charged that is not predicted"),
        ),
        Claim(
            f"{budget_ms:g} ms: the predicted time is within the budget",
            "feasible whenever it stops",
            f"{kept} of {frames} frames, worst {predicted.max():.4f} ms",
            "every frame",
            verdict_of(kept == frames, "the search oversteps"),
        ),
    )


def _gap_claim(one: Numbers, what: str, predicted: str, simulated: str) -> Claim:
    gap = 100.0 * (1.0 - np.array(one[simulated]) / np.array(one[predicted]))
    low, high = _GAP_PCT
    mean = float(gap.mean())
    return Claim(
        f"the budget is not completely exploited, {what}",
        "usually; values not printed",
        f"{mean:.1f} % on average, {gap.min():.1f} to {gap.max():.1f} %",
        f"mean of {low:g} to {high:g} %",
        verdict_of(
            low <= mean <= high,
            "trees of less than a splat take another share here",
            direction=bool((gap > 0.0).all()),
        ),
    )


def _fig4_trials(reduced: bool) -> list[Trial]:
    return [
        trial(
            f"{budget_ms:g} ms",
            "zach.selections:measure",
            {"budget_ms": budget_ms, "splitting": True, "frames": 3 if reduced else 40},
        )
        for budget_ms in sorted((_BUDGET_MS, *_OTHERS_MS))
    ]


def _judge_fig4(numbers: Mapping[str, Numbers], _reduced: bool) -> Findings:
    budgets = sorted((_BUDGET_MS, *_OTHERS_MS))
    some = [numbers[f"{budget_ms:g} ms"] for budget_ms in budgets]
    splats = [fmean(one["splats"]) for one in some]
    vertices = [fmean(one["vertices"]) for one in some]
    claims = [
        claim
        for one, budget_ms in zip(some, budgets, strict=True)
        for claim in _budget_claims(one, budget_ms)
    ]
    claims.append(_more_claim("splats", splats))
    claims.append(_more_claim("vertices of terrain", vertices))
    chart = Chart(
        name="splats",
        caption="More time brings more splats and more terrain.",
        x="budget, ms",
        y="thousands",
        lines=(
            Line("splats", budgets, [1e-3 * value for value in splats]),
            Line("vertices of terrain", budgets, [1e-3 * value for value in vertices]),
        ),
    )
    return Findings(tuple(claims), (chart,))


def _more_claim(what: str, values: Sequence[float]) -> Claim:
    return Claim(
        f"a larger budget brings more {what}",
        "in the pictures; values not printed",
        ", ".join(f"{value:,.0f}" for value in values),
        "",
        verdict_of(list(values) == sorted(set(values)), "what is added goes elsewhere"),
    )


FIG2 = Experiment(
    id="zach/fig2",
    title="Predicted and actual rendering times",
    setting=f"{SCENE} on {MACHINE} under zach without admission, a budget of 100 ms, the whole "
    "flight.",
    constants=PRINTED,
    trials=_fig2_trials,
    judge=_judge_fig2,
)

FIG4 = Experiment(
    id="zach/fig4",
    title="One flight at three budgets",
    setting=f"{SCENE} on {MACHINE} under zach without admission at 80, 100 and 150 ms, frames "
    "evenly along the flight.",
    constants=PRINTED,
    trials=_fig4_trials,
    judge=_judge_fig4,
)
