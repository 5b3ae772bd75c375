"""Errors of the model, the machine's own noise, drift divided out, and the slope over detail."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from lodbench.analysis.metrics.measured_frames import MeasuredFrames
from lodbench.analysis.validation.measures.frame_errors import (
    FrameErrors,
    cost_ratio,
    detail_error,
    frame_errors,
    summarise_all,
)
from lodbench.analysis.validation.recorded_frames import (
    Measured,
    drift_of,
    stretch_of,
    usual_reference_ms,
)
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.sim.frame_log import COUNTS

WINDOW_S = (0.2, 2.0)


def test_the_repeat_is_the_noise_whatever_was_drawn(
    recorded: Callable[..., dict[str, tuple[Measured, ...]]],
    make_machine: Callable[..., HardwareProfile],
) -> None:
    """The noise of one recording is 5 %, of a policy in closed loop too, whose draws differ.

    The model misses nothing else, so that its scatter is that noise.
    """
    hardware = make_machine(spread=0.0)
    for label, passed in recorded(hardware, ("full", "feedback"), (None, None)).items():
        stretches = [stretch_of(item, WINDOW_S) for item in passed]
        mean = MeasuredFrames(passed[0].frames, *WINDOW_S)
        errors = summarise_all([frame_errors(stretches, mean, hardware)])
        assert errors is not None
        assert errors.noise_pct == pytest.approx(5.0, rel=0.25), label
        assert errors.excess == pytest.approx(1.0, rel=0.3), label


def test_a_repeat_that_draws_twice_as_much_is_no_noise(
    recorded: Callable[..., dict[str, tuple[Measured, ...]]],
    make_machine: Callable[..., HardwareProfile],
) -> None:
    """Raw, the second recording takes longer; for what it drew, it takes what it should."""
    hardware = make_machine(spread=0.0, noise=0.0)
    fine, coarse = recorded(hardware, ("full", "static-screen"), (None,)).values()
    stretches = [stretch_of(item, WINDOW_S) for item in (*coarse, *fine)]
    errors = summarise_all([frame_errors(stretches, stretches[0].run, hardware)])
    assert errors is not None
    assert errors.again is not None
    assert errors.repeat is not None
    assert errors.again.mean_pct > 50.0
    assert (errors.repeat.mean_pct, errors.noise_pct) == pytest.approx((0.0, 0.0), abs=1e-3)


def test_drift_is_divided_out(
    recorded: Callable[..., dict[str, tuple[Measured, ...]]],
    make_machine: Callable[..., HardwareProfile],
) -> None:
    """Frames and reference slow down together by a fifth: corrected, nothing of it is left."""
    hardware = make_machine(spread=0.0, noise=0.0)
    whole = recorded(hardware, ("full",), (None,))["full"][0]
    slow = np.linspace(0.9, 1.1, len(whole.frames))
    counts = whole.frames.counts.copy()
    counts[:, COUNTS.index("gpu_ms")] *= slow
    frames = replace(whole.frames, counts=counts)
    item = Measured(frames, whole.counts, reference_ms=3.0 * slow)
    stretch = stretch_of(item, WINDOW_S)
    usual_ms = usual_reference_ms([item])
    assert usual_ms == pytest.approx(3.0)
    raw = frame_errors([stretch], stretch.run, hardware)
    corrected = frame_errors([stretch], stretch.run, hardware, usual_ms)
    first, second = summarise_all([raw]), summarise_all([corrected])
    assert first is not None
    assert second is not None
    assert first.model.sd_pct > 4.0
    assert second.model.sd_pct == pytest.approx(0.0, abs=1e-3)
    assert second.model.mean_pct == pytest.approx(0.0, abs=1e-3)
    drift = drift_of([item])
    assert drift is not None
    assert (drift.low_pct, drift.high_pct) == pytest.approx((-9.0, 9.0), abs=0.1)
    assert usual_reference_ms([item, Measured(frames, whole.counts)]) is None


def test_the_slope_is_that_of_the_error_over_detail() -> None:
    """An error that rises from −20 to +20 % with the share drawn has a slope of +40."""
    share = np.linspace(0.0, 1.0, 101)
    measured = np.full(101, 10.0)
    predicted = measured * (0.8 + 0.4 * share)
    found = detail_error(FrameErrors({"model": np.stack((predicted, measured))}), share)
    assert found is not None
    assert found.slope_pct == pytest.approx(40.0)
    assert found.share == pytest.approx((0.05, 0.95))
    assert found.quarters_pct == pytest.approx((-15.0, -5.0, 5.0, 15.0), abs=0.3)
    same = detail_error(FrameErrors({"model": np.stack((predicted, measured))}), np.ones(101))
    assert same is not None
    assert same.slope_pct is None


def test_the_cost_ratio_is_the_median_of_measured_over_predicted() -> None:
    """One frame of ten times does not move it."""
    times = np.array([[1.0, 1.0, 1.0], [2.0, 2.0, 20.0]])
    assert cost_ratio(FrameErrors({"model": times})) == pytest.approx(2.0)
    nothing = np.array([[0.0, 1.0], [5.0, 3.0]])
    assert cost_ratio(FrameErrors({"model": nothing})) == pytest.approx(3.0)
    assert cost_ratio(FrameErrors({"model": nothing[:, :1]})) is None
