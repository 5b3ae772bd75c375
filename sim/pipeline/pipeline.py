"""The frame pipeline: CPU, driver queue, GPU and screen as events on one clock.

Frame k waits for a free frame in flight and for the pacing, samples input, runs on the CPU, is
queued, runs on the GPU once that and a swapchain image are free, and is offered to the screen.  CPU
and GPU overlap.  A frame is in flight from its input until its GPU work is complete, as with one
fence a frame; a latency limit counts it until it is shown or dropped, as a waitable swapchain does.
"""

from array import array
from collections import deque
from typing import Protocol

from ...models.machine.hardware import Display
from .events import EventQueue
from .pacing import make_pacer
from .screens import DROPPED_NS, make_screen

_GPU_PRIORITY, _CPU_PRIORITY = 0, 2


class FrameSource(Protocol):
    """Who decides what a frame costs."""

    def begin(self, frame: int, time_ns: int) -> tuple[int, int] | None:
        """Sample input at a time; return CPU and GPU nanoseconds, or None to end the replay."""
        ...


class Pipeline:
    """Runs the frames of one source to the end.

    Attributes
    ----------
    input_ns, cpu_end_ns, gpu_start_ns, gpu_end_ns, display_ns : array of int64, one a frame
        -1 where not reached yet; `DROPPED_NS` in `display_ns` of a frame that is never shown.
    completed : int
        Frames whose GPU work is complete; they complete in order.
    """

    def __init__(self, source: FrameSource, display: Display, frames_in_flight: int) -> None:
        self._source = source
        self._frames_in_flight = frames_in_flight
        self._in_flight = 0
        self._cpu_idle = self._gpu_idle = True
        self._images_free = display.images
        self._gpu_ns: deque[int] = deque()  # of frames whose GPU work has not begun
        self._queue: deque[int] = deque()
        self.events = EventQueue()
        self._pacer = make_pacer(display, frames_in_flight)
        self._latency_limit = display.latency_limit
        paced = self._pacer is not None or self._latency_limit > 0
        # Chosen once: a frame that nothing paces is not asked about it three times.
        self._begin = self._pace if paced else self._start_cpu
        self._done = self._gpu_done if self._pacer is None else self._gpu_timed
        shown = self._left_queue if paced else self._shown
        self._left = 0  # frames that were shown or dropped
        self._screen = make_screen(display, self.events, shown, self._freed)
        self.completed = 0
        self.input_ns = array("q")
        self.cpu_end_ns = array("q")
        self.gpu_start_ns = array("q")
        self.gpu_end_ns = array("q")
        self.display_ns = array("q")

    def run(self) -> None:
        """Run every frame until the source ends the replay and the last frame is shown."""
        self._begin(0)
        self.events.run()

    def _pace(self, time_ns: int) -> None:
        """Begin a frame, for which a slot is free, when the latency limit and the pacing let it."""
        frame = len(self.input_ns)
        if self._latency_limit and frame - self._left >= self._latency_limit:
            return  # until the screen takes a frame
        if self._pacer is not None:
            since_ns = -1 if self._gpu_idle else self.gpu_start_ns[frame - len(self._queue) - 1]
            start_ns = self._pacer.start_ns(frame, time_ns, since_ns, len(self._queue))
            if start_ns > time_ns:
                self._cpu_idle = False  # it is this frame's
                self.events.schedule(start_ns, _CPU_PRIORITY, self._waited, frame)
                return
        self._start_cpu(time_ns)

    def _waited(self, time_ns: int, _frame: int) -> None:
        self._start_cpu(time_ns)

    def _start_cpu(self, time_ns: int) -> None:
        frame = len(self.input_ns)
        costs = self._source.begin(frame, time_ns)
        if costs is None:
            self._cpu_idle = False  # no frame follows
            return
        self._cpu_idle = False
        self._in_flight += 1
        end_ns = time_ns + costs[0]
        self.input_ns.append(time_ns)
        self.cpu_end_ns.append(end_ns)
        self._gpu_ns.append(costs[1])
        self.gpu_start_ns.append(-1)
        self.gpu_end_ns.append(-1)
        self.display_ns.append(-1)
        self.events.schedule(end_ns, _CPU_PRIORITY, self._cpu_done, frame)

    def _cpu_done(self, time_ns: int, frame: int) -> None:
        self._cpu_idle = True
        self._queue.append(frame)
        if self._gpu_idle and self._images_free:
            self._start_gpu(time_ns)
        if self._in_flight < self._frames_in_flight:
            self._begin(time_ns)

    def _start_gpu(self, time_ns: int) -> None:
        frame = self._queue.popleft()
        self._gpu_idle = False
        self._images_free -= 1
        self.gpu_start_ns[frame] = time_ns
        end_ns = time_ns + self._gpu_ns.popleft()
        self.events.schedule(end_ns, _GPU_PRIORITY, self._done, frame)

    def _gpu_timed(self, time_ns: int, frame: int) -> None:
        assert self._pacer is not None, "who paces learns of times"
        cpu_ns = self.cpu_end_ns[frame] - self.input_ns[frame]
        self._pacer.completed(cpu_ns, time_ns - self.gpu_start_ns[frame])
        self._gpu_done(time_ns, frame)

    def _gpu_done(self, time_ns: int, frame: int) -> None:
        self._gpu_idle = True
        self._in_flight -= 1
        self.completed += 1
        self.gpu_end_ns[frame] = time_ns
        self._screen.offer(time_ns, frame)
        if self._queue and self._gpu_idle and self._images_free:
            self._start_gpu(time_ns)
        if self._cpu_idle and self._in_flight < self._frames_in_flight:
            self._begin(time_ns)

    def _shown(self, time_ns: int, frame: int) -> None:
        self.display_ns[frame] = time_ns

    def _left_queue(self, time_ns: int, frame: int) -> None:
        self._shown(time_ns, frame)
        self._left += 1
        if self._pacer is not None and time_ns != DROPPED_NS:
            self._pacer.shown(frame, time_ns)
        if self._latency_limit and self._cpu_idle and self._in_flight < self._frames_in_flight:
            self._begin(self.events.now_ns)

    def _freed(self, time_ns: int) -> None:
        self._images_free += 1
        if self._queue and self._gpu_idle:
            self._start_gpu(time_ns)
