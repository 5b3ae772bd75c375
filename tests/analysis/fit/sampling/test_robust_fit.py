"""Robust non-negative least squares against known coefficients and independent solvers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import optimize, stats

from lodbench.analysis.fit.sampling.robust_fit import robust_nnls

TRUE_BASE, TRUE_SLOPES = 2.0, np.array([0.03, 70e-6])


def frames(rng: np.random.Generator, count: int = 600):
    """Draws and triangles of random frames, and their mean times."""
    predictors = np.column_stack([rng.uniform(10, 200, count), rng.uniform(1e4, 1e6, count)])
    return predictors, TRUE_BASE + predictors @ TRUE_SLOPES


def test_exact_times_give_exact_coefficients():
    """Without noise the truth comes back to nine digits."""
    predictors, times = frames(np.random.default_rng(0))
    fit = robust_nnls(predictors, times)
    assert fit.base_ms == pytest.approx(TRUE_BASE, rel=1e-9)
    assert fit.slopes_ms == pytest.approx(TRUE_SLOPES, rel=1e-9)
    assert fit.scale < 1e-8


def test_one_frame_in_twenty_ten_times_too_long_changes_little():
    """Outliers that ruin least squares move the robust coefficients by under 3 %."""
    rng = np.random.default_rng(1)
    predictors, times = frames(rng)
    times *= 1.0 + 0.03 * rng.standard_normal(len(times))
    times[::20] *= 10.0
    robust = robust_nnls(predictors, times)
    plain = robust_nnls(predictors, times, dof=1e9)
    assert robust.slopes_ms == pytest.approx(TRUE_SLOPES, rel=0.03)
    assert abs(plain.slopes_ms[1] / TRUE_SLOPES[1] - 1.0) > 0.1


def test_the_fit_is_the_fixed_point_of_its_estimating_equation():
    """Weighted residuals are orthogonal to every predictor that is in the model."""
    rng = np.random.default_rng(2)
    predictors, times = frames(rng)
    times *= 1.0 + 0.1 * rng.standard_t(4, len(times)).clip(-5, 5)
    fit = robust_nnls(predictors, times)
    residual = times / fit.predict(predictors) - 1.0
    weight = 5.0 / (4.0 + (residual / fit.scale) ** 2)
    mean = fit.predict(predictors)
    for column in (np.ones(len(times)), *predictors.T):
        pull = weight * residual * column / mean
        assert abs(pull.sum()) < 1e-6 * np.abs(pull).sum()


def test_scale_and_slopes_agree_with_direct_maximum_likelihood():
    """The general minimiser of scipy on the Student-t likelihood of relative residuals agrees."""
    rng = np.random.default_rng(3)
    predictors, mean = frames(rng, 4_000)
    times = mean * (1.0 + 0.05 * rng.standard_t(4, len(mean)).clip(-10, 10))

    def loss(p: np.ndarray) -> float:
        m = p[0] + predictors @ (p[1:3] * TRUE_SLOPES)
        # the location of the quotient, as the estimating equation has it: m enters as a scale only
        density = np.asarray(stats.t.logpdf((times - m) / mean / p[3], 4), dtype=np.float64)
        return len(mean) * float(np.log(p[3])) - float(np.sum(density))

    answer = optimize.minimize(
        loss, [2.0, 1.0, 1.0, 0.05], bounds=[(0, 10), (0, 10), (0, 10), (1e-3, 1)]
    )
    fit = robust_nnls(predictors, times)
    assert fit.slopes_ms / TRUE_SLOPES == pytest.approx(answer.x[1:3], rel=0.01)
    assert fit.scale == pytest.approx(answer.x[3], rel=0.02)


def test_coefficients_are_never_negative():
    """A predictor that goes against the time gets 0, not a negative price."""
    rng = np.random.default_rng(4)
    predictors, times = frames(rng)
    against = np.column_stack([predictors, times.max() - times])
    assert robust_nnls(against, times).slopes_ms[2] == 0.0


@given(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_units_do_not_matter(time_unit: float, count_unit: float):
    """Times in another unit scale all coefficients; counts in another unit scale one."""
    rng = np.random.default_rng(5)
    predictors, times = frames(rng, 60)
    times = times * (1.0 + 0.05 * rng.standard_normal(60))
    fit = robust_nnls(predictors, times)
    other = robust_nnls(predictors * [1.0, count_unit], times * time_unit)
    expected = fit.slopes_ms * time_unit / [1.0, count_unit]
    assert other.slopes_ms == pytest.approx(expected, rel=1e-5)
    assert other.base_ms == pytest.approx(fit.base_ms * time_unit, rel=1e-4, abs=1e-6 * time_unit)
