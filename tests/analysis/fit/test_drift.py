"""The machine's speed during a recording, and frames that were drawn in another order."""

import dataclasses

import numpy as np
import pytest

from lodbench.analysis.fit.drift import drawing_order, without_drift
from lodbench.analysis.fit.fit import FitOptions, Source, fit_logs
from lodbench.analysis.fit.fit_frames import Origin, gather
from lodbench.analysis.fit.sampling.sampler import SamplerOptions
from lodbench.traces.logs.render_log import RenderLog


def slowing(frames: int = 400) -> RenderLog:
    """Return frames of 10 ms that take 20 % longer at the end, and the reference draws beside."""
    slower = np.linspace(1.0, 1.2, frames)
    recorded = {"reference_before_ms": 2.0 * slower, "reference_after_ms": 2.0 * slower}
    counts = np.arange(1.0, frames + 1.0)[:, np.newaxis]
    return RenderLog(
        "run", "csv", ("triangles",), counts, frame_ms=10.0 * slower, recorded=recorded
    )


def test_drift_is_divided_out_and_told():
    """Every frame takes what the median one did; the second half was 9.5 % slower."""
    steady, drift = without_drift(slowing(), "frame_ms")
    assert steady.time("frame_ms") == pytest.approx(np.full(400, 11.0), rel=2e-3)
    assert drift is not None
    assert drift.second_half_pct == pytest.approx(100.0 * (1.15 / 1.05 - 1.0), abs=0.1)
    assert drift.range_pct == pytest.approx(100.0 * 0.9 * 0.2 / 1.1, abs=0.2)


def test_the_first_pass_sets_the_speed():
    """A second pass on a machine that is twice as slow takes what the first one did."""
    log = slowing(200)
    slow = np.repeat([1.0, 2.0], 100)
    log = dataclasses.replace(
        log,
        frame_ms=10.0 * slow,
        recorded={
            "reference_before_ms": slow,
            "reference_after_ms": slow,
            "pass": np.repeat([0.0, 1.0], 100),
        },
    )
    assert without_drift(log, "frame_ms")[0].time("frame_ms") == pytest.approx(np.full(200, 10.0))


def test_a_log_without_reference_draws_is_as_it_was():
    """Any engine's log."""
    log = dataclasses.replace(slowing(), recorded={})
    assert without_drift(log, "frame_ms") == (log, None)


def test_drift_of_a_log_that_is_predicted_is_divided_out_too():
    """A fit to steady frames, and the same frames on a machine that grows slower by half."""
    rng = np.random.default_rng(0)
    counts = rng.uniform(1e5, 1e6, (200, 1))
    time_ms = (2.0 + 1e-5 * counts[:, 0]) * (1.0 + 0.01 * rng.standard_normal(200))
    log = RenderLog("walk", "csv", ("triangles",), counts, frame_ms=time_ms)
    slower = np.linspace(0.75, 1.25, 200)
    later = dataclasses.replace(
        log, frame_ms=slower * time_ms, recorded={"reference_before_ms": slower}
    )
    options = FitOptions("triangles", heldout="none", sampler=SamplerOptions(max_steps=200))
    (predicted,) = fit_logs([Source(log)], "frame_ms", options, transfer=[later]).transfer
    assert predicted.error_pct_sd == pytest.approx(1.0, rel=0.2)


def test_noise_of_one_reference_draw_is_not_the_frame_s():
    """References with 20 % of noise, frames with none: less than half of it goes over."""
    rng = np.random.default_rng(0)
    log = dataclasses.replace(
        slowing(),
        frame_ms=np.full(400, 10.0),
        recorded={"reference_before_ms": 1.0 + 0.2 * rng.standard_normal(400)},
    )
    spread = without_drift(log, "frame_ms")[0].time("frame_ms").std() / 10.0
    assert 0.0 < spread < 0.2 / 2.0


def test_frames_are_gathered_in_the_order_in_which_they_were_drawn():
    """Two passes of four views, shuffled: pass by pass, with the place of each on the path."""
    log = RenderLog(
        "run",
        "csv",
        ("triangles",),
        np.arange(1.0, 9.0)[:, np.newaxis],
        gpu_ms=np.arange(1.0, 9.0),
        header=(("scene", "plaza"), ("occasion", "monday")),
        recorded={
            "drawn_at": np.array([2.0, 0.0, 3.0, 1.0, 1.0, 0.0, 2.0, 3.0]),
            "pass": np.repeat([0.0, 1.0], 4),
        },
    )
    assert drawing_order(log).tolist() == [1, 3, 0, 2, 5, 4, 6, 7]
    sample, _ = gather([log], ["triangles"], "gpu_ms", 0)
    assert sample.time_ms.tolist() == [2.0, 4.0, 1.0, 3.0, 6.0, 5.0, 7.0, 8.0]
    assert sample.path is not None
    assert sample.path.tolist() == [1, 3, 0, 2, 1, 0, 2, 3]
    assert sample.origin(0) == Origin("plaza", "monday")
    unknown = dataclasses.replace(log, recorded={**log.recorded, "pass": np.full(8, np.nan)})
    sample, _ = gather([unknown], ["triangles"], "gpu_ms", 0)
    assert sample.path is not None
    assert sorted(sample.path.tolist()) == list(range(8))  # no pass said: all of one
