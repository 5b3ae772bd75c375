"""Cost models: coefficients by name, and costs by hand."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest

from lodbench.base.arrays import FloatArray
from lodbench.base.errors import InputError
from lodbench.base.predictors import CPU_PREDICTORS, GPU_PREDICTORS
from lodbench.models.machine.cost import CostModel, CpuCostModel, rasterized_triangles
from lodbench.models.scene.levels import LevelTable

MakeLevels = Callable[..., LevelTable]


def test_coefficients_stand_in_the_order_of_the_predictors() -> None:
    """A coefficient by name lands in its column; the others are 0."""
    model = CostModel.of(2.0, {"triangles": 3.0}, {"shaded_samples": 4.0})
    assert model.linear_ms[GPU_PREDICTORS.index("triangles")] == 3.0
    assert model.linear_ms.sum() == 3.0
    assert model.roofline_ms[GPU_PREDICTORS.index("shaded_samples")] == 4.0
    assert model.has_roofline
    assert not CostModel.of(2.0, {"triangles": 3.0}).has_roofline
    cpu = CpuCostModel.of(1.0, {"comparisons": 5.0})
    assert cpu.linear_ms[CPU_PREDICTORS.index("comparisons")] == 5.0


class Seen(NamedTuple):
    """A footprint."""

    area_px: FloatArray
    covered_px: FloatArray
    inside_share: FloatArray


def test_costs_of_levels_and_objects_by_hand(make_levels: MakeLevels) -> None:
    """Linear and pixel costs add up; of geometry and pixels in the roofline the larger counts."""
    model = CostModel.of(
        0.0,
        {"triangles": 1e-3, "draw_calls": 0.5, "shaded_samples": 1e-4},
        {"triangles": 2e-3, "shaded_samples": 1e-2},
    )
    linear, geometry = model.level_ms(make_levels([(1000, 100)]))
    assert linear == pytest.approx([1.5, 0.6])
    assert geometry == pytest.approx(np.array(((2.0, 1000.0), (0.2, 100.0))))
    area = np.array([50.0, 50.0])
    cost = model.object_ms(linear, geometry, Seen(area, area, np.ones(2)))
    assert cost == pytest.approx([1.5 + 0.005 + 2.0, 0.6 + 0.005 + 0.5])


def test_rasterized_triangles_by_simulation() -> None:
    """Samples thrown at triangles at random reach as many of them as the formula says."""
    rng = np.random.default_rng(1)
    triangles, samples = 200, 150
    hit = [len(np.unique(rng.integers(triangles, size=samples))) for _ in range(4000)]
    covered = np.array([float(samples)])
    expected = rasterized_triangles(np.array([float(triangles)]), covered, np.ones(1))
    assert expected[0] == pytest.approx(np.mean(hit), rel=0.003)


def test_rasterized_triangles_have_their_limits() -> None:
    """Far away each sample reaches its own triangle; near by all in the picture are."""
    triangles = np.array([1e6, 10.0, 0.0, 10.0])
    covered, inside = np.array([100.0, 1e6, 100.0, 1e6]), np.array([1.0, 1.0, 1.0, 0.25])
    found = rasterized_triangles(triangles, covered, inside)
    assert found == pytest.approx([100.0, 10.0, 0.0, 2.5], rel=1e-4)


def test_rasterized_triangles_are_charged_each(make_levels: MakeLevels) -> None:
    """A cost per rasterized triangle is added for what the level and the view come to."""
    model = CostModel.of(0.0, {"triangles": 1e-3, "rasterized_triangles": 1e-2})
    linear, geometry = model.level_ms(make_levels([(100,)]))
    covered = np.array([100.0])
    cost = model.object_ms(linear, geometry, Seen(covered, covered, np.ones(1)))
    assert cost == pytest.approx([0.1 + 1.0 * -math.expm1(-1.0)])


@pytest.mark.parametrize("bad", [-1.0, math.nan, math.inf])
def test_impossible_coefficients_are_refused(bad: float) -> None:
    """Negative, NaN and infinite milliseconds are errors wherever they stand."""
    with pytest.raises(InputError, match="base: expected milliseconds >= 0"):
        CostModel.of(bad, {})
    with pytest.raises(InputError, match="linear: expected finite values >= 0"):
        CostModel.of(0.0, {"triangles": bad})
    with pytest.raises(InputError, match="roofline: expected finite values >= 0"):
        CostModel.of(0.0, {}, {"triangles": bad})
    with pytest.raises(InputError, match="cpu base: expected milliseconds >= 0"):
        CpuCostModel.of(bad, {})
    with pytest.raises(InputError, match="cpu linear: expected finite values >= 0"):
        CpuCostModel.of(0.0, {"iterations": bad})


def test_unknown_predictors_are_refused() -> None:
    """A name that is none of the predictors is named, and the known ones are listed."""
    with pytest.raises(InputError, match=r"linear: expected predictors among .*got tris"):
        CostModel.of(0.0, {"tris": 1.0})
    with pytest.raises(InputError, match=r"cpu linear: expected predictors .*got triangles"):
        CpuCostModel.of(0.0, {"triangles": 1.0})
    with pytest.raises(InputError, match="linear_ms: expected shape"):
        CostModel(0.0, np.zeros(2), np.zeros(len(GPU_PREDICTORS)))
