"""Run what a check asks for and judge it: the one path of the command and of failing tests."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

from ...base.errors import InputError
from ...policies.registry import PolicyLikes, specs_of
from ...sim.replay import ReplayOptions
from ..study.inputs import (
    WHOLE,
    HardwareLike,
    SceneLike,
    Seconds,
    TraceLike,
    as_hardware,
    as_scene,
    as_trace,
)
from ..study.runs import Progress
from ..study.score import World
from .baseline import read_baseline
from .check_result import CheckReport, judge_all
from .limits import LimitRules
from .measurements import Conditions, MeasuredPolicy, MeasureOptions, measure


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckPlan:
    """What is replayed: every policy in every scene on every trace.

    Attributes
    ----------
    policies : by name, class, object, or a mapping of labels to these
    scenes, traces, hardware : bundled names, files, or what was loaded from them
    budget_ms : float or None
        None for one refresh of the display.
    seconds : (start, end)
        The stretch of each trace that is replayed; the end is None for the trace's.
    warmup_s : float
        Seconds at the start of it that do not count.
    place : str
        How the trace of a file is put into a scene.
    """

    policies: PolicyLikes
    scenes: tuple[SceneLike, ...] = ("plaza",)
    traces: tuple[TraceLike, ...] = ("tour",)
    hardware: HardwareLike = "desktop-assumed"
    budget_ms: float | None = None
    seed: int = 0
    seconds: Seconds = WHOLE
    warmup_s: float = 1.0
    visible_px: float = 1.0
    place: str = "shrink"


def measure_plan(
    plan: CheckPlan, sampling: MeasureOptions, progress: Progress | None = None
) -> tuple[Conditions, list[MeasuredPolicy]]:
    """Replay a plan.

    Raises `InputError` if a name is unknown, a file cannot be read, or two scenes or traces have
    one name.
    """
    if not plan.policies:
        raise InputError("policy: expected the policies to check, got none; name one")
    profile = as_hardware(plan.hardware)
    budget_ms = profile.budget_ms(plan.budget_ms)
    options = ReplayOptions(budget_ms=budget_ms, seed=plan.seed, visible_px=plan.visible_px)
    specs = specs_of(plan.policies)
    results: dict[tuple[str, str], tuple[Conditions, list[MeasuredPolicy]]] = {}
    for scene, item in product(map(as_scene, plan.scenes), plan.traces):
        trace = as_trace(item, scene, plan.place)
        names = (scene.name, trace.name)
        if names in results:
            raise InputError(f"expected scenes and traces of different names, got {names} twice")
        path = trace.stretch(*plan.seconds)
        world = World(scene, path, profile, options, plan.warmup_s)
        share = progress and _share(progress, len(results), len(plan.scenes) * len(plan.traces))
        conditions, measured = measure(specs, world, sampling, share)
        # Limits name the path; which stretch of it is a condition, the same for all.
        results[names] = (
            replace(conditions, seconds=plan.seconds),
            [replace(one, trace=trace.name) for one in measured],
        )
    conditions = next(iter(results.values()))[0]
    return conditions, [item for _, measured in results.values() for item in measured]


def _share(progress: Progress, before: int, worlds: int) -> Progress:
    """Return the progress of one of several worlds, all of which have as many replays."""
    return lambda done, total: progress(before * total + done, worlds * total)


def judge_measured(
    limits: LimitRules,
    measured: Sequence[MeasuredPolicy],
    conditions: Conditions,
    baseline: Path,
    *,
    strict: bool = False,
) -> CheckReport:
    """Judge what was measured; the baseline is read if a limit needs it.

    Raises `InputError` if it is needed and missing, or of other conditions.
    """
    stored = read_baseline(baseline, conditions) if limits.relative else None
    return judge_all(limits, measured, conditions, stored, strict=strict)
