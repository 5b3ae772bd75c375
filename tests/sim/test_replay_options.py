"""Options of a replay are refused by name before anything runs; some of them would never end it."""

from typing import Any

import numpy as np
import pytest

from lodbench.analysis.gate.measurements import MeasureOptions
from lodbench.analysis.study.compare import CompareSettings
from lodbench.base.errors import InputError
from lodbench.sim.replay import ReplayOptions

WHOLE = ("frames", "seed", "measurement_delay", "bound_every", "draw")
REAL = ("budget_ms", "fovy_deg", "crossfade_ms", "visible_px", "memory_bytes")


@pytest.mark.parametrize("value", [2.5, "2", True, np.float64(3.0)])
@pytest.mark.parametrize("name", WHOLE)
def test_whole_numbers_are_whole(name: str, value: Any) -> None:
    """A replay of 2.5 frames has no last frame, and a seed of 1.5 no generator."""
    options: dict[str, Any] = {"budget_ms": 5.0, name: value}
    with pytest.raises(InputError, match=f"{name}: expected a whole number"):
        ReplayOptions(**options)


@pytest.mark.parametrize("value", ["5", True, [5.0]])
@pytest.mark.parametrize("name", REAL)
def test_real_numbers_are_numbers(name: str, value: Any) -> None:
    """A text is no number of milliseconds, and neither is a truth value."""
    options: dict[str, Any] = {"budget_ms": 5.0, name: value}
    with pytest.raises(InputError, match=f"{name}: expected a number"):
        ReplayOptions(**options)


def test_numbers_of_numpy_are_numbers() -> None:
    """What an array holds is as good as what is typed."""
    given: dict[str, Any] = {
        "budget_ms": np.float64(5.0),
        "frames": np.int64(3),
        "seed": np.int32(1),
    }
    options = ReplayOptions(**given)
    assert (options.frames, options.seed) == (3, 1)


def test_faults_are_faults() -> None:
    """Anything else would fail in the middle of a replay."""
    faults: Any = 5
    with pytest.raises(InputError, match="faults: expected a Faults, got 5"):
        ReplayOptions(budget_ms=5.0, faults=faults)


@pytest.mark.parametrize("options", [CompareSettings, MeasureOptions])
@pytest.mark.parametrize("name", ["seeds", "workers"])
def test_scores_are_of_whole_numbers(options: Any, name: str) -> None:
    """Ten and a half seeds or processes are refused, not rounded."""
    with pytest.raises(InputError, match=f"{name}: expected a whole number"):
        options(**{name: 10.5})


@pytest.mark.parametrize("value", [-0.1, float("nan"), float("inf")])
def test_visible_errors_are_pixels(value: float) -> None:
    """Nothing is seen below an endless error, and a negative one is none."""
    with pytest.raises(InputError, match="visible: expected pixels >= 0, got"):
        ReplayOptions(budget_ms=5.0, visible_px=value)
    assert ReplayOptions(budget_ms=5.0, visible_px=0).visible_px == 0
