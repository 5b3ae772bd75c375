"""The programme of calibration, drawn in shuffled order, all of it twice.

Drawn in the order of the path, what the machine does over minutes would look like what the scene
does: costs would take the blame for heat, and heat for costs.  Shuffled, the two are apart, and the
second pass tells the same frames' times some minutes later.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...sim.frame_log import FrameLog
from ...sim.machine.simulated_machine import FrameTimes, Submitted
from ...sim.replay import ReplayOptions, replay
from ...traces.cameras.camera_trace import CameraTrace
from .calibration import Calibration
from .opengl_machine import GlMachine, expected_units, picture_of
from .recorder import Recording, logged_columns

if TYPE_CHECKING:
    from .draw_list import Picture

PASSES = 2
_ORDER = 1  # of the seed's streams of random numbers


class _PictureKeeper:
    """A machine that draws nothing, and keeps what it should have drawn for later."""

    def __init__(self, programme: Calibration, step_ms: float) -> None:
        self._programme, self._step_ms = programme, step_ms
        self._pictures: list[tuple[Picture, tuple[float, ...]]] = []

    def begin(self) -> None:
        """Begin a frame."""

    def run(self, frame: Submitted) -> FrameTimes:
        """Keep the picture of the frame; the next one is a step later."""
        picture, how = picture_of(frame), self._programme.arrangement
        picture = replace(picture, mixed=how.mixed, upload_bytes=how.upload_bytes)
        self._pictures.append((picture, expected_units(frame, picture)))
        return FrameTimes(0.0, 0.0, self._step_ms)

    def measure(self, frame: int, measuring: GlMachine) -> None:
        """Have a frame drawn and measured."""
        measuring.measure(*self._pictures[frame])


def record_programme(
    scene: Scene,
    trace: CameraTrace,
    hardware: HardwareProfile,
    options: ReplayOptions,
    measuring: GlMachine,
    *,
    name: str,
    progress: Callable[[int, int], None] | None = None,
    on_pass: Callable[[Recording], None] | None = None,
) -> Recording:
    """Draw `options.frames` frames of the programme, in even steps along the trace, twice.

    The columns have two rows a frame, in the order of the path: ``pass`` is 0 or 1, ``drawn_at``
    the place in the order of drawing.  The frame log has each frame once.  `on_pass` is called with
    what there is when a pass is over, so that a second one that is stopped does not lose the first.
    """
    assert options.frames is not None, "a programme has as many frames as it is told"
    programme = Calibration(options.seed)
    keeper = _PictureKeeper(programme, max(1e3 * trace.duration_s / options.frames, 1e-3))
    log = replay(programme, scene, trace, hardware, options, name=name, machine=keeper)
    order = drawing_order(len(log), options.seed)
    for done, frame in enumerate(order.tolist()):
        if progress is not None:
            progress(done, len(order))
        if on_pass is not None and done == len(log):
            on_pass(_recording(log, order[:done], measuring))
        keeper.measure(frame, measuring)
    return _recording(log, order, measuring)


def _recording(log: FrameLog, order: NDArray[np.int64], measuring: GlMachine) -> Recording:
    """Return what was measured in some order of frames, told in the order of the path."""
    drawn_at = np.lexsort((np.arange(len(order)), order))
    columns = logged_columns(log, order[drawn_at])
    columns |= {column: values[drawn_at] for column, values in measuring.rows().items()}
    columns |= {"pass": (drawn_at // len(log)).astype(float), "drawn_at": drawn_at.astype(float)}
    return Recording(log, columns, measuring.doubt)


def drawing_order(frames: int, seed: int) -> NDArray[np.int64]:
    """Return which frame is drawn when, each once in each pass, (PASSES * frames,)."""
    rng = np.random.default_rng((seed, _ORDER))
    return np.concatenate([rng.permutation(frames) for _ in range(PASSES)])
