"""Compare simulated replays with recorded ones: frame by frame, metric by metric, rank by rank."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...models.machine.hardware import HardwareProfile
from ...sim.frame_log import FrameLog
from ...traces.logs.log_writer import header_text
from ..metrics.measured_frames import MeasuredFrames
from ..metrics.metric_registry import METRICS
from ..study.score import Scored
from ..verdict.scores import LEVEL
from .ranks import kendall_tau
from .time_errors import adapted_ms, at_times, summarise
from .validation_result import Agreement, Errors, PolicyValidation, Rank, Validation

UNRECORDED = ("splats", "texture_bytes")
"""GPU predictors that a recording does not count."""


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """One recording.

    Attributes
    ----------
    frames : FrameLog
    counts : dict of str to (n,) float64
        What was drawn, by GPU predictor; ``shaded_samples`` as the simulator counts them.
    """

    frames: FrameLog
    counts: Mapping[str, FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """One policy's replays.

    Attributes
    ----------
    measured : one or two recordings, the second of the same replay again
    simulated : the replay under the profile's mean
    """

    measured: tuple[Measured, ...]
    simulated: FrameLog


@dataclass(frozen=True, slots=True, eq=False)
class Simulated:
    """One policy's simulated replays.

    Attributes
    ----------
    mean : Scored
        Under the profile's mean, with its frame log.
    drawn : tuple of Scored
        Under each posterior draw; none if the profile has none.
    """

    mean: Scored
    drawn: tuple[Scored, ...]

    @property
    def log(self) -> FrameLog:
        """Frames under the mean."""
        assert self.mean.log is not None, "it is asked for with its log"
        return self.mean.log

    def interval(self, metric: str) -> tuple[float, float] | tuple[None, None]:
        """Return where a metric lies over the draws at `LEVEL`, nothing if a draw has no value."""
        values = [run.values[metric] for run in self.drawn]
        known = [value for value in values if value is not None]
        if not known or len(known) < len(values):
            return None, None
        low, high = np.quantile(known, ((1.0 - LEVEL) / 2.0, (1.0 + LEVEL) / 2.0)).tolist()
        return low, high


@dataclass(frozen=True, slots=True, eq=False)
class Simulation:
    """What was simulated on one path, and by what it is scored.

    Attributes
    ----------
    window_s : (from, to)
        Seconds of the path that count.
    policies : dict of str to Simulated
        By label.
    """

    scene: str
    trace: str
    trace_s: float
    budget_ms: float
    seed: int
    window_s: tuple[float, float]
    policies: Mapping[str, Simulated]


def require_other_frames(hardware: HardwareProfile, scene: str, trace: str) -> None:
    """Raise InputError if the profile was calibrated on this scene along this trace."""
    if f"{header_text(scene)} along {header_text(trace)}" in hardware.provenance.measured_on:
        raise InputError(
            f"--hardware {hardware.name}: expected a profile calibrated on other frames, got one "
            f"of {scene} along {trace}; validate on another scene or trace"
        )


def require_priced(hardware: HardwareProfile) -> None:
    """Raise InputError unless a profile's model can be compared with what is recorded."""
    costs = hardware.gpu
    if costs.has_roofline:
        raise InputError(
            f"--hardware {hardware.name}: expected a linear model to compare with logs, whose "
            "sums do not tell the sides of a roofline, got a roofline; fit single predictors"
        )
    for name in UNRECORDED:
        if costs.unit_ms(name) > 0.0:
            raise InputError(
                f"--hardware {hardware.name}: expected costs of what is recorded, got one of "
                f"{name}; fit a log of `lodbench record`"
            )


def validate(
    simulation: Simulation,
    pairs: Mapping[str, Pair],
    hardware: HardwareProfile,
    log: dict[str, str],
) -> Validation:
    """Return how simulation and recordings agree.

    Raises `InputError` if a recording has no frame in the window, or only one.

    Parameters
    ----------
    pairs : by label, in the order of the policies
    log : header of the recordings
    """
    runs = {label: _measured(pair, simulation.window_s) for label, pair in pairs.items()}
    series = {label: _series(pair, runs[label], hardware) for label, pair in pairs.items()}
    policies = tuple(
        _policy(label, pair, runs[label], simulation.policies[label], series[label])
        for label, pair in pairs.items()
    )
    known = [
        item.inside for p in policies for item in p.metrics.values() if item.inside is not None
    ]
    return Validation(
        scene=simulation.scene,
        trace=simulation.trace,
        trace_s=simulation.trace_s,
        hardware=hardware.name,
        hardware_source=hardware.provenance.source,
        measured_on=hardware.provenance.measured_on,
        budget_ms=simulation.budget_ms,
        seed=simulation.seed,
        window_s=simulation.window_s,
        level=LEVEL,
        draws=max((len(each.drawn) for each in simulation.policies.values()), default=0),
        log=log,
        policies=policies,
        all_policies=_errors(*series.values()),
        inside=float(np.mean(known)) if known else None,
        ranks=_ranks(policies),
    )


def _policy(
    label: str, pair: Pair, runs: "_Runs", simulated: Simulated, series: dict[str, FloatArray]
) -> PolicyValidation:
    values = [{metric.id: metric(run) for metric in METRICS} for run in runs.measured]
    again = values[1] if len(values) > 1 else dict.fromkeys(values[0])
    metrics: dict[str, Agreement] = {}
    for metric in METRICS:
        value, measured = simulated.mean.values[metric.id], values[0][metric.id]
        low, high = simulated.interval(metric.id)
        inside = None
        if measured is not None and low is not None and high is not None:
            inside = low <= measured <= high
        metrics[metric.id] = Agreement(
            measured, again[metric.id], value, low, high, inside, metric.unit
        )
    frames = len(pair.measured[0].frames), len(pair.simulated)
    return PolicyValidation(label, *frames, _errors(series), metrics)


@dataclass(frozen=True, slots=True, eq=False)
class _Runs:
    """The frames of a pair that count."""

    measured: tuple[MeasuredFrames, ...]
    simulated: MeasuredFrames


def _measured(pair: Pair, window_s: tuple[float, float]) -> _Runs:
    measured = tuple(MeasuredFrames(item.frames, *window_s) for item in pair.measured)
    return _Runs(measured, MeasuredFrames(pair.simulated, *window_s))


def _series(pair: Pair, runs: _Runs, hardware: HardwareProfile) -> dict[str, FloatArray]:
    """Return predicted times over those of the first recording, (2, n), as `Errors` names them."""
    first, *others = runs.measured
    model = hardware.gpu.counted_ms(pair.measured[0].counts)
    adapted = adapted_ms(model, np.asarray(first.log["gpu_ms"]))
    inside = slice(first.first, first.first + len(first))
    predicted = {
        "model": model[inside],
        "v_time": adapted[inside],
        "simulation": _at(runs.simulated, first.time_s),
    }
    for other in others:
        predicted["again"] = _at(other, first.time_s)
    return {name: np.stack((times, first.work_ms)) for name, times in predicted.items()}


def _at(run: MeasuredFrames, wanted_s: FloatArray) -> FloatArray:
    return at_times(run.time_s, run.work_ms, wanted_s)


def _errors(*parts: dict[str, FloatArray]) -> Errors:
    """Return the errors of all parts together."""
    joined = {name: np.hstack([part[name] for part in parts]) for name in parts[0]}
    return Errors(**{name: summarise(*times) for name, times in joined.items()})


def _ranks(policies: Sequence[PolicyValidation]) -> dict[str, Rank]:
    """Return τ by metric, of those that tell some policies apart in either."""
    ranks: dict[str, Rank] = {}
    for metric in METRICS:
        items = [policy.metrics[metric.id] for policy in policies]
        measured = [item.measured for item in items]
        simulated = kendall_tau(measured, [item.simulated for item in items])
        again = kendall_tau(measured, [item.again for item in items])
        if simulated is not None or again is not None:
            ranks[metric.id] = Rank(simulated, again)
    return ranks
