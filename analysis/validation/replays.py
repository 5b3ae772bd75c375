"""Record policies, once or twice, and simulate the same."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ...base.errors import InputError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene_catalog import OpenedScene
from ...policies.registry import parse_policy
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from ..metrics.measured_frames import require_window
from ..study.engine.limits import DEFAULT_LIMITS, Limits
from ..study.engine.open_engine import open_engine
from ..study.replays import Place, Replays, make_bench
from ..study.runs import Progress, choose_draws
from .recordings import Recorded, RecordOptions, open_recorder
from .validate import Measured, Pair, Setting

_NOISES = 16  # replays under other noise, where a profile has no draws


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulateOptions:
    """How much is simulated.

    Attributes
    ----------
    warmup_s : float
        Seconds at the start of the path that do not count.
    draws : int
        Posterior draws of the cost model to replay, each under noise of its own.
    workers : int
        Processes; 0 for as many as there are processors.  Results do not depend on it.
    policy_limits : Limits
        What a policy may take.
    scheduler : str or None
        Address of a Dask scheduler in place of processes here.
    """

    warmup_s: float = 1.0
    draws: int = 16
    workers: int = 0
    policy_limits: Limits = DEFAULT_LIMITS
    scheduler: str | None = None


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
    settings: SimulateOptions,
    measured: Mapping[str, tuple[Measured, ...]],
    progress: Progress | None = None,
) -> tuple[Setting, dict[str, Pair]]:
    """Simulate what was recorded; return of what both sides are replays, and both by label.

    Raises `InputError` if all of the path would be warm-up, or a policy cannot be simulated.
    """
    require_window(settings.warmup_s, trace.duration_s)
    specs = [parse_policy(label) for label in labels]
    bench = make_bench(specs, scene.scene, [trace], hardware, options, settings.warmup_s)
    draws = choose_draws(hardware, settings.draws)
    # A recording is one machine under one noise, and so is each replay that says where it may lie.
    spread = [(options.seed + 1 + at, draw) for at, draw in enumerate(draws or [None] * _NOISES)]
    engine = open_engine(
        bench.inputs,
        workers=settings.workers,
        limits=settings.policy_limits,
        scheduler=settings.scheduler,
    )
    with engine:
        replays = Replays(bench, engine, progress, None, settings.policy_limits)
        replays.make(
            place
            for label in labels
            for place in (_logged(label, options), *_others(label, spread))
        )
    for label, failure in replays.failures.items():
        raise InputError(f"{label}: expected a policy that runs; {failure}")
    pairs: dict[str, Pair] = {}
    for label in labels:
        log = replays[_logged(label, options)].log
        assert log is not None, "it was asked for"
        values = tuple(replays[place].values for place in _others(label, spread))
        pairs[label] = Pair(measured[label], log, values)
    setting = Setting(
        scene=scene.scene.name,
        trace=trace.name,
        trace_s=trace.duration_s,
        window_s=(settings.warmup_s, trace.duration_s),
        budget_ms=options.budget_ms,
        seed=options.seed,
        draws=len(draws),
    )
    return setting, pairs


def _logged(label: str, options: ReplayOptions) -> Place:
    return Place(label, 0, options.seed, logged=True)


def _others(label: str, spread: Sequence[tuple[int, int | None]]) -> list[Place]:
    return [Place(label, 0, seed, draw=draw) for seed, draw in spread]


def measured_of(recorded: Recorded) -> Measured:
    """Return a recording with its counts under the names of the cost model."""
    columns = recorded.columns
    return Measured(recorded.frames, columns | {"shaded_samples": columns["projected_px"]})
