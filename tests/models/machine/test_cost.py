"""Cost models: coefficients by name, what may not be one, and prices of counts."""

import math

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.base.predictors import CPU_PREDICTORS, GPU_PREDICTORS
from lodbench.models.machine.cost import CostModel, CpuCostModel


def test_coefficients_stand_in_the_order_of_the_predictors() -> None:
    """A coefficient by name lands in its column; the others are 0."""
    model = CostModel.of(2.0, {"triangles": 3.0}, {"shaded_samples": 4.0})
    assert model.linear_ms[GPU_PREDICTORS.index("triangles")] == model.unit_ms("triangles") == 3.0
    assert model.linear_ms.sum() == 3.0
    assert model.roofline_ms[GPU_PREDICTORS.index("shaded_samples")] == 4.0
    assert model.has_roofline
    assert not CostModel.of(2.0, {"triangles": 3.0}).has_roofline
    cpu = CpuCostModel.of(1.0, {"comparisons": 5.0})
    assert cpu.linear_ms[CPU_PREDICTORS.index("comparisons")] == 5.0


def test_counted_frames_by_hand() -> None:
    """Base and counts add up, and what costs nothing need not be counted."""
    counts = {"triangles": np.array([10.0, 20.0]), "draw_calls": np.array([1.0, 2.0])}
    costs = CostModel.of(3.0, {"triangles": 0.5, "draw_calls": 1.0})
    assert costs.counted_ms(counts) == pytest.approx([9.0, 15.0])


def test_cpu_frames_by_hand() -> None:
    """Of 1 + 2·5 + 3·0.5 + 4·0.25 + 7·0.125 ms, all but the first and last are the policy's.

    A count that is charged and not given is an error, never 0.
    """
    model = CpuCostModel.of(
        1.0, {"objects_visited": 5.0, "comparisons": 0.5, "iterations": 0.25, "draw_calls": 0.125}
    )
    counts = {"objects_visited": 2, "comparisons": 3, "iterations": 4, "draw_calls": 7}
    assert model.frame_ms(counts) == (1.0 + 10.0 + 1.5 + 1.0 + 0.875, 10.0 + 1.5 + 1.0)
    with pytest.raises(KeyError, match="draw_calls"):
        model.frame_ms({name: n for name, n in counts.items() if name != "draw_calls"})


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
