"""Record policies along a path, once or twice."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ...base.errors import InputError, PolicyError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene_catalog import OpenedScene
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from ..study.runs import Progress, part_of
from .record_options import RecordOptions
from .recordings import Recorded, open_recorder

OnRecorded = Callable[[str, int, Recorded], None]
"""Called with label, pass and recording as soon as it ends: a later failure does not lose it."""


@dataclass(frozen=True, slots=True, eq=False)
class Recordings:
    """What was recorded along one path.

    Attributes
    ----------
    policies : dict of str to list of Recorded
        By label, one recording a pass.
    failed : dict of str to str
        Why policies were not recorded, by label.
    """

    policies: dict[str, list[Recorded]]
    failed: dict[str, str]


def record_all(
    labels: Sequence[str],
    scene: OpenedScene,
    trace: CameraTrace,
    hardware: HardwareProfile,
    options: ReplayOptions,
    settings: RecordOptions,
    passes: int,
    progress: Progress | None = None,
    on_recorded: OnRecorded | None = None,
    on_failed: Callable[[str], None] | None = None,
) -> Recordings:
    """Record policies; one that breaks its contract fails by name, and the others go on.

    All policies are recorded before the first is recorded again, so that the second recordings
    tell how the machine differs from itself some minutes later.  One that fails when it is recorded
    again has no recording: `on_failed` is told, as its first may have been written.

    Raises `InputError` as `Recorder.record`.
    """
    require_passes(passes)
    size = (hardware.display.width_px, hardware.display.height_px)
    found: dict[str, list[Recorded]] = {label: [] for label in labels}
    failed: dict[str, str] = {}
    with open_recorder(scene, settings, size) as recorder:
        for again in range(passes):
            for place, label in enumerate(labels):
                if label in failed:
                    continue
                done = again * len(labels) + place
                share = part_of(progress, done, passes * len(labels))
                try:
                    recorded = recorder.record(label, trace, hardware, options, progress=share)
                except PolicyError as error:
                    failed[label] = str(error)
                    if on_failed is not None:
                        on_failed(label)
                    continue
                found[label].append(recorded)
                if on_recorded is not None:
                    on_recorded(label, again, recorded)
    return Recordings({k: v for k, v in found.items() if k not in failed}, failed)


def require_passes(passes: int) -> None:
    """Raise `InputError` unless each policy is to be recorded once or twice."""
    if passes not in (1, 2):
        raise InputError(f"--passes: expected 1 or 2, got {passes}; 2 shows the machine's noise")
