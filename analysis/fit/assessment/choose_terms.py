"""Which predictors a log supports, by held-out log score.

Every set of predictors is fitted to every other block of frames and scored on the rest, both ways
round: the mean log density of a held-out frame under Student's t with what the robust fit found.
Of the sets whose score is within one standard error of the best, over blocks, the smallest is
taken: more terms than the log supports make a profile that transfers badly (Hastie, Tibshirani,
Friedman, "The elements of statistical learning", section 7.10).
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ....base.arrays import BoolArray, FloatArray
from ....base.errors import InputError
from ....base.predictors import CPU_PREDICTORS, GPU_PREDICTORS
from ....traces.logs.render_log import RenderLog, TimeName
from ..fit_frames import Sample
from ..sampling.robust_fit import robust_nnls
from ..terms import Term
from .heldout import block_numbers

_DOF = 4.0
_ALL_SETS = 6  # predictors, up to which every set is tried; of more, sets of at most three
_MOST_ROWS = 20_000
_HELD = 0.95  # share of frames in which a predictor must have a value
_VARIES = 1e-9


@dataclass(frozen=True, slots=True)
class Candidate:
    """A set of terms and its held-out log score per frame, with its distance to the best.

    Attributes
    ----------
    behind, behind_se : mean over blocks of the best set's score minus this one's, and its error
    """

    terms: tuple[str, ...]
    log_score: float
    behind: float
    behind_se: float


def candidate_predictors(logs: list[RenderLog], target: TimeName) -> tuple[str, ...]:
    """Return the predictors that all logs hold and that vary, in the order of the cost model.

    Raises `InputError` if there is none, naming those that are missing.
    """
    wanted = CPU_PREDICTORS if target == "cpu_ms" else GPU_PREDICTORS
    held = [name for name in wanted if all(name in log.predictors for log in logs)]
    if not held:
        raise InputError(
            f"{logs[0].name}: expected at least one of the predictors {', '.join(wanted[:3])}…, "
            f"got a {logs[0].format} log with none of them, so that no cost can be fitted; "
            f"{_instead(logs[0])}"
        )
    usable = [
        name for name in held if _usable(np.concatenate([log.columns([name]) for log in logs]))
    ]
    if not usable:
        raise InputError(
            f"{logs[0].name}: expected predictors that vary, got constant or missing "
            f"{', '.join(held)}; log a walk through different views"
        )
    return tuple(usable)


def _instead(log: RenderLog) -> str:
    """Return what to do about a log without predictors: what its reader says, or in general."""
    general = "log what was drawn beside the times, map the columns that hold it, or --join a log"
    return next((text for text in log.warnings if "for a cost model" in text), general)


def _usable(column: FloatArray) -> bool:
    good = np.isfinite(column) & (column >= 0.0)
    return good.mean() >= _HELD and bool(np.ptp(column[good]) > _VARIES * column[good].mean())


def choose_terms(sample: Sample) -> tuple[tuple[Term, ...], tuple[Candidate, ...]]:
    """Return the terms to fit, from the sample's predictors, and all candidates, best first.

    Raises `InputError` if there are too few frames to choose between several predictors.
    """
    if len(sample.names) == 1:
        return (Term("linear", sample.names),), ()
    fewest = 4 * (len(sample.names) + 2)
    if len(sample) < fewest:
        raise InputError(
            f"expected at least {fewest} frames to choose among {', '.join(sample.names)}, got "
            f"{len(sample)}; log for longer, or name the --terms"
        )
    step = max(1, -(-len(sample) // _MOST_ROWS))
    sample = sample.rows(np.arange(0, len(sample), step))
    names = sample.names
    largest = len(names) if len(names) <= _ALL_SETS else 3
    sets = [chosen for size in range(1, largest + 1) for chosen in combinations(names, size)]
    blocks = block_numbers(sample.series)
    scores = np.stack([_score(sample, chosen, blocks % 2 == 0) for chosen in sets])
    best = scores[scores.mean(axis=1).argmax()]
    candidates = [
        Candidate(chosen, float(score.mean()), *_behind(best - score, blocks))
        for chosen, score in zip(sets, scores, strict=True)
    ]
    candidates.sort(key=lambda candidate: -candidate.log_score)
    near = [candidate for candidate in candidates if candidate.behind <= candidate.behind_se]
    chosen = min(near, key=lambda candidate: (len(candidate.terms), candidate.behind))
    return tuple(Term("linear", (name,)) for name in chosen.terms), tuple(candidates)


def _score(sample: Sample, names: tuple[str, ...], fitted: BoolArray) -> FloatArray:
    """Return the log density of each frame under a fit to the frames on the other side, (n,)."""
    from scipy import stats

    columns = sample.predictors[:, [sample.names.index(name) for name in names]]
    score = np.empty(len(sample))
    for side in (fitted, ~fitted):
        fit = robust_nnls(columns[side], sample.time_ms[side], dof=_DOF)
        mean = np.maximum(fit.predict(columns[~side]), 1e-12)
        residual = (sample.time_ms[~side] - mean) / mean
        density: FloatArray = stats.t.logpdf(residual, _DOF, scale=fit.scale)
        score[~side] = density - np.log(mean)
    return score


def _behind(difference: FloatArray, blocks: NDArray[np.int64]) -> tuple[float, float]:
    """Return the mean difference over blocks and its standard error."""
    sums = np.bincount(blocks, weights=difference) / np.bincount(blocks)
    return float(sums.mean()), float(sums.std(ddof=1) / np.sqrt(len(sums)))
