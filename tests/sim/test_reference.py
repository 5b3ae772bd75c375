"""The pipeline against recurrences without an event queue, and its properties in every mode."""

from collections import Counter
from collections.abc import Callable
from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from lodbench.models.machine.hardware import Display, DisplayMode, Pacing
from lodbench.sim.pipeline.pipeline import Pipeline
from lodbench.sim.pipeline.screens import DROPPED_NS

MS = 1_000_000
RunFrames = Callable[..., Pipeline]
Costs = list[tuple[int, int]]
Paced = tuple[Pacing, int]
"""Pacing and latency limit."""

# Few distinct values, so that frames often end at the same nanosecond or exactly at a vblank.
durations = st.one_of(st.sampled_from([1, MS, 5 * MS, 10 * MS, 20 * MS]), st.integers(1, 45 * MS))
costs = st.lists(st.tuples(durations, durations), min_size=1, max_size=40)
in_flight = st.integers(1, 4)
images = st.sampled_from([2, 3])
modes = st.sampled_from(["immediate", "vsync", "mailbox", "vrr"])
pacings = st.sampled_from(
    [("none", 0), ("limiter", 0), ("just-in-time", 0), ("none", 1), ("just-in-time", 2)]
)


def reference(
    work: Costs, frames_in_flight: int, images: int, refresh_hz: int | None
) -> list[tuple[int, int, int, int, int]]:
    """Return input, CPU end, GPU start, GPU end and display of each frame, by recurrence.

    `refresh_hz` is None for immediate display.  A frame waits for the frame `frames_in_flight`
    before it to leave the GPU, for the CPU and GPU to finish the one before it, and for the image
    of the frame `images` before it, which is free when the next frame has replaced it on screen.
    """
    rows: list[tuple[int, int, int, int, int]] = []
    vblank = -1
    for k, (cpu_ns, gpu_ns) in enumerate(work):
        input_ns = rows[k - 1][1] if k else 0
        if k >= frames_in_flight:
            input_ns = max(input_ns, rows[k - frames_in_flight][3])
        cpu_end_ns = input_ns + cpu_ns
        start_ns = max(cpu_end_ns, rows[k - 1][3] if k else 0)
        if k >= images:
            start_ns = max(start_ns, rows[k - images + 1][4])
        end_ns = display_ns = start_ns + gpu_ns
        if refresh_hz is not None:
            vblank += 1
            while (display_ns := round(Fraction(vblank * 10**9, refresh_hz))) < end_ns:
                vblank += 1
        rows.append((input_ns, cpu_end_ns, start_ns, end_ns, display_ns))
    return rows


@given(costs, in_flight, images, st.sampled_from([None, 50, 60, 90, 100, 144]))
def test_pipeline_equals_the_recurrences_to_the_nanosecond(
    run_frames: RunFrames, work: Costs, frames_in_flight: int, images: int, refresh_hz: int | None
) -> None:
    """Immediate and vsync agree with the naive loop for any durations, images and queue."""
    cpu_ns, gpu_ns = zip(*work, strict=True)
    mode = "immediate" if refresh_hz is None else "vsync"
    pipeline = run_frames(
        cpu_ns, gpu_ns, frames_in_flight, mode=mode, images=images,
        refresh_hz=float(refresh_hz or 60),
    )  # fmt: skip
    columns = (
        pipeline.input_ns, pipeline.cpu_end_ns, pipeline.gpu_start_ns, pipeline.gpu_end_ns,
        pipeline.display_ns,
    )  # fmt: skip
    assert list(zip(*columns, strict=True)) == reference(work, frames_in_flight, images, refresh_hz)


@given(costs, in_flight, images, modes, pacings)
def test_frames_keep_their_order_and_no_lag_is_shorter_than_the_work(
    run_frames: RunFrames,
    work: Costs,
    frames_in_flight: int,
    images: int,
    mode: DisplayMode,
    paced: Paced,
) -> None:
    """Every stage sees frames in order; from input to display takes at least CPU + GPU."""
    cpu_ns, gpu_ns = (np.array(column) for column in zip(*work, strict=True))
    pipeline = run_frames(
        cpu_ns.tolist(), gpu_ns.tolist(), frames_in_flight, mode=mode, images=images,
        pacing=paced[0], latency_limit=paced[1],
    )  # fmt: skip
    for column in (pipeline.input_ns, pipeline.cpu_end_ns, pipeline.gpu_start_ns):
        assert (np.diff(np.array(column)) > 0).all()
    shown = np.array(pipeline.display_ns) != DROPPED_NS
    display = np.array(pipeline.display_ns)[shown]
    assert (np.diff(display) > 0).all()
    assert (display >= np.array(pipeline.gpu_end_ns)[shown]).all()
    lag = display - np.array(pipeline.input_ns)[shown]
    assert (lag >= (cpu_ns + gpu_ns)[shown]).all()
    assert mode == "mailbox" or shown.all()
    assert shown[-1]


@given(costs, in_flight, images, modes, pacings)
def test_frames_in_flight_and_images_are_never_over_committed(
    run_frames: RunFrames,
    work: Costs,
    frames_in_flight: int,
    images: int,
    mode: DisplayMode,
    paced: Paced,
) -> None:
    """At no instant do more frames stand between input and GPU end, or hold images, than exist.

    A frame holds its image from the start of its GPU work until the next shown frame replaces it,
    or, if mailbox drops it, until the frame after it is done.
    """
    cpu_ns, gpu_ns = zip(*work, strict=True)
    pipeline = run_frames(
        cpu_ns, gpu_ns, frames_in_flight, mode=mode, images=images,
        pacing=paced[0], latency_limit=paced[1],
    )  # fmt: skip
    start, end = np.array(pipeline.gpu_start_ns), np.array(pipeline.gpu_end_ns)
    began, display = np.array(pipeline.input_ns), np.array(pipeline.display_ns)
    freed = np.full(len(work), np.iinfo(np.int64).max)
    shown = np.flatnonzero(display != DROPPED_NS)
    freed[shown[:-1]] = display[shown[1:]]
    dropped = np.flatnonzero(display == DROPPED_NS)
    freed[dropped] = end[dropped + 1]
    for now in np.concatenate((began, start)):
        assert np.count_nonzero((start <= now) & (now < freed)) <= images
        assert np.count_nonzero((began <= now) & (now < end)) <= frames_in_flight
        assert np.count_nonzero((start <= now) & (now < end)) <= 1


class _Counting(Pipeline):
    """A pipeline that counts how often the screen reports each frame."""

    def __init__(self, work: Costs, display: Display, frames_in_flight: int) -> None:
        self.reports = Counter[int]()
        self._work = work
        super().__init__(self, display, frames_in_flight)

    def begin(self, frame: int, time_ns: int) -> tuple[int, int] | None:
        return self._work[frame] if frame < len(self._work) else None

    def _shown(self, time_ns: int, frame: int) -> None:
        self.reports[frame] += 1
        super()._shown(time_ns, frame)


@given(costs, in_flight, images, modes, pacings)
def test_no_frame_is_shown_twice(
    work: Costs, frames_in_flight: int, images: int, mode: DisplayMode, paced: Paced
) -> None:
    """The screen reports each frame exactly once, as shown or as dropped, and none is lost."""
    display = Display(mode=mode, images=images, pacing=paced[0], latency_limit=paced[1])
    pipeline = _Counting(work, display, frames_in_flight)
    pipeline.run()
    assert pipeline.reports == Counter(range(len(work)))


@given(costs, in_flight, st.integers(1, 100))
def test_a_faster_gpu_never_lowers_fps(
    run_frames: RunFrames, work: Costs, frames_in_flight: int, percent: int
) -> None:
    """Under immediate display, shorter GPU times let no frame be shown later."""
    cpu_ns, gpu_ns = zip(*work, strict=True)
    slow = run_frames(cpu_ns, gpu_ns, frames_in_flight)
    faster_ns = [max(1, gpu * percent // 100) for gpu in gpu_ns]
    fast = run_frames(cpu_ns, faster_ns, frames_in_flight)
    assert (np.array(fast.display_ns) <= np.array(slow.display_ns)).all()


@given(costs, in_flight)
def test_frames_longer_than_a_refresh_never_wait_long_under_vrr(
    run_frames: RunFrames, work: Costs, frames_in_flight: int
) -> None:
    """A frame waits at most one shortest period, for its turn or for the panel's own refresh."""
    cpu_ns, gpu_ns = zip(*[(cpu, gpu + 10 * MS) for cpu, gpu in work], strict=True)
    pipeline = run_frames(
        cpu_ns, gpu_ns, frames_in_flight, mode="vrr", refresh_hz=100.0, vrr_min_hz=40.0
    )
    wait = np.array(pipeline.display_ns) - np.array(pipeline.gpu_end_ns)
    assert (wait >= 0).all()
    assert (wait <= 10 * MS).all()
