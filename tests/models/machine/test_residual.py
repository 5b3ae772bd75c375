"""Noise about a cost model: its scale, its tails, its correlation over frames."""

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.machine.residual import Residual


def test_no_scale_means_no_noise():
    """Without scale every factor is exactly 1."""
    rng = np.random.default_rng(0)
    assert (Residual("gaussian", 0.0).factors(rng, 10) == 1.0).all()
    assert (Residual().factors(rng, 10) == 1.0).all()


@pytest.mark.parametrize("correlation", [0.0, 0.9])
def test_correlation_leaves_the_variance(correlation: float):
    """200,000 Gaussian factors have the scale asked for and the correlation asked for."""
    residual = Residual("gaussian", 0.05, floor=0.0, correlation=correlation)
    z = (residual.factors(np.random.default_rng(1), 200_000) - 1.0) / 0.05
    assert z.std() == pytest.approx(1.0, abs=0.03)
    assert np.corrcoef(z[1:], z[:-1])[0, 1] == pytest.approx(correlation, abs=0.01)


def test_correlated_noise_follows_its_recursion():
    """With correlation c, factor k is c times the one before plus sqrt(1 - c²) of fresh noise."""
    plain = Residual("gaussian", 0.1, floor=0.0).factors(np.random.default_rng(2), 4) - 1.0
    mixed = Residual("gaussian", 0.1, floor=0.0, correlation=0.6)
    expected = [plain[0]]
    for fresh in plain[1:]:
        expected.append(0.6 * expected[-1] + 0.8 * fresh)
    got = mixed.factors(np.random.default_rng(2), 4) - 1.0
    assert got == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("kind", ["gaussian", "student-t", "lognormal"])
def test_no_factor_falls_below_the_floor(kind: str):
    """However heavy the tails, a frame takes at least the floor's share of its mean."""
    residual = Residual(kind, 0.8, dof=2.0, floor=0.5)  # pyright: ignore[reportArgumentType]  # a str here
    factors = residual.factors(np.random.default_rng(3), 10_000)
    assert factors.min() == 0.5


@pytest.mark.parametrize("wrong", [-0.1, 1.0, float("nan")])
def test_correlation_outside_its_range_is_refused(wrong: float):
    """1 would never change, a negative value is not what slow scenes do."""
    with pytest.raises(InputError, match="correlation in"):
        Residual("gaussian", 0.1, correlation=wrong)


def test_moments_of_each_kind():
    """200,000 factors have the mean and deviation that their distribution prescribes."""
    rng = np.random.default_rng(5)
    gaussian = Residual("gaussian", 0.1, floor=0.0).factors(rng, 200_000)
    assert (gaussian.mean(), gaussian.std()) == pytest.approx((1.0, 0.1), abs=2e-3)
    student = Residual("student-t", 0.1, dof=6.0, floor=0.0).factors(rng, 200_000)
    deviation = 0.1 * np.sqrt(6.0 / 4.0)  # of Student's t: sqrt(dof / (dof - 2))
    assert (student.mean(), student.std()) == pytest.approx((1.0, deviation), abs=3e-3)
    lognormal = np.log(Residual("lognormal", 0.3, floor=0.0).factors(rng, 200_000))
    assert (lognormal.mean(), lognormal.std()) == pytest.approx((0.0, 0.3), abs=5e-3)


@pytest.mark.parametrize(
    "wrong",
    [{"scale": -0.1}, {"scale": np.nan}, {"dof": 0.0}, {"floor": -0.1}, {"floor": 1.1}],
)
def test_impossible_residuals_are_refused(wrong: dict[str, float]):
    """A negative scale, no degrees of freedom and a floor above the mean are errors."""
    with pytest.raises(InputError, match="expected scale >= 0, dof > 0 and floor in"):
        Residual("student-t", **wrong)  # pyright: ignore[reportArgumentType]  # broken on purpose


def test_spikes_hit_their_share_and_only_prolong():
    """Of 200,000 frames 2 % are hit, none is shortened, and those hit take 1.4 times as long."""
    residual = Residual(spike_share=0.02, spike_scale=0.4)
    factors = residual.spikes(np.random.default_rng(6), 200_000)
    hit = factors > 1.0
    assert factors.min() == 1.0
    assert hit.mean() == pytest.approx(0.02, rel=0.05)
    assert factors[hit].mean() == pytest.approx(1.4, rel=0.02)
    assert np.quantile(factors[hit], 0.9) == pytest.approx(1.0 + 0.4 * np.log(10.0), rel=0.05)
    assert (Residual(spike_scale=0.4).spikes(np.random.default_rng(6), 1000) == 1.0).all()
