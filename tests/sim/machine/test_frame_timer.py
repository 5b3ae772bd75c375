"""What reaches a policy of past frames: how late, which column, and with which faults."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.models.machine.hardware import HardwareProfile
from lodbench.policies.protocol import Policy
from lodbench.policies.selection import Selection
from lodbench.policies.view import View
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.machine.faults import Faults
from lodbench.sim.machine.frame_timer import FrameNoise

MakePolicy = Callable[..., Policy]
MakeHardware = Callable[..., HardwareProfile]
Reports = list[np.ndarray]


@pytest.fixture
def reported(
    run: Callable[..., FrameLog], scripted: MakePolicy, make_hardware: MakeHardware
) -> Callable[..., tuple[FrameLog, Reports]]:
    """Return a function that runs levels 0, 1, 2, ... and notes the reports of each frame."""

    def replayed(
        frames: int, options: dict[str, Any] | None = None, **hardware: Any
    ) -> tuple[FrameLog, Reports]:
        seen: Reports = []

        def note(view: View, selection: Selection) -> Selection:
            done = view.completed
            columns = (done.cpu_ms, done.gpu_ms, done.work_ms, done.present_ms)
            seen.append(np.stack(columns, axis=1))
            assert len(done) == len(done.frame) == len(seen[-1])
            return selection

        levels = [k % 3 for k in range(frames)]
        machine = make_hardware({"triangles": 0.01}, **hardware)  # 11, 3.5 and 1.5 ms
        return run(scripted(levels, note), frames, hardware=machine, options=options), seen

    return replayed


Reported = Callable[..., tuple[FrameLog, Reports]]


@pytest.mark.parametrize("frames_in_flight", [1, 2, 3, 4])
@pytest.mark.parametrize("delay", [0, 1, 3])
def test_a_gpu_bound_queue_reports_as_late_as_the_law_says(
    reported: Reported, frames_in_flight: int, delay: int
) -> None:
    """Frame t knows of frames up to t - F - delay, and of no other."""
    _, seen = reported(
        20, {"measurement_delay": delay}, frames_in_flight=frames_in_flight, cpu_base_ms=0.001
    )
    expected = [max(0, t - frames_in_flight - delay + 1) for t in range(20)]
    assert [len(report) for report in seen] == expected


def test_reports_are_the_work_times_of_the_log(reported: Reported) -> None:
    """CPU, GPU and the larger of both, as the log has them, to the nanosecond of the clock."""
    log, seen = reported(30, cpu_base_ms=5.0)
    count = len(seen[-1])
    work_ms = np.maximum(log["cpu_ms"], log["gpu_ms"])
    truth = np.stack((log["cpu_ms"], log["gpu_ms"], work_ms), axis=1)[:count]
    assert seen[-1][:, :3] == pytest.approx(truth, abs=1e-6)
    assert {5.0, 11.0} <= set(np.round(seen[-1][:, 2], 3).tolist())


def test_presented_time_is_quantised_and_comes_when_shown(reported: Reported) -> None:
    """Under vsync intervals are whole refreshes, NaN of the first frame and of those to come."""
    log, seen = reported(60, mode="vsync", refresh_hz=100.0, cpu_base_ms=0.001)
    last = seen[-1][:, 3]
    shown = np.diff(log["display_ns"])[: len(last) - 1] / 1e6
    known = ~np.isnan(last[1:])
    assert np.isnan(last[0])
    assert last[1:][known] == pytest.approx(shown[known])
    assert (~known).sum() <= 3
    assert last[1:][known] / 10.0 == pytest.approx(np.round(last[1:][known] / 10.0))
    assert (np.abs(seen[-1][1:, 2] / 10.0 - np.round(seen[-1][1:, 2] / 10.0)) > 0.01).all()


def test_dropped_frames_have_no_present_interval(reported: Reported) -> None:
    """Mailbox: intervals of shown frames span the dropped ones and add up to the time shown."""
    log, seen = reported(300, mode="mailbox", refresh_hz=60.0, cpu_base_ms=0.001)
    dropped = log["display_ns"] == -1
    assert dropped.sum() > 50
    last = seen[-1][:, 3]
    assert np.isnan(last[dropped[: len(last)]]).all()
    known = np.flatnonzero(~np.isnan(last))
    display = log["display_ns"]
    first = int(np.flatnonzero(~dropped)[0])
    assert np.nansum(last) == pytest.approx((display[known[-1]] - display[first]) / 1e6)


@pytest.mark.parametrize(
    ("faults", "share"),
    [({"missing": 0.3}, np.nan), ({"zero": 0.3}, 0.0), ({"saturated_ms": 4.0}, 4.0)],
)
def test_faults_reach_the_policy_and_not_the_log(
    reported: Reported, faults: dict[str, float], share: float
) -> None:
    """Reports are wrong as asked for; the log has what happened."""
    log, seen = reported(400, {"faults": Faults(**faults)}, cpu_base_ms=0.001)
    gpu_ms = seen[-1][:, 1]
    wrong = np.isnan(gpu_ms) if np.isnan(share) else gpu_ms == share
    assert 0.2 < wrong.mean() < 0.4
    assert set(np.round(log["gpu_ms"], 3).tolist()) == {11.0, 3.5, 1.5}
    right = ~wrong
    assert gpu_ms[right] == pytest.approx(log["gpu_ms"][: len(gpu_ms)][right], abs=1e-6)


def test_stale_reports_repeat_the_one_before(reported: Reported) -> None:
    """Where a report differs from the truth, it is the last report again."""
    log, seen = reported(400, {"faults": Faults(stale=0.3)}, cpu_base_ms=0.001)
    gpu_ms = seen[-1][:, 1]
    stale = np.flatnonzero(np.abs(gpu_ms - log["gpu_ms"][: len(gpu_ms)]) > 1e-3)
    assert 0.15 < len(stale) / len(gpu_ms) < 0.4
    assert (gpu_ms[stale] == gpu_ms[stale - 1]).all()


def test_what_was_seen_does_not_change_when_more_arrives(reported: Reported) -> None:
    """Work times reported in one frame are the same in every later one."""
    _, seen = reported(2500, cpu_base_ms=0.001)
    for report in (seen[10], seen[1000], seen[1100]):
        assert (report[:, :3] == seen[-1][: len(report), :3]).all()


def test_noise_is_drawn_in_order() -> None:
    """Numbers come one at a time as from one generator, across blocks."""
    seed = np.random.SeedSequence(3)
    noise = FrameNoise(lambda rng, count: rng.random(count), seed)
    got = [noise.next() for _ in range(2500)]
    assert got == np.random.default_rng(np.random.SeedSequence(3)).random(2500).tolist()
