"""Whether parameters that were found are better, on paths that took no part in finding them."""

from collections.abc import Mapping, Sequence

import numpy as np

from ...metrics.metric_registry import METRICS
from ...verdict.answer import ORDER
from ...verdict.intervals import such_paths
from ...verdict.judged import Judged
from ...verdict.paired import one_sided_p
from ...verdict.ranking import ALPHA
from ...verdict.scores import LEVEL
from ...verdict.verdict import Terms, Verdict, reach_verdict
from ..judging import Judging
from ..replays import Replays
from ..tuning import rotate, tune
from .tuning_record import Gain, Side

SEEDS = 2
"""Replays of each path, under other noise."""

_DECIMALS = 12  # beyond which a difference is rounding


def confirm(
    replays: Replays, paths: Sequence[str], margin: float
) -> tuple[Verdict, dict[str, Judged]]:
    """Return the verdict on the first paths, and the runs behind it by label.

    Knobs are tuned on these paths, by rotation, as in any comparison.

    Parameters
    ----------
    paths
        Their names: two or more, which no trial has seen.
    """
    options = replays.bench.options
    rotation = rotate(len(paths), 0)
    seeds = tuple(range(options.seed, options.seed + SEEDS))
    judging = Judging(replays.bench, rotation, seeds, ())
    replays.make(judging.as_given())
    tuned = tune(replays, rotation, options.budget_ms, options.seed)
    replays.make(judging.places(tuned))
    judged = judging.outcome(replays, tuned)
    terms = Terms(
        budget_ms=options.budget_ms,
        margin=margin,
        population="such paths",
        paths=tuple(paths),
        seed=options.seed,
    )
    verdict = reach_verdict(judged, judging.unscored(replays), {}, terms)
    return verdict, {item.label: item for item in judged}


def is_better(shipped: Side, found: Side, judged: Mapping[str, Judged]) -> bool:
    """Whether the found parameters rank first; and, where the others miss, are shown to be faster.

    A probability of keeping just above .9 beside one just below would be no difference.
    """
    if found.rank is None:
        return False
    if shipped.rank is not None:
        return found.rank < shipped.rank
    of_shipped, of_found = (np.log(judged[side.label].point_ms) for side in (shipped, found))
    return one_sided_p(of_shipped, of_found, 0.0, relative=False) < ALPHA


def find_gains(shipped: Judged, found: Judged) -> tuple[Gain, ...]:
    """Return the paired differences of the metrics by which policies are put in order."""
    units = {metric.id: metric.unit for metric in METRICS}
    gains: list[Gain] = []
    for name in ("work_ms_p99", *ORDER):
        before, after = shipped.replicates(name), found.replicates(name)
        known = ~np.isnan(before + after)
        if known.sum() < 2:
            continue
        difference = (after - before)[known].round(_DECIMALS)
        interval = such_paths(difference, "signed", LEVEL)
        assert interval is not None, "only extremes have none"
        gains.append(
            Gain(
                metric=name,
                unit=units[name],
                shipped=float(before[known].mean()),
                found=float(after[known].mean()),
                difference=float(difference.mean()),
                interval=(interval.low, interval.high),
            )
        )
    return tuple(gains)


def answer(shipped: Side, found: Side | None, gain: Sequence[Gain], *, better: bool) -> str:
    """Return in one sentence whether to take what was found.

    None was found where no trial came before the shipped parameters, or where the best one failed.
    """
    if found is None:
        return f"No better than shipped: no trial came before {shipped.label} and ran on all paths."
    if not better:
        return f"No better than shipped: on other paths {found.label} is not shown to be better."
    if shipped.rank is None:
        return (
            f"Take {found.label}: on other paths it surely keeps the budget, which {shipped.label} "
            "does not."
        )
    first = next(
        (
            one
            for one in gain
            if one.metric in ORDER and not one.interval[0] <= 0 <= one.interval[1]
        ),
        None,
    )
    what = ""
    if first is not None:
        low, high = first.interval
        what = (
            f": {first.difference:+.3g} {first.unit} of {first.metric} "
            f"({low:+.3g} to {high:+.3g} over such paths)"
        )
    return f"Take {found.label}: on other paths it ranks before {shipped.label}{what}."
