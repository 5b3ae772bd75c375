"""Percentile, maximum and visible share of errors, against a plain sort in every frame."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from lodbench.sim.accounting.screen_errors import ScreenErrors

VISIBLE_PX = 1.0


def test_errors_are_those_of_a_sort() -> None:
    """However errors jump, and where nearly all are 0; by area, in the worse of two pictures."""
    rng, errors = np.random.default_rng(4), ScreenErrors(VISIBLE_PX)
    lens = SimpleNamespace(scale_px=np.full(60, 500.0), radius_m=np.full(60, 1.0))
    for frame in range(200):
        n = 60 if frame % 7 else 0
        distance_m, areas_px = rng.uniform(0.5, 200.0, 60), tuple(rng.uniform(1.0, 9.0, (2, 60)))
        error_m = rng.uniform(0.0, 10.0 ** rng.integers(-4, 2), 60)
        error_m[rng.random(60) < rng.choice([0.0, 0.5, 0.97, 1.0])] = 0.0
        seen = SimpleNamespace(
            lens=lens,
            camera=SimpleNamespace(near_m=0.1),
            distance_m=distance_m,
            areas_px=areas_px,
            nodes=object(),
        )
        drawn: Any = SimpleNamespace(ids=range(n), error_m=error_m, seen=seen)
        sse_px = np.sort(by_node := error_m * 500.0 / np.maximum(distance_m - 1.0, 0.1))
        above_px = np.maximum(by_node - VISIBLE_PX, 0.0)
        beyond_px = max((above_px * area_px).sum() / area_px.sum() for area_px in areas_px)
        expected = (sse_px[56], sse_px[-1], beyond_px) if n else (0.0, 0.0, 0.0)
        np.testing.assert_allclose(errors.of(drawn), expected, rtol=1e-12, atol=0.0)
