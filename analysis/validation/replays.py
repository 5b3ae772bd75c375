"""Record policies, once or twice, and simulate the same."""

from collections.abc import Mapping, Sequence

from ...base.errors import InputError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene_catalog import OpenedScene
from ...policies.registry import parse_policy
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from ..study.compare import CompareOptions, compare
from ..study.comparison import Comparison
from ..study.runs import Progress
from .recordings import Recorded, RecordOptions, open_recorder
from .validate import Measured, Pair


def _share(progress: Progress, done: int, total: int) -> Progress:
    """Return what tells of one recording as a share of all."""
    return lambda now, of: progress(1000 * done + 1000 * now // max(of, 1), 1000 * total)


def record_all(
    labels: Sequence[str],
    scene: OpenedScene,
    trace: CameraTrace,
    hardware: HardwareProfile,
    options: ReplayOptions,
    settings: RecordOptions,
    passes: int,
    progress: Progress | None = None,
) -> dict[str, list[Recorded]]:
    """Return recordings by label.

    All policies are recorded before the first is recorded again, so that the second recordings
    tell how the machine differs from itself some minutes later.

    Raises
    ------
    InputError, PolicyError
        As `Recorder.record`.
    """
    if passes not in (1, 2):
        raise InputError(f"--passes: expected 1 or 2, got {passes}; 2 shows the machine's noise")
    size = (hardware.display.width_px, hardware.display.height_px)
    found: dict[str, list[Recorded]] = {label: [] for label in labels}
    with open_recorder(scene, settings, size) as recorder:
        for again in range(passes):
            for place, label in enumerate(labels):
                done = again * len(labels) + place
                share = None if progress is None else _share(progress, done, passes * len(labels))
                found[label].append(
                    recorder.record(label, trace, hardware, options, progress=share)
                )
    return found


def simulate_all(
    labels: Sequence[str],
    scene: OpenedScene,
    trace: CameraTrace,
    hardware: HardwareProfile,
    options: ReplayOptions,
    settings: CompareOptions,
    measured: Mapping[str, tuple[Measured, ...]],
    progress: Progress | None = None,
) -> tuple[Comparison, dict[str, Pair]]:
    """Simulate what was recorded; return the comparison and both sides by label.

    Raises `InputError` if a policy cannot be simulated.
    """
    specs = [parse_policy(label) for label in labels]
    comparison, logs = compare(
        specs, scene.scene, trace, hardware, options, settings, progress=progress
    )
    for policy in comparison.policies:
        if policy.status != "ok":
            raise InputError(f"{policy.label}: expected a policy that runs; {policy.reason}")
    return comparison, {label: Pair(measured[label], logs[label]) for label in labels}


def measured_of(recorded: Recorded) -> Measured:
    """Return a recording with its counts under the names of the cost model."""
    columns = recorded.columns
    return Measured(recorded.frames, columns | {"shaded_samples": columns["projected_px"]})
