"""Which predictors a log supports, by held-out log score.

Every set of predictors is fitted to every other block of frames and scored on the rest, both ways
round, or to all scenes but one where logs of three or more are given: the mean log density of a
held-out frame under Student's t with what the robust fit found.  Of the sets whose score is within
one standard error of the best, the smallest is taken: more terms than the log supports make a
profile that transfers badly (Hastie, Tibshirani, Friedman, "The elements of statistical learning",
section 7.10).  Then a knee of its triangles, or a roofline, is scored alike, and taken if it gains
three standard errors.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ....base.arrays import BoolArray, FloatArray
from ....base.errors import InputError
from ....base.predictors import CPU_PREDICTORS, GPU_PREDICTORS, POLICY_WORK
from ....traces.logs.render_log import RenderLog, TimeName
from ..design import additive_column
from ..fit_frames import Sample
from ..sampling.between_logs import ENOUGH_SCENES
from ..sampling.robust_fit import robust_nnls
from ..terms import Term
from .heldout import block_numbers
from .prediction import seen_rows

_DOF = 4.0
_ALL_SETS = 6  # predictors, up to which every set is tried; of more, sets of at most three
_HELD = 0.95  # share of frames in which a predictor must have a value
_VARIES = 1e-9
_ENOUGH_TO_BEND = 200  # frames, below which knees and rooflines are not looked for
_CLEARLY = 3.0  # standard errors
_LEAST_GAIN = 1e-3  # nats of a frame; a bend that costs nothing gains what rounding leaves
_KNEES = ("triangles", "rasterized_triangles", "vertices")
_GEOMETRY = ("triangles", "vertices")
_QUANTILES = (0.2, 0.35, 0.5, 0.65, 0.8)
_ROUNDS = 8


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
    if target == "cpu_ms" and any("policy" in dict(log.header) for log in logs):
        # A recording's cpu_ms is of drawing; what the policy did is timed apart.
        wanted = tuple(name for name in wanted if name not in POLICY_WORK)
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


def choose_terms(
    sample: Sample, target: TimeName = "gpu_ms"
) -> tuple[tuple[Term, ...], tuple[Candidate, ...]]:
    """Return the terms to fit, from the sample's predictors, and all candidates, best first.

    Sets of linear terms come first; to what they lead to, a knee or a roofline is added.

    Raises `InputError` if there are too few frames to choose between several predictors.
    """
    fewest = 4 * (len(sample.names) + 2)
    if len(sample.names) == 1 and len(sample) < fewest:
        return (Term("linear", sample.names),), ()
    if len(sample) < fewest:
        raise InputError(
            f"expected at least {fewest} frames to choose among {', '.join(sample.names)}, got "
            f"{len(sample)}; log for longer, or name the --terms"
        )
    sample = seen_rows(sample)
    groups, folds = _groups(sample)
    names = sample.names
    largest = len(names) if len(names) <= _ALL_SETS else 3
    sets = [
        tuple(Term("linear", (name,)) for name in chosen)
        for size in range(1, largest + 1)
        for chosen in combinations(names, size)
    ]
    scores = [_score(sample, terms, folds) for terms in sets]
    best, candidates = _chosen(sets, scores, groups)
    if target == "cpu_ms" or len(sample) < _ENOUGH_TO_BEND:
        return best, candidates
    straight = scores[sets.index(best)]
    bent = _bent(sample, best)
    scores += [_score(sample, terms, folds) for terms in bent]
    gains = [_behind(score - straight, groups) for score in scores[len(sets) :]]
    _, candidates = _chosen([*sets, *bent], scores, groups)
    # Where a bend lies is found from the log too, of many places: it has to gain more than a term.
    clear = [
        place
        for place, (gain, error) in enumerate(gains)
        if gain > max(_CLEARLY * error, _LEAST_GAIN)
    ]
    if clear:
        best = bent[max(clear, key=lambda place: gains[place][0])]
    return best, candidates


def _groups(sample: Sample) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return groups of frames that err alike, and the fold that each frame is held out with.

    Blocks, every second one at a time; of several scenes each scene, since terms that are chosen
    within scenes need not hold in another.
    """
    scenes = [sample.origin(log).scene for log in range(int(sample.series.max()) + 1)]
    known = list(dict.fromkeys(scenes))
    if len(known) >= ENOUGH_SCENES:
        of_log = np.array([known.index(scene) for scene in scenes])
        fold = of_log[sample.series]
        return fold, fold
    blocks = block_numbers(sample.series, sample.path)
    return blocks, blocks % 2


def _bent(sample: Sample, terms: tuple[Term, ...]) -> list[tuple[Term, ...]]:
    """Return a set of linear terms with a knee of each kind of triangles, or a roofline."""
    held = [term.predictors[0] for term in terms]
    found: list[tuple[Term, ...]] = []
    for name in held:
        if name not in _KNEES:
            continue
        ats = np.quantile(sample.column(name), _QUANTILES).tolist()
        found += [(*terms, Term("knee", (name,), float(f"{at:.3g}"))) for at in ats if at > 0.0]
    if "shaded_samples" in sample.names:
        others = tuple(term for term in terms if term.predictors[0] != "shaded_samples")
        for term in others:
            if term.predictors[0] in _GEOMETRY:
                rest = tuple(other for other in others if other is not term)
                roof = Term("roofline", (term.predictors[0], "shaded_samples"))
                found.append((*rest, roof))
    return found


def _chosen(
    sets: list[tuple[Term, ...]], scores: list[FloatArray], groups: NDArray[np.int64]
) -> tuple[tuple[Term, ...], tuple[Candidate, ...]]:
    """Return the smallest set within one standard error of the best, and all, best first."""
    best = scores[int(np.argmax([score.mean() for score in scores]))]
    found = [
        (terms, Candidate(tuple(map(str, terms)), float(s.mean()), *_behind(best - s, groups)))
        for terms, s in zip(sets, scores, strict=True)
    ]
    found.sort(key=lambda pair: -pair[1].log_score)
    near = [pair for pair in found if pair[1].behind <= pair[1].behind_se]
    terms, _ = min(near, key=lambda pair: (len(pair[0]), pair[1].behind))
    return terms, tuple(candidate for _, candidate in found)


def _score(sample: Sample, terms: tuple[Term, ...], folds: NDArray[np.int64]) -> FloatArray:
    """Return the log density of each frame under a fit to the frames of other folds, (n,)."""
    from scipy import stats

    score = np.empty(len(sample))
    for fold in np.unique(folds):
        held = folds == fold
        mean, scale = _predicted(sample, terms, ~held)
        mean = np.maximum(mean[held], 1e-12)
        residual = (sample.time_ms[held] - mean) / mean
        density: FloatArray = stats.t.logpdf(residual, _DOF, scale=scale)
        score[held] = density - np.log(mean)
    return score


def _predicted(
    sample: Sample, terms: tuple[Term, ...], fitted: BoolArray
) -> tuple[FloatArray, float]:
    """Return the times of all frames, (n,), by a fit to some, and the scale of their noise."""
    roof = next((term for term in terms if term.kind == "roofline"), None)
    plain = [additive_column(sample, term) for term in terms if term is not roof]
    if roof is None:
        columns = np.column_stack(plain)
        fit = robust_nnls(columns[fitted], sample.time_ms[fitted], dof=_DOF)
        return fit.predict(columns), fit.scale
    geometry, pixels = (sample.column(name) for name in roof.predictors)
    larger = geometry / geometry.mean() >= pixels / pixels.mean()
    fit = None
    for _ in range(_ROUNDS):
        columns = np.column_stack([*plain, geometry * larger, pixels * ~larger])
        fit = robust_nnls(columns[fitted], sample.time_ms[fitted], dof=_DOF)
        dear, fill = fit.slopes_ms[-2] * geometry, fit.slopes_ms[-1] * pixels
        if not dear.any() or not fill.any() or ((dear >= fill) == larger).all():
            break
        larger = dear >= fill
    assert fit is not None
    rest = fit.predict(np.column_stack([*plain, 0.0 * geometry, 0.0 * pixels]))
    sides = fit.slopes_ms[-2] * geometry, fit.slopes_ms[-1] * pixels
    return rest + np.maximum(*sides), fit.scale


def _behind(difference: FloatArray, blocks: NDArray[np.int64]) -> tuple[float, float]:
    """Return the mean difference over blocks and its standard error."""
    sums = np.bincount(blocks, weights=difference) / np.bincount(blocks)
    return float(sums.mean()), float(sums.std(ddof=1) / np.sqrt(len(sums)))
