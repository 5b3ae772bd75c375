"""A machine that draws each frame and measures it, in place of the simulated one."""

import gc
from array import array
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import astuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...models.machine.cost_terms.catalog import VIEW_TERMS
from ...models.machine.picture_units import view_units
from ...models.scene.tree import Tree
from ...sim.machine.simulated_machine import FrameTimes, Submitted
from ...traces.logs.render_log import REFERENCES
from .context import Device
from .draw_list import Counts, Frame, Picture
from .measures.reference_draw import ReferenceDraw
from .measures.timer_query import doubt_timer
from .renderer import Renderer, Timing

# Levels are ready to draw here: none is made anew in every frame.
_NOT_DONE = ("reformed_objects", "reformed_triangles")
_EXPECTED = tuple(name for name in VIEW_TERMS if name not in ("shaded_samples", *_NOT_DONE))

COUNTED = (*Counts.__dataclass_fields__, "shaded_samples", *_EXPECTED)
"""Columns of what a frame holds, in a log that is measured.

All are the renderer's own but the view's other terms, such as ``rasterized_triangles``, which no
query tells: they are what the cost model expects of what was drawn.
"""

_TIMED = ("cpu_ms", "gpu_ms", "frame_ms", "frame_ms_low", "frame_ms_high")


class GlMachine:
    """Draws every frame several times and takes the median.

    The time of a frame is all that it takes until OpenGL says that it is finished, charged to the
    GPU: so a frame is one piece of work, as in a profile that was fitted to ``frame_ms``.

    Parameters
    ----------
    repeats
        Times that each frame is drawn; the median of five is quieter than one by half.
    warmup
        Times that the first frame is drawn before it counts: drivers compile then.
    reference
        What is drawn before and after each frame, to tell what the machine does at the moment.

    Attributes
    ----------
    doubt : str or None
        Why the timer query is not believed; None before the first frame, and if it is.
    """

    def __init__(
        self,
        renderer: Renderer,
        device: Device,
        *,
        repeats: int = 5,
        warmup: int = 5,
        reference: ReferenceDraw | None = None,
    ) -> None:
        if not 1 <= repeats <= 99:
            raise InputError(f"--repeats: expected 1 to 99 drawings of a frame, got {repeats}")
        self._renderer, self._device = renderer, device
        self._repeats, self._warmup, self._reference = repeats, warmup, reference
        about = REFERENCES if reference is not None else ()
        self._names = (*COUNTED, *renderer.statistics, *_TIMED, *about)
        self._rows = array("d")
        self.doubt: str | None = None

    def begin(self) -> None:
        """Begin a frame; nobody can know what it will take."""
        return

    def run(self, frame: Submitted) -> FrameTimes:
        """Draw the frame; return what it took."""
        picture = picture_of(frame)
        return FrameTimes(0.0, 0.0, self.measure(picture, expected_units(frame, picture)))

    def measure(self, picture: Picture, expected: Sequence[float]) -> float:
        """Draw a picture, and keep a row of what it holds and takes; return its milliseconds.

        Parameters
        ----------
        expected : as of `expected_units`
        """
        ready = self._renderer.prepare(picture)
        if not self._rows:
            self.doubt = doubt_timer(self._device, self._drawn(ready, max(1, self._warmup)))
        before = self._refer()
        timings = self._drawn(ready, self._repeats, counting=True)
        after = self._refer()
        times = np.array([(t.cpu_ms, t.gpu_ms, t.frame_ms) for t in timings])
        middle = np.median(times, axis=0)
        if not 0.0 < middle[1] <= 1.05 * middle[2]:
            middle[1] = np.nan  # no result, or a counter that ran over
        self._rows.extend(astuple(self._renderer.count(ready)))
        self._rows.extend((timings[-1].shaded_samples, *expected, *timings[0].statistics))
        self._rows.extend((*middle, times[:, 2].min(), times[:, 2].max(), *before, *after))
        return float(middle[2])

    def rows(self) -> dict[str, NDArray[np.float64]]:
        """Return what was counted and measured so far, by name, one value a picture.

        Times are medians of the repeats, and their extremes.  ``gpu_ms`` is left out where the
        timer is in doubt.
        """
        table = np.frombuffer(self._rows, dtype=np.float64).reshape(-1, len(self._names))
        columns = dict(zip(self._names, table.T, strict=True))
        if self.doubt is not None:
            del columns["gpu_ms"]
        return columns

    def _refer(self) -> tuple[float, ...]:
        return () if self._reference is None else (self._reference.take_ms(),)

    def _drawn(self, frame: Frame, count: int, *, counting: bool = False) -> list[Timing]:
        """Draw a frame so often; the driver counts the first drawing, which seldom is the median.

        That way what counting takes is in no time, unless a frame is drawn but once.
        """
        with no_collection():
            draw = self._renderer.draw
            return [draw(frame, counting=counting and i == 0) for i in range(count)]


def expected_units(frame: Submitted, picture: Picture) -> tuple[float, ...]:
    """Return the units of the view's terms that no query tells, as `COUNTED` ends with."""
    view, scale = frame.view, frame.selection.render_scale
    seen = view if picture.ids is view.ids else view.at(picture.ids)
    levels = view.scene.types.levels
    return tuple(view_units(name, levels, picture.row, seen, scale * scale) for name in _EXPECTED)


def picture_of(frame: Submitted, *, full: bool = False) -> Picture:
    """Return what a submitted frame shows: of continuous nodes, the nearest knot.

    With `full` that is all candidates at their finest, at the full size of the picture.

    Raises `InputError` if several cameras look: one would be drawn and called the frame.
    """
    if frame.view.state.rig is not None:
        raise InputError("opengl: expected one camera, got several; leave out eyes or players")
    view, drawn, scene = frame.view, frame.drawn, frame.view.scene
    if full:
        seen, scale = view, 1.0
        if not scene.flat:
            seen = view.at(np.flatnonzero(view.state.inside & Tree(scene).leaf).astype(np.int32))
        row = scene.types.levels.start[:-1][seen.type_index].astype(np.int64)
    else:
        seen = view if drawn.ids is view.ids else view.at(drawn.ids)
        scale, row = frame.selection.render_scale, drawn.row
        if drawn.fraction is not None:
            row = row + np.round(drawn.fraction).astype(np.int64)
    camera, centers_m = view.camera, view.state.centers_m
    size = (max(1, round(scale * camera.width_px)), max(1, round(scale * camera.height_px)))
    time_s = view.time_ns * 1e-9
    return Picture(camera, centers_m, seen.ids, row, seen.distance_m, time_s, size)


@contextmanager
def no_collection() -> Generator[None]:
    """Keep Python from collecting garbage, which would be measured."""
    before = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if before:
            gc.enable()
