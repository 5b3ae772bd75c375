"""Timelines of the frame pipeline, worked by hand in milliseconds."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from lodbench.models.machine.hardware import Display, DisplayMode
from lodbench.sim.pipeline.pipeline import Pipeline
from lodbench.sim.pipeline.screens import DROPPED_NS

MS = 1_000_000
RunFrames = Callable[..., Pipeline]


def in_ms(times_ns: Sequence[int]) -> NDArray[np.float64]:
    """Return times of a pipeline in milliseconds."""
    return np.array(times_ns) / MS


def shown_ms(pipeline: Pipeline) -> NDArray[np.float64]:
    """Return display times of the frames that were not dropped."""
    display = np.array(pipeline.display_ns)
    return display[display != DROPPED_NS] / MS


def fps(pipeline: Pipeline) -> float:
    """Return the rate at which frames were shown, the first ten and last two left out."""
    steps = np.diff(shown_ms(pipeline))[10:-2]
    return 1e3 / float(steps.mean())


def test_one_frame_in_flight_runs_cpu_and_gpu_in_turn(run_frames: RunFrames) -> None:
    """With one frame in flight, 3 ms of CPU and 5 ms of GPU follow each other."""
    pipeline = run_frames([3 * MS] * 3, [5 * MS] * 3, 1)
    assert in_ms(pipeline.input_ns).tolist() == [0, 8, 16]
    assert in_ms(pipeline.cpu_end_ns).tolist() == [3, 11, 19]
    assert in_ms(pipeline.gpu_start_ns).tolist() == [3, 11, 19]
    assert in_ms(pipeline.gpu_end_ns).tolist() == [8, 16, 24]
    assert pipeline.display_ns == pipeline.gpu_end_ns
    assert pipeline.completed == 3


def test_cpu_and_gpu_overlap_with_two_frames_in_flight(run_frames: RunFrames) -> None:
    """The CPU works on frame k + 1 while the GPU draws frame k, and waits for a free slot."""
    pipeline = run_frames([3 * MS] * 4, [5 * MS] * 4, 2)
    assert in_ms(pipeline.input_ns).tolist() == [0, 3, 8, 13]
    assert in_ms(pipeline.cpu_end_ns).tolist() == [3, 6, 11, 16]
    assert in_ms(pipeline.gpu_start_ns).tolist() == [3, 8, 13, 18]
    assert in_ms(pipeline.gpu_end_ns).tolist() == [8, 13, 18, 23]


@pytest.mark.parametrize("frames_in_flight", [2, 3, 4])
def test_a_cpu_bound_pipeline_shows_a_frame_per_cpu_time(
    run_frames: RunFrames, frames_in_flight: int
) -> None:
    """10 ms of CPU and 4 ms of GPU: 100 fps and a lag of 14 ms, however many in flight."""
    pipeline = run_frames([10 * MS] * 50, [4 * MS] * 50, frames_in_flight)
    assert fps(pipeline) == pytest.approx(100.0, rel=1e-12)
    lag = in_ms(pipeline.display_ns) - in_ms(pipeline.input_ns)
    assert lag == pytest.approx(np.full(50, 14.0), abs=1e-9)


@pytest.mark.parametrize("frames_in_flight", [1, 2, 3, 4])
def test_lag_of_a_gpu_bound_queue_grows_by_frames_in_flight(
    run_frames: RunFrames, frames_in_flight: int
) -> None:
    """With 10 ms of GPU and a CPU of no time the lag settles at F times 10 ms."""
    pipeline = run_frames([1] * 50, [10 * MS] * 50, frames_in_flight)
    lag_ns = np.array(pipeline.display_ns) - np.array(pipeline.input_ns)
    idle_ns = 1 if frames_in_flight == 1 else 0  # the GPU waits for the CPU's nanosecond
    assert (lag_ns[10:] == frames_in_flight * 10 * MS + idle_ns).all()


@pytest.mark.parametrize(("images", "expected"), [(2, 30.0), (3, 1000.0 / 17.0)])
def test_vsync_with_frames_just_too_long(
    run_frames: RunFrames, images: int, expected: float
) -> None:
    """17 ms at 60 Hz: 30 fps where the GPU waits for a free image of two, 58.8 with three."""
    pipeline = run_frames(
        [MS] * 1200, [17 * MS] * 1200, mode="vsync", refresh_hz=60.0, images=images
    )
    assert fps(pipeline) == pytest.approx(expected, rel=2e-3)
    if images == 2:
        steps = np.diff(np.array(pipeline.display_ns))[2:]
        assert set(steps.tolist()) <= {33_333_333, 33_333_334}


def test_vsync_shows_each_frame_at_the_first_free_vblank(run_frames: RunFrames) -> None:
    """At 100 Hz frames done at 5, 9, 31 and exactly 40 ms are shown at 10, 20, 40 and 50 ms."""
    pipeline = run_frames(
        [0, 0, 0, 0], [5 * MS, 4 * MS, 22 * MS, 9 * MS], 4, mode="vsync", refresh_hz=100.0
    )
    assert in_ms(pipeline.gpu_end_ns).tolist() == [5, 9, 31, 40]
    assert in_ms(pipeline.display_ns).tolist() == [10, 20, 40, 50]


def test_a_frame_done_exactly_at_a_vblank_is_shown_by_it(run_frames: RunFrames) -> None:
    """At 100 Hz a frame done at 10 ms is shown at 10 ms."""
    pipeline = run_frames([0], [10 * MS], mode="vsync", refresh_hz=100.0)
    assert in_ms(pipeline.display_ns).tolist() == [10]


def test_vblanks_do_not_drift(run_frames: RunFrames) -> None:
    """After 3,600 frames of 60 Hz the clock stands at 60 s, not 1.2 us beside it."""
    pipeline = run_frames([0] * 3600, [10 * MS] * 3600, mode="vsync", refresh_hz=60.0, images=2)
    assert pipeline.display_ns[0] == 16_666_667
    assert pipeline.display_ns[-1] == 60_000_000_000


def test_the_gpu_waits_for_an_image_of_the_swapchain(run_frames: RunFrames) -> None:
    """With two images at 100 Hz, frame 2 starts when the vblank at 20 ms frees that of frame 0."""
    pipeline = run_frames([0] * 3, [2 * MS] * 3, 4, mode="vsync", refresh_hz=100.0, images=2)
    assert in_ms(pipeline.gpu_start_ns).tolist() == [0, 2, 20]
    assert in_ms(pipeline.display_ns).tolist() == [10, 20, 30]


def test_mailbox_is_not_held_back_by_the_screen(run_frames: RunFrames) -> None:
    """4 ms frames at 100 Hz run at 250 fps; of the five done by 20 ms, two are shown."""
    pipeline = run_frames([0] * 6, [4 * MS] * 6, mode="mailbox", refresh_hz=100.0)
    assert in_ms(pipeline.gpu_end_ns).tolist() == [4, 8, 12, 16, 20, 24]
    dropped = [DROPPED_NS, DROPPED_NS]
    assert list(pipeline.display_ns) == [
        dropped[0], 10 * MS, *dropped, 20 * MS, 30 * MS
    ]  # fmt: skip


def test_mailbox_shows_a_frame_that_is_done_exactly_at_the_vblank(run_frames: RunFrames) -> None:
    """Frames done at 5 and 10 ms at 100 Hz: the vblank at 10 shows the second, not the first."""
    pipeline = run_frames([0, 0], [5 * MS, 5 * MS], mode="mailbox", refresh_hz=100.0)
    assert list(pipeline.display_ns) == [DROPPED_NS, 10 * MS]


def test_mailbox_drops_are_counted_and_shown_frames_fill_every_vblank(
    run_frames: RunFrames,
) -> None:
    """600 frames of 4 ms end at 2.4 s: 240 vblanks of 100 Hz show one each, 360 are dropped."""
    pipeline = run_frames([MS] * 600, [4 * MS] * 600, mode="mailbox", refresh_hz=100.0)
    dropped = int((np.array(pipeline.display_ns) == DROPPED_NS).sum())
    assert in_ms(pipeline.gpu_end_ns)[-1] == 2401
    assert (dropped, len(shown_ms(pipeline))) == (359, 241)
    assert np.diff(shown_ms(pipeline)) == pytest.approx(np.full(240, 10.0))


def test_mailbox_has_less_lag_than_vsync(run_frames: RunFrames) -> None:
    """Mailbox adds at most the 4 ms until the next frame to the queue's 8; vsync adds vblanks."""
    lags: dict[str, float] = {}
    for mode in ("mailbox", "vsync"):
        pipeline = run_frames([MS] * 300, [4 * MS] * 300, mode=mode, refresh_hz=60.0)
        display = np.array(pipeline.display_ns)
        shown = display != DROPPED_NS
        lag = (display - np.array(pipeline.input_ns))[shown]
        lags[mode] = float(lag[20:-2].max()) / MS
    assert lags["mailbox"] <= 12.0
    assert lags["vsync"] > 2 * 1000 / 60


def test_vrr_inside_its_range_shows_a_frame_when_it_is_done(run_frames: RunFrames) -> None:
    """From 48 to 144 Hz, frames of 10 to 20 ms are shown at once."""
    gpu = [10 * MS, 20 * MS, 15 * MS, 12 * MS, 20 * MS]
    pipeline = run_frames([0] * 5, gpu, mode="vrr", refresh_hz=144.0, vrr_min_hz=48.0)
    assert pipeline.display_ns == pipeline.gpu_end_ns


def test_vrr_above_its_range_is_held_to_the_highest_rate(run_frames: RunFrames) -> None:
    """2 ms frames on a panel of 40 to 100 Hz are shown every 10 ms; the queue holds the GPU."""
    pipeline = run_frames([0] * 6, [2 * MS] * 6, mode="vrr", refresh_hz=100.0, vrr_min_hz=40.0)
    assert in_ms(pipeline.display_ns).tolist() == [2, 12, 22, 32, 42, 52]
    assert in_ms(pipeline.gpu_start_ns).tolist() == [0, 2, 4, 12, 22, 32]


def test_vrr_below_its_range_waits_for_the_panel_to_refresh_itself(run_frames: RunFrames) -> None:
    """At 40 to 100 Hz a frame done 26 ms after the last waits for the repeat begun at 25 ms.

    Frame 0 is shown at 5 ms.  The panel repeats it at 30 ms and is busy until 40; frame 1, done
    at 31, is shown at 40.  Frame 2, done at 81, comes after the repeat of 65 has ended at 75.
    """
    pipeline = run_frames(
        [0] * 3, [5 * MS, 26 * MS, 50 * MS], mode="vrr", refresh_hz=100.0, vrr_min_hz=40.0
    )
    assert in_ms(pipeline.gpu_end_ns).tolist() == [5, 31, 81]
    assert in_ms(pipeline.display_ns).tolist() == [5, 40, 81]


def test_vrr_at_the_edge_of_its_range(run_frames: RunFrames) -> None:
    """A frame done exactly when the panel would repeat, 25 ms after the last, is shown then."""
    pipeline = run_frames([0] * 2, [5 * MS, 25 * MS], mode="vrr", refresh_hz=100.0, vrr_min_hz=40.0)
    assert in_ms(pipeline.display_ns).tolist() == [5, 30]


def test_vrr_repeats_evenly_where_the_range_spans_a_factor_of_two(run_frames: RunFrames) -> None:
    """At 40 to 100 Hz frames 30 ms apart are shown at once, from the third on.

    Frame 1, done at 60 ms, waits for the repeat of 55 ms to end at 65.  Frame 2 is expected at 90,
    which is one period of 25 ms.  Frame 3 is expected 30 ms on, in two of 15: the repeat at 105 has
    ended at 115, and frame 3 is shown at 120.
    """
    pipeline = run_frames([0] * 7, [30 * MS] * 7, mode="vrr", refresh_hz=100.0, vrr_min_hz=40.0)
    assert in_ms(pipeline.display_ns).tolist() == [30, 65, 90, 120, 150, 180, 210]


def test_vrr_of_a_narrow_range_does_not_compensate(run_frames: RunFrames) -> None:
    """At 60 to 100 Hz every frame 22 ms after the last meets the repeat of 16.7 ms, until 26.7."""
    pipeline = run_frames([0] * 4, [22 * MS] * 4, mode="vrr", refresh_hz=100.0, vrr_min_hz=60.0)
    shown = in_ms(pipeline.display_ns)
    assert shown[:2] == pytest.approx([22, 48.667], abs=1e-3)
    assert shown[2] == pytest.approx(75.333, abs=1e-3)


@given(st.integers(26, 200), st.integers(0, 4))
def test_vrr_far_below_its_range_shows_even_frames_at_once(
    run_frames: RunFrames, gpu_ms: int, cpu_ms: int
) -> None:
    """However slow, frames that are evenly apart never wait once their pace is known."""
    work = [cpu_ms * MS] * 12, [gpu_ms * MS] * 12
    pipeline = run_frames(*work, mode="vrr", refresh_hz=100.0, vrr_min_hz=40.0)
    assert pipeline.display_ns[6:] == pipeline.gpu_end_ns[6:]


@pytest.mark.parametrize("mode", ["immediate", "vsync", "mailbox", "vrr"])
def test_every_frame_is_done_and_accounted_for(run_frames: RunFrames, mode: DisplayMode) -> None:
    """A source of one frame, or of none, ends the run in every mode."""
    assert run_frames([], [], mode=mode).completed == 0
    pipeline = run_frames([MS], [MS], mode=mode)
    assert pipeline.completed == 1
    assert pipeline.display_ns[0] >= 2 * MS


@pytest.mark.parametrize("mode", ["immediate", "vsync", "mailbox", "vrr"])
def test_a_frame_is_selected_on_the_frames_completed_by_then(mode: DisplayMode) -> None:
    """When frame k samples input, exactly the frames whose GPU end is not later are complete."""
    seen: list[tuple[int, int]] = []

    class Source:
        def begin(self, frame: int, time_ns: int) -> tuple[int, int] | None:
            seen.append((time_ns, pipeline.completed))
            return (3 * MS, (frame * 7 % 11 + 1) * MS) if frame < 100 else None

    pipeline = Pipeline(Source(), Display(mode=mode), 3)
    pipeline.run()
    ends = np.array(pipeline.gpu_end_ns)
    for time_ns, completed in seen:
        assert completed == int((ends <= time_ns).sum())
