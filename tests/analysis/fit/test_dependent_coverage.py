"""Intervals of the mean frame's cost hold what they promise, also where frames err alike.

Of nine kinds of logs 200 each, with seeds that were fixed beforehand; CI tries fewer.  Views change
slowly: draws and triangles follow autoregressions that forget in 30 frames.  What a frame costs on
average is known for the frames of all such paths; one log has 1,200 of them.
"""

import json
from typing import Any

import numpy as np
import pytest
from scipy import stats
from scipy.signal import lfilter
from scipy.special import ndtr

from lodbench.analysis.fit.estimate import estimate, posterior_of
from lodbench.analysis.fit.fit_frames import Origin, Sample
from lodbench.analysis.fit.sampling.sampler import SamplerOptions
from lodbench.analysis.fit.terms import parse_terms
from lodbench.base.arrays import FloatArray

KINDS = (
    "independent",
    "outliers",
    "AR 0.5",
    "AR 0.9",
    "slow drift",
    "slow episodes",
    "slow missing predictor",
    "two occasions",
    "roofline truth",
)
FRAMES = 1_200
MEAN_FRAME = np.array([1.0, 225.0, 1.1e6])
"""A one, draws and triangles of the mean frame."""

_COST = np.array([4.0, 0.02, 5e-6])
_VIEW_FRAMES = 30.0
_SAMPLE_MS = 6e-6

TERMS = parse_terms("draw_calls,triangles")
WHOLE, REDUCED = 200, 12  # logs of a kind
# What 200 logs leave undecided about a share of .85 to .95, or 12 about .9: one in a thousand.
LOW, HIGH = 0.85, 0.95


def dependent_log(kind: str, seed: int) -> tuple[Sample, float]:
    """Return a log and the cost of its mean frame, ms.

    Noise is 5 % of the time: in "outliers" one frame in twenty takes 1.5 to 4 times as long, which
    is no cost of the frame; in "slow drift" 3 % and an autoregression of 5 % that forgets in 150
    frames; in "slow episodes" 3 %, and the machine is 15 % slower for 40 frames on average, then
    not for 80; in "slow missing predictor" 3 % and up to 10 % by what another view's predictor
    says; "two occasions" have a factor each, of log-sd 0.09, and 600 frames; "roofline truth" is
    the larger of triangles and samples, of which the model does not know.
    """
    rng = np.random.default_rng((KINDS.index(kind), seed, 15))
    views = ndtr(np.stack([_forgetting(rng, FRAMES, _VIEW_FRAMES) for _ in range(3)]))
    draws = 50.0 + 350.0 * views[0]
    triangles = 2e5 + 1.8e6 * (0.6 * views[0] + 0.4 * views[1])
    mean = _COST[0] + _COST[1] * draws + _COST[2] * triangles
    noise = rng.standard_normal(FRAMES)
    truth_ms = float(_COST @ MEAN_FRAME)
    series, origins = np.zeros(FRAMES, dtype=np.int64), (Origin("", "one"),)
    factor = 1.0 + 0.05 * noise
    if kind == "outliers":
        slow = rng.random(FRAMES) < 0.05
        factor[slow] *= rng.uniform(1.5, 4.0, slow.sum())
    elif kind.startswith("AR"):
        frames = -1.0 / np.log(float(kind.removeprefix("AR ")))
        factor = 1.0 + 0.05 * _forgetting(rng, FRAMES, frames)
    elif kind == "slow drift":
        factor = 1.0 + 0.03 * noise + 0.05 * _forgetting(rng, FRAMES, 150.0)
    elif kind == "slow episodes":
        factor = 1.0 + 0.03 * noise + 0.15 * (_episodes(rng, FRAMES, 40.0, 80.0) - 1.0 / 3.0)
    elif kind == "slow missing predictor":
        factor = 1.0 + 0.03 * noise + 0.2 * (views[2] - 0.5)
    elif kind == "two occasions":
        series, origins = np.repeat([0, 1], FRAMES // 2), (Origin("", "one"), Origin("", "two"))
        factor *= np.exp(0.09 * rng.standard_normal(2))[series]
    elif kind == "roofline truth":
        mean = _roofline_ms(draws, triangles, views[1])
        factor = 1.0 + 0.03 * noise
        truth_ms = _mean_roofline_ms()
    counts = np.column_stack([draws, triangles])
    return Sample(("draw_calls", "triangles"), counts, mean * factor, series, origins), truth_ms


def _forgetting(rng: np.random.Generator, count: int, frames: float) -> FloatArray:
    """Return an autoregression of variance 1 that forgets in so many frames."""
    keeps = np.exp(-1.0 / frames)
    fresh = rng.standard_normal(count) * np.sqrt(1.0 - keeps**2)
    fresh[0] /= np.sqrt(1.0 - keeps**2)
    walk: Any = lfilter  # its stubs do not say what it returns
    return np.asarray(walk([1.0], [1.0, -keeps], fresh), dtype=np.float64)


def _episodes(rng: np.random.Generator, count: int, on: float, off: float) -> FloatArray:
    """Return 1 in episodes of mean length `on`, 0 between them for `off` on average."""
    starts_on = rng.random() < on / (on + off)
    is_on = (np.arange(count) % 2 == 0) == starts_on
    values = np.repeat(is_on, rng.geometric(1.0 / np.where(is_on, on, off)))
    return values[:count].astype(np.float64)


def _roofline_ms(draws: FloatArray, triangles: FloatArray, view: FloatArray) -> FloatArray:
    samples = 2e6 * view
    return 4.0 + 0.02 * draws + np.maximum(5e-6 * triangles, _SAMPLE_MS * samples)


def _mean_roofline_ms() -> float:
    """Return the mean over all views, on a grid of them."""
    at = (np.arange(1_000) + 0.5) / 1_000
    one, other = np.meshgrid(at, at)
    triangles = 2e5 + 1.8e6 * (0.6 * one + 0.4 * other)
    return float(_roofline_ms(50.0 + 350.0 * one, triangles, other).mean())


def interval(kind: str, seed: int) -> tuple[float, float, float]:
    """Return the 90 % interval of the mean frame's cost, by the quadratic form, and the truth.

    The posterior is a t about its optimum, whose spread the directions of the coefficients have;
    of several logs the spread between them is not known, and the chain says it.  Of 500 steps its
    ends are so noisy that .83 are covered where it promises .89.
    """
    sample, truth_ms = dependent_log(kind, seed)
    if kind == "two occasions":
        options = SamplerOptions(walkers=16, max_steps=2_000, seed=seed)
        found = estimate(sample, TERMS, "student-t", options)
        low, high = np.quantile(found.coefficients_ms @ MEAN_FRAME, (0.05, 0.95)).tolist()
        return low, high, truth_ms
    design, posterior, center = posterior_of(sample, TERMS, "student-t")
    assert posterior.stretch is not None
    told = posterior.stretch.found
    frame = MEAN_FRAME / design.unit
    spread = np.sqrt(((frame @ told.along) ** 2 @ told.times) / len(sample))
    half = float(stats.t.ppf(0.95, told.dof) * spread)
    middle = float(frame @ center[: len(frame)])
    return middle - half, middle + half, truth_ms


@pytest.mark.slow
@pytest.mark.study
@pytest.mark.parametrize("kind", KINDS)
def test_intervals_of_the_mean_frame_cover_its_cost(
    kind: str, *, full_studies: bool, request: pytest.FixtureRequest
):
    """In .85 to .95 of 200 logs of each kind, but for a roofline in linear terms."""
    if full_studies and kind == "roofline truth":
        reason = "covered in .735: what terms miss by the view is not held by the intervals"
        request.applymarker(pytest.mark.xfail(reason=reason))
    count = WHOLE if full_studies else REDUCED
    found = np.array([interval(kind, seed) for seed in range(count)])
    covered = int(((found[:, 0] <= found[:, 2]) & (found[:, 2] <= found[:, 1])).sum())
    width = float(np.median((found[:, 1] - found[:, 0]) / found[:, 2]))
    print(json.dumps({"kind": kind, "logs": count, "covered": covered / count, "width": width}))
    if full_studies:
        assert LOW <= covered / count <= HIGH
    else:
        assert covered >= stats.binom.ppf(1e-3, count, 0.9)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["independent", "AR 0.9", "slow drift"])
def test_the_quadratic_form_says_what_the_chain_says(kind: str):
    """Ends of the intervals agree to a fifth of their half width."""
    low, high, _ = interval(kind, 3)
    sample, _ = dependent_log(kind, 3)
    options = SamplerOptions(walkers=16, max_steps=1_500)
    chain = estimate(sample, TERMS, "student-t", options).coefficients_ms @ MEAN_FRAME
    ends = np.quantile(chain, (0.05, 0.95))
    assert ends == pytest.approx(np.array([low, high]), abs=0.1 * (high - low))
