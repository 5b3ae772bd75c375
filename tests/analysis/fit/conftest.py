"""Synthetic logs whose costs are known."""

from collections.abc import Callable

import numpy as np
import pytest

from lodbench.analysis.fit.fit_frames import Sample

BASE_MS, DRAW_MS, TRIANGLE_MS = 4.0, 0.02, 5e-6

MakeSample = Callable[..., Sample]


def synthetic(kind: str = "clean", *, seed: int = 0, frames: int = 150) -> Sample:
    """Return frames of 4 ms + 20 us a draw + 5 ns a triangle, 0.5 ms of noise.

    "outliers": one frame in twenty takes 1.5 to 4 times as long; "heteroscedastic": noise is 6 % of
    the time; "collinear": 5,000 triangles a draw, to 1 %; "correlated": noise of successive frames
    is an autoregression with 0.8.
    """
    kinds = ("clean", "outliers", "heteroscedastic", "collinear", "correlated")
    rng = np.random.default_rng((seed, 77, kinds.index(kind)))
    draws, triangles = rng.uniform(50, 400, frames), rng.uniform(2e5, 2e6, frames)
    if kind == "collinear":
        draws = triangles / 5e3 * (1.0 + 0.01 * rng.standard_normal(frames))
    mean = BASE_MS + DRAW_MS * draws + TRIANGLE_MS * triangles
    noise = rng.standard_normal(frames)
    if kind == "correlated":
        for k in range(1, frames):
            noise[k] = 0.8 * noise[k - 1] + 0.6 * noise[k]
    time_ms = mean * (1.0 + 0.06 * noise) if kind == "heteroscedastic" else mean + 0.5 * noise
    if kind == "outliers":
        slow = rng.random(frames) < 0.05
        time_ms[slow] *= rng.uniform(1.5, 4.0, slow.sum())
    return Sample(
        ("draw_calls", "triangles"),
        np.column_stack([draws, triangles]),
        time_ms,
        np.zeros(frames, dtype=np.int64),
    )


@pytest.fixture(scope="session")
def make_sample() -> MakeSample:
    """Return `synthetic`."""
    return synthetic


@pytest.fixture(scope="session")
def truth_ms() -> tuple[float, float, float]:
    """Return base, cost of a draw and cost of a triangle of `synthetic`."""
    return BASE_MS, DRAW_MS, TRIANGLE_MS
