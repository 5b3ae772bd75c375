"""Run what a check asks for and judge it: the one path of the command and of failing tests."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ...base.errors import InputError
from ...models.scene.rig import Eyes
from ...policies.registry import PolicyLikes, specs_of
from ...sim.machine.faults import Faults
from ...sim.replay import ReplayOptions
from ..study.field_of_view import field_of_view
from ..study.inputs import (
    WHOLE,
    HardwareLike,
    SceneLike,
    Seconds,
    TraceLike,
    as_hardware,
    as_scene,
)
from ..study.paths import load_paths
from ..study.runs import Progress
from ..verdict.warnings import find_warnings
from .baseline import read_baseline
from .check_result import CheckReport, judge_all
from .limits import LimitRules
from .measurements import Conditions, MeasuredPolicy, MeasureOptions, measure


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckPlan:
    """What is replayed: every policy in every scene on every path, as it is given.

    Attributes
    ----------
    policies : by name, class, object, or a mapping of labels to these
    scenes, traces, hardware : bundled names, files, or what was loaded from them
    paths : int
        Paths of a kind of movement, each by a seed of its own.
    budget_ms : float or None
        None for one refresh of the display.
    seconds : (start, end)
        Stretch of each path that is replayed; an end of None is the path's.
    fovy_deg : float or None
        None for what the paths state, or 60.
    warmup_s : float
        Seconds at the start of it that do not count.
    players : int
        Who share the screen: so many paths after each other are one.
    place : str
        How the trace of a file is put into a scene.
    """

    policies: PolicyLikes
    scenes: tuple[SceneLike, ...] = ("district",)
    traces: tuple[TraceLike, ...] = ("trial",)
    paths: int = 4
    hardware: HardwareLike = "desktop-assumed"
    budget_ms: float | None = None
    seed: int = 0
    seconds: Seconds = WHOLE
    warmup_s: float = 1.0
    visible_px: float = 1.0
    fovy_deg: float | None = None
    crossfade_ms: float = 0.0
    measurement_delay: int = 0
    faults: Faults | None = None
    memory_bytes: float | None = None
    eyes: Eyes | None = None
    players: int = 1
    place: str = "shrink"


def measure_plan(
    plan: CheckPlan, sampling: MeasureOptions, progress: Progress | None = None
) -> tuple[Conditions, list[MeasuredPolicy]]:
    """Replay a plan.

    Raises `InputError` if a name is unknown, a file cannot be read, or two scenes have one name.
    """
    if not plan.policies:
        raise InputError("policy: expected the policies to check, got none; name one")
    profile = as_hardware(plan.hardware)
    options = ReplayOptions(
        budget_ms=profile.budget_ms(plan.budget_ms),
        seed=plan.seed,
        visible_px=plan.visible_px,
        crossfade_ms=plan.crossfade_ms,
        measurement_delay=plan.measurement_delay,
        faults=plan.faults or Faults(),
        memory_bytes=plan.memory_bytes,
        eyes=plan.eyes,
    )
    specs = specs_of(plan.policies)
    scenes = [as_scene(scene) for scene in plan.scenes]
    names = [scene.name for scene in scenes]
    if len(set(names)) < len(names):
        raise InputError(f"scene: expected scenes of different names, got {', '.join(names)}")
    found: list[MeasuredPolicy] = []
    conditions: Conditions | None = None
    for at, scene in enumerate(scenes):
        paths = load_paths(
            plan.traces,
            scene,
            plan.place,
            paths=plan.paths,
            seconds=plan.seconds,
            seed=plan.seed,
            players=plan.players,
        )
        share = progress and _share(progress, at, len(scenes))
        told = replace(options, fovy_deg=field_of_view(paths, plan.fovy_deg))
        conditions, measured = measure(
            specs, scene, paths, profile, told, sampling, plan.warmup_s, share
        )
        found += measured
    assert conditions is not None, "there is a scene"
    return conditions, found


def _share(progress: Progress, before: int, scenes: int) -> Progress:
    """Return the progress of one of several scenes, all of which have as many replays."""
    return lambda done, total: progress(before * total + done, scenes * total)


def require_load(measured: Sequence[MeasuredPolicy], budget_ms: float) -> None:
    """Raise `InputError` if nothing is in view on a path, or no policy could miss the budget.

    A gate that watches an empty street passes whatever it is given.
    """
    by_scene: dict[str, MeasuredPolicy] = {}
    for item in measured:  # an oracle of a comparison has fewer paths than others
        known = by_scene.get(item.scene)
        if item.runs and (known is None or len(item.runs) > len(known.runs)):
            by_scene[item.scene] = item
    for scene, item in by_scene.items():
        footings = [seeds[0].footing for seeds in item.runs]
        for warning in find_warnings(item.paths, footings, budget_ms, ()):
            raise InputError(f"{scene}: {warning}")


def judge_measured(
    limits: LimitRules,
    measured: Sequence[MeasuredPolicy],
    conditions: Conditions,
    baseline: Path,
    *,
    strict: bool = False,
    allow_new: bool = False,
) -> CheckReport:
    """Judge what was measured; the baseline is read if a limit needs it and there is one.

    Raises `InputError` if it cannot be read, or is of other conditions; if a limit has too few
    paths or seeds; or if paths and budget tell nothing (`require_load`).
    """
    require_load(measured, conditions.budget_ms)
    stored = None
    if limits.relative and baseline.exists():
        stored = read_baseline(baseline, conditions)
    return judge_all(limits, measured, conditions, stored, strict=strict, allow_new=allow_new)
