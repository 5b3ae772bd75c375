"""Pacing and latency limits: timelines worked by hand, and what no pacing may cost."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from lodbench.models.machine.hardware import DisplayMode, Pacing
from lodbench.sim.pipeline.pacing import SAFETY_NS
from lodbench.sim.pipeline.pipeline import Pipeline

MS = 1_000_000
REFRESH_MS = 1e3 / 60.0
RunFrames = Callable[..., Pipeline]

pacings = st.sampled_from(["limiter", "just-in-time"])
modes = st.sampled_from(["immediate", "vsync", "vrr"])


def in_ms(times_ns: object) -> list[float]:
    """Return times of a pipeline in milliseconds."""
    return (np.array(times_ns) / MS).tolist()


def lag_ms(pipeline: Pipeline) -> NDArray[np.float64]:
    """Return from input to display of each frame."""
    return (np.array(pipeline.display_ns) - np.array(pipeline.input_ns)) / MS


def light(run_frames: RunFrames, **display: object) -> Pipeline:
    """Return 100 frames of 1 ms of CPU and 3 ms of GPU under vsync at 60 Hz, two in flight."""
    return run_frames([MS] * 100, [3 * MS] * 100, mode="vsync", **display)


def test_light_work_without_pacing_lags_by_all_that_queues_hold(run_frames: RunFrames) -> None:
    """Two frames in flight and three images: four refreshes, less the GPU's 3 ms, are 63.7 ms."""
    assert lag_ms(light(run_frames))[10:] == pytest.approx(
        np.full(90, 4 * REFRESH_MS - 3.0), abs=1e-5
    )


def test_drawing_less_lags_more_where_nothing_paces(run_frames: RunFrames) -> None:
    """17 ms of GPU lag by 42.0 ms and 3 ms by 63.7; just in time it is 27.0 and 5.0."""
    expected = {"none": (63.67, 41.97), "just-in-time": (5.0, 26.97)}
    for pacing, (few, many) in expected.items():
        heavy = run_frames([MS] * 600, [17 * MS] * 600, mode="vsync", pacing=pacing)
        assert lag_ms(light(run_frames, pacing=pacing))[10:].mean() == pytest.approx(few, abs=0.01)
        assert lag_ms(heavy)[100:].mean() == pytest.approx(many, abs=0.3)


def test_just_in_time_a_frame_lags_by_its_work_and_the_safety(run_frames: RunFrames) -> None:
    """1 ms of CPU, 3 ms of GPU and 1 ms of safety end at the refresh: 5 ms, every refresh used."""
    pipeline = light(run_frames, pacing="just-in-time")
    assert lag_ms(pipeline)[5:] == pytest.approx(np.full(95, 4.0 + SAFETY_NS / MS), abs=1e-5)
    assert np.diff(np.array(pipeline.display_ns)) / MS == pytest.approx(
        np.full(99, REFRESH_MS), abs=1e-5
    )


def test_the_first_frames_just_in_time(run_frames: RunFrames) -> None:
    """At 100 Hz two frames begin before anything is known; the third is the last that is late.

    When frame 0 is done, at 4 ms, frame 2 is begun for the refresh at 20 ms, which frame 1 takes.
    From what is shown at 10 ms, frame 3 knows that its refresh is at 40.
    """
    pipeline = run_frames(
        [MS] * 5, [3 * MS] * 5, mode="vsync", refresh_hz=100.0, pacing="just-in-time"
    )
    assert in_ms(pipeline.input_ns) == [0, 1, 15, 35, 45]
    assert in_ms(pipeline.display_ns) == [10, 20, 30, 40, 50]


def test_just_in_time_comes_back_after_a_hitch(run_frames: RunFrames) -> None:
    """A frame of 43 ms and the three after it, begun by then, are late; then the lag is as ever."""
    gpu = [3 * MS] * 100
    gpu[50] = 43 * MS
    lag = lag_ms(run_frames([MS] * 100, gpu, mode="vsync", pacing="just-in-time"))
    assert (lag[50:54] > 2 * REFRESH_MS).all()
    assert lag[54:] == pytest.approx(np.full(46, 5.0), abs=1e-5)


def test_just_in_time_keeps_a_gpu_busy_that_cannot_hold_the_refresh(run_frames: RunFrames) -> None:
    """At once and with 20 ms of GPU: submitted 1 ms before the GPU is free, and 50 fps as ever."""
    pipeline = run_frames([2 * MS] * 30, [20 * MS] * 30, pacing="just-in-time")
    assert np.diff(np.array(pipeline.display_ns)).tolist() == [20 * MS] * 29
    assert lag_ms(pipeline)[5:].tolist() == [23.0] * 25


def test_a_limiter_begins_frames_an_interval_apart(run_frames: RunFrames) -> None:
    """At 50 fps 4 ms of work begin every 20 ms; work of 30 ms delays and is not made up for."""
    pipeline = run_frames([MS] * 3, [3 * MS] * 3, pacing="limiter", limiter_hz=50.0)
    assert in_ms(pipeline.input_ns) == [0, 20, 40]
    late = run_frames([MS, 30 * MS, MS, MS], [1] * 4, pacing="limiter", limiter_hz=50.0)
    assert in_ms(late.input_ns) == [0, 20, 50, 70]


def test_a_limiter_of_the_refresh_leaves_one_refresh_of_lag(run_frames: RunFrames) -> None:
    """Frames begin at refreshes and are shown by the next, but for the drift of a nanosecond."""
    lag = lag_ms(light(run_frames, pacing="limiter"))
    assert lag == pytest.approx(np.full(100, REFRESH_MS), abs=1e-4)


@pytest.mark.parametrize("limit", [1, 2, 3])
def test_a_latency_limit_is_the_lag_of_light_work_in_refreshes(
    run_frames: RunFrames, limit: int
) -> None:
    """A frame begins when the one `limit` before it is shown, and is shown `limit` refreshes on."""
    pipeline = light(run_frames, latency_limit=limit)
    begun, shown = np.array(pipeline.input_ns), np.array(pipeline.display_ns)
    assert lag_ms(pipeline)[10:] == pytest.approx(np.full(90, limit * REFRESH_MS), abs=1e-5)
    for now in begun:
        assert np.count_nonzero((begun <= now) & (now < shown)) <= limit


def test_a_latency_limit_of_one_halves_the_rate_of_what_takes_longer_than_a_refresh(
    run_frames: RunFrames,
) -> None:
    """5 ms of CPU and 15 of GPU overlap no more: 30 fps, where just in time keeps 60."""
    work = [5 * MS] * 60, [15 * MS] * 60
    limited = run_frames(*work, mode="vsync", latency_limit=1)
    paced = run_frames(*work, mode="vsync", pacing="just-in-time")
    steps = [np.diff(np.array(of.display_ns))[10:].mean() / MS for of in (limited, paced)]
    assert steps == pytest.approx([2 * REFRESH_MS, REFRESH_MS], abs=1e-4)


@pytest.mark.parametrize("pacing", ["none", "limiter", "just-in-time"])
@pytest.mark.parametrize("latency_limit", [0, 1, 2])
def test_mailbox_ends_in_every_pacing(
    run_frames: RunFrames, pacing: Pacing, latency_limit: int
) -> None:
    """Dropped frames leave the queue of the latency limit too: all 50 frames are done."""
    pipeline = run_frames(
        [MS] * 50, [2 * MS] * 50, 3, mode="mailbox", pacing=pacing, latency_limit=latency_limit
    )
    assert pipeline.completed == 50
    assert pacing == "none" or (np.array(pipeline.display_ns)[3:] >= 0).all()


times = st.integers(MS // 10, 30 * MS)


@given(times, times, st.integers(1, 4), st.sampled_from([2, 3]), modes, pacings)
def test_pacing_lags_no_more_and_shows_no_fewer(
    run_frames: RunFrames,
    cpu_ns: int,
    gpu_ns: int,
    frames_in_flight: int,
    images: int,
    mode: DisplayMode,
    pacing: Pacing,
) -> None:
    """Of even work, whatever the queue, the steady lag falls, and just in time costs no frame.

    A limiter costs those beyond the refresh.  Times end within a beat of work and refresh.
    """
    work = [cpu_ns] * 120, [gpu_ns] * 120, frames_in_flight
    free = run_frames(*work, mode=mode, images=images)
    paced = run_frames(*work, mode=mode, images=images, pacing=pacing)
    assert lag_ms(paced)[20:].mean() <= lag_ms(free)[20:].mean() + REFRESH_MS / 20
    last_ms = free.display_ns[-1] / MS
    if pacing == "limiter":
        last_ms = max(last_ms, 120 * REFRESH_MS + (cpu_ns + gpu_ns) / MS)
    assert paced.display_ns[-1] / MS <= last_ms + 2 * REFRESH_MS


@given(st.lists(st.tuples(times, times), min_size=1, max_size=30), modes, pacings)
def test_a_paced_run_is_the_same_when_it_is_run_again(
    run_frames: RunFrames, work: list[tuple[int, int]], mode: DisplayMode, pacing: Pacing
) -> None:
    """Pacing knows what was measured and nothing else."""
    cpu_ns, gpu_ns = zip(*work, strict=True)
    first, again = (run_frames(cpu_ns, gpu_ns, mode=mode, pacing=pacing) for _ in range(2))
    assert (first.input_ns, first.display_ns) == (again.input_ns, again.display_ns)
