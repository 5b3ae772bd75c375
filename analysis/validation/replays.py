"""Record policies, once or twice, and simulate the same."""

from collections.abc import Callable, Sequence

from ...base.errors import InputError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...models.scene.scene_catalog import OpenedScene
from ...policies.registry import parse_policy
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from ..study.compare import CompareSettings
from ..study.engine.open_engine import open_engine
from ..study.replays import Place, Replays, make_bench
from ..study.runs import Progress, choose_draws
from .record_options import RecordOptions
from .recordings import Recorded, open_recorder
from .validate import Measured, Simulated, Simulation


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
    on_recorded: Callable[[str, int, Recorded], None] | None = None,
) -> dict[str, list[Recorded]]:
    """Return recordings by label.

    All policies are recorded before the first is recorded again, so that the second recordings
    tell how the machine differs from itself some minutes later.  `on_recorded` is called with the
    label, the pass and the recording as each ends, so that one that fails later loses nothing.

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
                recorded = recorder.record(label, trace, hardware, options, progress=share)
                found[label].append(recorded)
                if on_recorded is not None:
                    on_recorded(label, again, recorded)
    return found


def simulate_all(
    labels: Sequence[str],
    scene: Scene,
    trace: CameraTrace,
    hardware: HardwareProfile,
    options: ReplayOptions,
    settings: CompareSettings,
    progress: Progress | None = None,
) -> Simulation:
    """Simulate policies under the profile's mean and under draws of it, each as it is typed.

    Raises `InputError` if a policy cannot be simulated.
    """
    specs = [parse_policy(label) for label in labels]
    bench = make_bench(
        specs, scene, [trace], hardware, options, settings.warmup_s, miss=settings.miss
    )
    limits = settings.policy_limits
    engine = open_engine(
        bench.inputs, workers=settings.workers, limits=limits, scheduler=settings.scheduler
    )
    draws = choose_draws(hardware, settings.draws)
    mean = {label: Place(label, 0, options.seed, logged=True) for label in labels}
    drawn = {
        label: [Place(label, 0, options.seed, draw=draw) for draw in draws] for label in labels
    }
    with engine:
        replays = Replays(bench, engine, progress, limits=limits)
        replays.make(place for label in labels for place in (mean[label], *drawn[label]))
    for label, failure in replays.failures.items():
        raise InputError(f"{label}: expected a policy that runs; {failure}")
    return Simulation(
        scene=scene.name,
        trace=trace.name,
        trace_s=trace.duration_s,
        budget_ms=options.budget_ms,
        seed=options.seed,
        window_s=(settings.warmup_s, trace.duration_s),
        policies={
            label: Simulated(replays[mean[label]], tuple(replays[at] for at in drawn[label]))
            for label in labels
        },
    )


def measured_of(recorded: Recorded) -> Measured:
    """Return a recording with its counts under the names of the cost model."""
    columns = recorded.columns
    return Measured(recorded.frames, columns | {"shaded_samples": columns["projected_px"]})
