"""Compare simulated replays with recorded ones, on one path and on all together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...models.machine.hardware import HardwareProfile
from ...sim.frame_log import FrameLog
from ...traces.logs.log_writer import header_text
from ..metrics.measured_frames import MeasuredFrames
from ..metrics.metric_registry import METRICS
from ..verdict.scores import LEVEL
from ..verdict.verdict import LEAST
from .answer import answer
from .measures.agreement import agree, share_inside
from .measures.decisions import count_decided, decide, first_of, leaders
from .measures.frame_errors import (
    FrameErrors,
    cost_ratio,
    detail_error,
    frame_errors,
    summarise_all,
)
from .measures.machine_factor import machine_factor
from .measures.ranks import Pairs, compare_pairs, rank
from .measures.time_errors import at_times
from .recorded_frames import (
    Measured,
    Stretch,
    drift_of,
    frames_in_flight,
    stretch_of,
    usual_reference_ms,
)
from .replicates import Simulated, Simulation
from .validation_result import (
    Case,
    Decision,
    DetailError,
    PolicyValidation,
    Pooled,
    Validation,
)

UNRECORDED = ("splats", "texture_bytes")
"""GPU predictors that a recording does not count."""


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


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """A case with what its policies' figures are pooled from.

    Attributes
    ----------
    errors, corrected : of each policy; corrected ones where there is a reference drawing
    pairs : by metric
    """

    case: Case
    errors: tuple[FrameErrors, ...]
    corrected: tuple[FrameErrors, ...]
    pairs: Mapping[str, Pairs]


@dataclass(frozen=True, slots=True, eq=False)
class _Policy:
    """One policy, before it is compared with others."""

    stretches: tuple[Stretch, ...]
    simulated: Simulated
    errors: FrameErrors
    corrected: FrameErrors | None
    values: tuple[dict[str, float | None], ...]
    judged_ms: tuple[float, ...]


def judge_case(
    simulation: Simulation,
    recordings: Mapping[str, Sequence[Measured]],
    hardware: HardwareProfile,
    log: Mapping[str, str],
    failed: Mapping[str, str] | None = None,
) -> Judged:
    """Return how simulation and recordings agree on one path.

    A policy that cannot be compared, such as one whose recording has no frame in the window, fails
    by name, and the others are compared.

    Parameters
    ----------
    recordings : one or two by label, in the order of the policies
    log : header of the recordings
    failed : why policies were not recorded
    """
    failures = {**(failed or {}), **simulation.failed}
    every = [item for passed in recordings.values() for item in passed]
    usual_ms = usual_reference_ms(every)
    policies: dict[str, _Policy] = {}
    for label, passed in recordings.items():
        if label in failures:
            continue
        try:
            policies[label] = _compare(
                passed, simulation, simulation.policies[label], hardware, usual_ms
            )
        except InputError as error:
            failures[label] = error.message
    deep = frames_in_flight(log)
    leading = _Leading.of(policies, simulation)
    results = tuple(
        _result(label, item, simulation, leading, deep) for label, item in policies.items()
    )
    errors = tuple(item.errors for item in policies.values())
    corrected = tuple(item.corrected for item in policies.values() if item.corrected is not None)
    pairs = _pairs(list(policies.values()))
    case = Case(
        scene=simulation.scene,
        trace=simulation.trace,
        trace_s=simulation.trace_s,
        budget_ms=simulation.budget_ms,
        seed=simulation.seed,
        window_s=simulation.window_s,
        frames_in_flight=deep,
        log=dict(log),
        drift=drift_of(every),
        policies=results,
        failed=failures,
        all_policies=summarise_all(errors),
        all_corrected=summarise_all(corrected),
        first_measured=leading.measured,
        first_simulated=leading.simulated,
        inside=share_inside(results),
        ranks={name: rank([part], LEVEL) for name, part in pairs.items()},
    )
    return Judged(case, errors, corrected, pairs)


def validate(
    judged: Sequence[Judged], hardware: HardwareProfile, replicates: int, draws: int
) -> Validation:
    """Return a validation of cases, with what they say together."""
    policies = [(item.case, policy) for item in judged for policy in item.case.policies]
    names = dict.fromkeys(name for item in judged for name in item.pairs)
    pooled = Pooled(
        errors=summarise_all([each for item in judged for each in item.errors]),
        corrected=summarise_all([each for item in judged for each in item.corrected]),
        inside=share_inside(policy for _, policy in policies),
        ranks={
            name: rank([item.pairs[name] for item in judged if name in item.pairs], LEVEL)
            for name in names
        },
        keeps_budget=count_decided(
            (policy.keeps_budget, _off_budget(policy, case.budget_ms)) for case, policy in policies
        ),
        first=count_decided((policy.first, 0.0) for _, policy in policies),
        machine=machine_factor(
            [policy.cost_ratio for _, policy in policies],
            hardware.scatter,
            len({case.scene for case, _ in policies}) or 1,
        ),
    )
    found = Validation(
        hardware=hardware.name,
        hardware_source=hardware.provenance.source,
        measured_on=hardware.provenance.measured_on,
        level=LEVEL,
        replicates=replicates,
        draws=draws,
        cases=tuple(item.case for item in judged),
        pooled=pooled,
    )
    return replace(found, answer=answer(found))


def _off_budget(policy: PolicyValidation, budget_ms: float) -> float:
    """Return how far all recordings of a policy are off the budget, as a share of it."""
    return min(abs(ms / budget_ms - 1.0) for ms in policy.judged_ms)


def _compare(
    passed: Sequence[Measured],
    simulation: Simulation,
    simulated: Simulated,
    hardware: HardwareProfile,
    usual_ms: float | None,
) -> _Policy:
    stretches = tuple(stretch_of(item, simulation.window_s) for item in passed)
    mean = MeasuredFrames(simulated.log, *simulation.window_s)
    errors = frame_errors(stretches, mean, hardware)
    summarise_all([errors])  # a recording of one frame is told by its policy
    return _Policy(
        stretches,
        simulated,
        errors,
        None if usual_ms is None else frame_errors(stretches, mean, hardware, usual_ms),
        tuple(stretch.values() for stretch in stretches),
        tuple(stretch.judged_ms(simulation.miss) for stretch in stretches),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Leading:
    """Who is first: by label, in the replicates and in the recordings, with who leads in each."""

    decisions: Mapping[str, Decision]
    measured: str | None
    simulated: str | None

    @classmethod
    def of(cls, policies: Mapping[str, _Policy], simulation: Simulation) -> "_Leading":
        labels = list(policies)
        if not labels:
            return cls({}, None, None)
        passes = min(len(item.stretches) for item in policies.values())
        measured = np.array([item.judged_ms[:passes] for item in policies.values()])
        simulated = np.array(
            [[run.judged_ms for run in p.simulated.replicates] for p in policies.values()]
        )
        tables = {
            name: np.array(
                [[values[name] for values in item.values[:passes]] for item in policies.values()],
                dtype=np.float64,
            )
            for name in LEAST
        }
        drawn = {
            name: np.array([item.simulated.values(name) for item in policies.values()])
            for name in LEAST
        }
        found = leaders(measured <= simulation.budget_ms, measured, tables)
        expected = leaders(simulated <= simulation.budget_ms, simulated, drawn)
        decisions = {
            label: decide(expected[at] > 0.0, found[at] > 0.0) for at, label in enumerate(labels)
        }
        most = np.bincount(first_of(expected, simulated), minlength=len(labels)).argmax()
        return cls(decisions, labels[first_of(found, measured)[0]], labels[int(most)])


def _result(
    label: str, item: _Policy, simulation: Simulation, leading: _Leading, deep: int
) -> PolicyValidation:
    budget_ms, runs = simulation.budget_ms, item.simulated.replicates
    errors = summarise_all([item.errors])
    assert errors is not None
    return PolicyValidation(
        label=label,
        frames_measured=len(item.stretches[0].measured.frames),
        frames_simulated=len(item.simulated.log),
        errors=errors,
        corrected=None if item.corrected is None else summarise_all([item.corrected]),
        detail=_detail(item, simulation.full),
        cost_ratio=cost_ratio(item.corrected or item.errors),
        judged_ms=item.judged_ms,
        keeps_budget=decide(
            np.array([run.judged_ms <= budget_ms for run in runs]),
            np.array(item.judged_ms) <= budget_ms,
        ),
        first=leading.decisions[label],
        metrics=agree(item.values, [run.values for run in runs], LEVEL, deep),
    )


def _detail(item: _Policy, full: FrameLog | None) -> DetailError | None:
    """Return how the error goes with detail: triangles drawn over all of them at that moment."""
    if full is None:
        return None
    first = item.stretches[0]
    time_s = np.multiply(full["input_ns"], 1e-9, dtype=np.float64)
    in_view = at_times(time_s, full["triangles"], first.run.time_s)
    share = np.divide(
        first.count("triangles"), in_view, out=np.full(len(in_view), np.nan), where=in_view > 0.0
    )
    return detail_error(item.corrected or item.errors, share)


def _pairs(policies: Sequence[_Policy]) -> dict[str, Pairs]:
    """Return the pairs of the policies by metric, of those in which two have a value."""
    found: dict[str, Pairs] = {}
    passes = min((len(item.values) for item in policies), default=0)
    for metric in METRICS:
        measured = _table([[v[metric.id] for v in item.values[:passes]] for item in policies])
        replicates = _table([item.simulated.values(metric.id) for item in policies])
        pairs = compare_pairs(measured, replicates) if len(policies) > 1 else None
        if pairs is not None:
            found[metric.id] = pairs
    return found


def _table(rows: Sequence[Sequence[float | None] | FloatArray]) -> FloatArray:
    return np.array(rows, dtype=np.float64)
