"""Shares of variance: worked by hand, against known Sobol indices, and over many noisy studies."""

import numpy as np
import pytest
from scipy.stats import sobol_indices, uniform

from lodbench.analysis.study.sensitivity import FEWEST_SEEDS, Shares, split_variance
from lodbench.base.arrays import FloatArray

A = np.array([0.0, 1.0, 2.0])
B = np.array([0.0, 4.0])


def values_of(shares: Shares | None) -> tuple[list[float], float, float | None]:
    """Return the shares of axes, of what is together, and of noise."""
    assert shares is not None
    noise = None if shares.noise is None else shares.noise.value
    return [axis.value for axis in shares.axes], shares.together.value, noise


def test_an_additive_design_is_the_sum_of_its_axes() -> None:
    """By hand: Var(a) = 2/3 and Var(b) = 4 over their values, so 1/7 and 6/7 of 14/3."""
    shares = split_variance((A[:, None] + B)[..., None])
    axes, together, noise = values_of(shares)
    assert axes == pytest.approx([1 / 7, 6 / 7])
    assert together == pytest.approx(0.0, abs=1e-12)
    assert noise is None
    assert shares is not None
    assert shares.variance == pytest.approx(14 / 3)
    assert shares.axes[0].low is None


def test_a_pure_interaction_has_no_main_effect() -> None:
    """Of y = x z with x and z of -1 and 1, each mean is 0: all of it is what they do together."""
    sign = np.array([-1.0, 1.0])
    axes, together, _ = values_of(split_variance((sign[:, None] * sign)[..., None]))
    assert axes == pytest.approx([0.0, 0.0], abs=1e-12)
    assert together == pytest.approx(1.0)


def test_two_seeds_worked_by_hand() -> None:
    """One axis of two values, seeds that agree on the effect up to a part that cancels.

    Runs are 0 and 4 under one seed, 2 and 2 under the other.  Centred effects are (-2, 2) and
    (0, 0), whose products are 0: no effect that both seeds show.  Each combination has a variance
    of 2 over its seeds, by (0 - 2)^2 / 2 and (4 - 2)^2 / 2, and that is all.
    """
    axes, together, noise = values_of(split_variance(np.array([[0.0, 2.0], [4.0, 2.0]])))
    assert axes == pytest.approx([0.0], abs=1e-12)
    assert together == pytest.approx(0.0, abs=1e-12)
    assert noise == pytest.approx(1.0)


def test_common_seeds_do_not_blur_an_effect() -> None:
    """What a seed adds to all runs alike is noise of a run, and no part of an axis."""
    shift = np.array([0.0, 10.0, -10.0])
    shares = split_variance(np.asarray((A[:, None] + B)[..., None] + shift, dtype=np.float64))
    axes, _, noise = values_of(shares)
    # By hand: variance of the three shifts as a sample is 100, beside 2/3 + 4.
    total = 100.0 + 14 / 3
    assert axes == pytest.approx([2 / 3 / total, 4 / total])
    assert noise == pytest.approx(100.0 / total)


def test_what_does_not_vary_has_no_shares() -> None:
    """A constant has no variance to split, nor has one that rounding alone moves."""
    assert split_variance(np.full((3, 2, 2), 0.1)) is None
    assert (
        split_variance(
            np.asarray(
                np.full((3, 2, 2), 1e6) + np.arange(12).reshape(3, 2, 2) * 1e-10, dtype=np.float64
            )
        )
        is None
    )


def ishigami(x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """Return the function of Ishigami and Homma, 1990, with a = 7 and b = 0.1."""
    return np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)


def test_ishigami_has_its_known_indices() -> None:
    """On a grid of 24 midpoints an axis, as the integrals say and as scipy's estimator finds.

    By the integrals, with a = 7, b = 0.1: V1 = (1 + b pi^4 / 5)^2 / 2, V2 = a^2 / 8 and V = V1 + V2
    + 8 b^2 pi^8 / 225.
    """
    points = np.pi * (2.0 * (np.arange(24) + 0.5) / 24 - 1.0)
    grid = ishigami(*np.meshgrid(points, points, points, indexing="ij"))
    axes, together, _ = values_of(split_variance(grid[..., None]))
    first, second = 0.5 * (1.0 + 0.1 * np.pi**4 / 5.0) ** 2, 49.0 / 8.0
    total = first + second + 8.0 * 0.01 * np.pi**8 / 225.0
    assert axes == pytest.approx([first / total, second / total, 0.0], abs=5e-3)
    assert together == pytest.approx(1.0 - (first + second) / total, abs=5e-3)
    independent = sobol_indices(
        func=lambda x: ishigami(*x),
        n=4096,
        dists=[uniform(-np.pi, 2.0 * np.pi)] * 3,  # pyright: ignore[reportArgumentType]  # as documented
        rng=np.random.default_rng(0),
    )
    assert axes == pytest.approx(independent.first_order, abs=0.03)


def test_few_noisy_seeds_are_not_taken_for_effects() -> None:
    """Of an axis that does nothing, the mean share over many studies is 0, not that of its noise.

    Uncorrected it would be about 3/8: of four values with a variance of 1/2 each, 3/4.
    """
    rng = np.random.default_rng(5)
    found = [split_variance(rng.standard_normal((4, 2))) for _ in range(2000)]
    shares = np.array([item.axes[0].value for item in found if item is not None])
    assert abs(shares.mean()) < 4.0 * shares.std() / np.sqrt(len(shares))


@pytest.mark.slow
@pytest.mark.parametrize("seeds", [FEWEST_SEEDS, 8])
def test_intervals_cover_the_truth(seeds: int) -> None:
    """Nine in ten studies hold the shares that infinitely many seeds would find."""
    rng = np.random.default_rng(seeds)
    effect = A[:, None] + B + 0.3 * A[:, None] * B
    noise = 2.0
    total = effect.var() + noise**2
    truth = [effect.mean(axis=1).var() / total, effect.mean(axis=0).var() / total]
    truth.append(noise**2 / total)
    held = np.zeros(3)
    for _ in range(400):
        runs = effect[..., None] + noise * rng.standard_normal((3, 2, seeds))
        shares = split_variance(runs)
        assert shares is not None
        assert shares.noise is not None
        for at, share in enumerate((*shares.axes, shares.noise)):
            assert share.low is not None
            assert share.high is not None
            held[at] += share.low <= truth[at] <= share.high
    # Two standard errors of 400 trials at .9 are .03; the shape of a ratio costs some more.
    assert (held / 400 > 0.84).all()
    assert (held / 400 < 0.97).all()
