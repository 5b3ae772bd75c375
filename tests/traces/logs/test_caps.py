"""Caps: found where they are, and not in the times of honest renderers."""

import numpy as np
import pytest

from lodbench.traces.logs.checks.caps import capped_at_hz


@pytest.mark.parametrize("rate", [30.0, 59.94, 72.0, 119.88, 144.0])
@pytest.mark.parametrize("jitter", [0.01, 0.1, 0.5, 1.0])
def test_vsync_is_found_through_jitter(rate: float, jitter: float):
    """Presents at a refresh, some of them at two, whatever the clock's jitter below 0.15 of it."""
    rng = np.random.default_rng(7)
    period = 1e3 / rate
    moments = np.cumsum(rng.choice([1, 2], 1_000, p=[0.97, 0.03])) * period
    moments += rng.normal(0.0, min(jitter, 0.15 * period), 1_000)
    assert capped_at_hz(np.diff(moments)) == pytest.approx(rate, rel=2e-3)


@pytest.mark.parametrize("middle_ms", [0.01, 0.03, 0.2])
def test_a_gpu_that_is_nearly_idle_has_no_cap(middle_ms: float):
    """Times of hundredths of a millisecond, in ticks of 1.024 µs, some of them twice as long.

    Each is a hundredth of a refresh or less, so that none is at a whole number of them.
    """
    rng = np.random.default_rng(3)
    time_ms = middle_ms * rng.choice([1, 2], 1_000, p=[0.9, 0.1]) * rng.normal(1.0, 0.002, 1_000)
    assert capped_at_hz(1.024e-3 * np.rint(time_ms / 1.024e-3)) is None


def test_a_renderer_that_follows_its_load_near_a_refresh_is_honest():
    """Within 3 % of 60 Hz, but explained by triangles: none of 30 logs is refused."""
    refused = 0
    for seed in range(30):
        rng = np.random.default_rng(seed)
        triangles = rng.uniform(1e5, 3e6, 600)
        frame_ms = 16.4 + 0.5 * triangles / 3e6 + rng.normal(0.0, 0.03, 600)
        refused += capped_at_hz(frame_ms, triangles[:, np.newaxis]) is not None
    assert refused == 0


def test_free_renderers_of_all_speeds_are_honest():
    """From 0.05 to 40 ms, with load that swings: none is refused."""
    for seed in range(60):
        rng = np.random.default_rng(seed)
        load = 1.0 + 0.4 * np.sin(np.arange(800) / rng.uniform(5.0, 60.0))
        ln_ms = rng.uniform(float(np.log(0.05)), float(np.log(40.0)))
        frame_ms = np.exp(ln_ms) * load
        frame_ms *= 1.0 + 0.05 * rng.standard_normal(800)
        assert capped_at_hz(frame_ms) is None, seed


def test_constant_intervals_at_a_refresh_are_capped_unless_load_explains_them():
    """16.67 ms with 0.6 % of noise is a cap; the same spread from triangles is not."""
    rng = np.random.default_rng(1)
    noise = rng.normal(0.0, 0.1, 1_000)
    assert capped_at_hz(1e3 / 60.0 + noise) == 60.0
    assert capped_at_hz(1e3 / 60.0 + noise, (noise + 5.0)[:, np.newaxis]) is None
