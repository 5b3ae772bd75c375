"""Several logs: factors integrated out, spreads recovered."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy import stats

from lodbench.analysis.fit.estimate import estimate
from lodbench.analysis.fit.fit_frames import Origin, Sample
from lodbench.analysis.fit.sampling.between_logs import BetweenLogs, Levels, LogSummary
from lodbench.analysis.fit.sampling.likelihood import Expansion, QuadraticLikelihood
from lodbench.analysis.fit.sampling.sampler import SamplerOptions
from lodbench.analysis.fit.terms import parse_terms
from lodbench.base.arrays import FloatArray

MakeSample = Callable[..., Sample]

TERMS = parse_terms("draw_calls,triangles")
NAMES = ("base", "draw_calls", "triangles")


def test_levels_are_those_of_which_there_are_two():
    """One occasion of three scenes has scenes' spreads alone; one log has none."""
    three = [Origin(scene, "monday") for scene in "abc"]
    assert Levels.of(three, NAMES).names == ("scene_sd.base", "scene_sd.triangles")
    assert Levels.of([Origin("a", "monday"), Origin("a", "friday")], NAMES).names == (
        "occasion_sd",
    )
    assert not Levels.of(three[:1], NAMES)


def test_the_likelihood_is_that_of_the_covariance_written_out():
    """Against scipy's multivariate normal, of four logs on two occasions in two scenes."""
    rng = np.random.default_rng(0)
    origins = [Origin(scene, occasion) for scene in "ab" for occasion in "xy"]
    logs = [
        LogSummary(rng.standard_normal((3, 3)), rng.standard_normal(3), origin)
        for origin in origins
    ]
    levels, pooled = Levels.of(origins, NAMES), np.array([4.0, 5.0, 6.0])
    nothing = Expansion(np.zeros(1), 0.0, np.zeros(1), np.zeros((1, 1)))
    noise = QuadraticLikelihood(("log_scale",), np.full(1, -9.0), np.full(1, 9.0), nothing)
    found = BetweenLogs(logs, levels, NAMES, pooled, noise, 1.0)
    theta = np.array([[4.0, 5.0, 6.0, 0.0, 0.1, 0.2, 0.3], [3.0, 6.0, 5.0, 0.0, 0.2, 0.1, 0.4]])
    assert found.names == (
        *NAMES,
        "log_scale",
        "occasion_sd",
        "scene_sd.base",
        "scene_sd.triangles",
    )

    def density(row: np.ndarray) -> float:
        spread = row[4:]
        covariance = np.zeros((12, 12))
        for i, one in enumerate(origins):
            for j, other in enumerate(origins):
                same = np.zeros((3, 3))
                if one.occasion == other.occasion:
                    same += spread[0] ** 2 * np.outer(pooled, pooled)
                if one.scene == other.scene:
                    same += np.diag([spread[1], 0.0, spread[2]]) ** 2 * pooled**2
                block = logs[i].rows @ same @ logs[j].rows.T
                covariance[3 * i : 3 * i + 3, 3 * j : 3 * j + 3] = block
        mean = np.concatenate([log.rows @ row[:3] for log in logs])
        values = np.concatenate([log.values for log in logs])
        priors = np.sum(stats.t.logpdf(spread, 4.0, scale=[0.09, 0.25, 0.25]))
        whole = stats.multivariate_normal(mean, covariance + np.eye(12)).logpdf(values)
        return float(whole + priors)

    values = found(theta)
    assert values[1] - values[0] == pytest.approx(density(theta[1]) - density(theta[0]))


def several(make_sample: MakeSample, scenes: int, occasions: int, seed: int = 0) -> Sample:
    """Return logs of scenes whose triangles differ by 25 %, on occasions that differ by 9 %."""
    rng = np.random.default_rng((seed, 31))
    dear = np.exp(0.25 * rng.standard_normal(scenes))
    slow = np.exp(0.09 * rng.standard_normal(occasions))
    counts, times, origins = list[FloatArray](), list[FloatArray](), list[Origin]()
    for scene in range(scenes):
        for occasion in range(occasions):
            one = make_sample(seed=100 * seed + 10 * scene + occasion)
            triangles_ms = 5e-6 * one.predictors[:, 1] * (dear[scene] - 1.0)
            counts.append(one.predictors)
            times.append((one.time_ms + triangles_ms) * slow[occasion])
            origins.append(Origin(f"scene {scene}", f"day {occasion}"))
    series = np.repeat(np.arange(len(times)), [len(time) for time in times])
    names = ("draw_calls", "triangles")
    return Sample(names, np.vstack(counts), np.concatenate(times), series, tuple(origins))


@pytest.mark.slow
def test_what_differs_between_scenes_and_occasions_is_found(make_sample: MakeSample):
    """Of six scenes and three occasions: both spreads, and costs within their intervals."""
    found = estimate(several(make_sample, 6, 3), TERMS, "student-t", SamplerOptions())
    names, flat = found.chain.names, found.chain.flat
    low, high = np.quantile(flat, (0.02, 0.98), axis=0)
    for name, truth in (("occasion_sd", 0.09), ("scene_sd.triangles", 0.25)):
        assert low[names.index(name)] < truth < high[names.index(name)]
    assert high[names.index("scene_sd.base")] < 0.2
    low, high = np.quantile(found.coefficients_ms, (0.02, 0.98), axis=0)
    assert ((low < [4.0, 0.02, 5e-6]) & (high > [4.0, 0.02, 5e-6])).all()


def test_two_occasions_are_less_sure_than_one(make_sample: MakeSample):
    """The cost of a frame is known to the occasions' spread, and not to that of 300 frames."""
    two = several(make_sample, 1, 2)
    options = SamplerOptions(walkers=16, max_steps=500)
    wide = estimate(two, TERMS, "gaussian", options).coefficients_ms @ [1.0, 225.0, 1.1e6]
    narrow = estimate(
        Sample(two.names, two.predictors, two.time_ms, np.zeros(len(two), dtype=np.int64)),
        TERMS,
        "gaussian",
        options,
    ).coefficients_ms @ [1.0, 225.0, 1.1e6]
    assert wide.std() / wide.mean() == pytest.approx(0.09 / np.sqrt(2.0), rel=0.6)
    assert narrow.std() < 0.5 * wide.std()
