"""Run what a check asks for and judge it: the one path of the command and of failing tests."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from ...base.errors import InputError
from ...models.machine.hardware import HardwareProfile
from ...models.machine.profile_catalog import load_hardware
from ...models.scene.scene import Scene
from ...models.scene.scene_catalog import load_scene
from ...policies.registry import PolicyLikes, specs_of
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from ..study.inputs import load_trace
from ..study.score import World
from .baseline import read_baseline
from .check_result import CheckReport, judge_all
from .limits import Limits
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
    place : str
        How the trace of a file is put into a scene.
    """

    policies: PolicyLikes
    scenes: tuple[str | Scene, ...] = ("plaza",)
    traces: tuple[str | CameraTrace, ...] = ("tour",)
    hardware: str | HardwareProfile = "desktop-assumed"
    budget_ms: float | None = None
    seed: int = 0
    frames: int | None = None
    warmup: int = 30
    place: str = "shrink"


def measure_plan(
    plan: CheckPlan, sampling: MeasureOptions
) -> tuple[Conditions, list[MeasuredPolicy]]:
    """Replay a plan.

    Raises `InputError` if a name is unknown, a file cannot be read, or two scenes or traces have
    one name.
    """
    if not plan.policies:
        raise InputError("policy: expected the policies to check, got none; name one")
    profile = load_hardware(plan.hardware) if isinstance(plan.hardware, str) else plan.hardware
    budget_ms = 1e3 / profile.display.refresh_hz if plan.budget_ms is None else plan.budget_ms
    options = ReplayOptions(budget_ms=budget_ms, seed=plan.seed, frames=plan.frames)
    specs = specs_of(plan.policies)
    scenes = [load_scene(item) if isinstance(item, str) else item for item in plan.scenes]
    found: dict[tuple[str, str], tuple[Conditions, list[MeasuredPolicy]]] = {}
    for scene, item in product(scenes, plan.traces):
        trace = load_trace(item, scene, plan.place) if isinstance(item, str) else item
        names = (scene.name, trace.name)
        if names in found:
            raise InputError(f"expected scenes and traces of different names, got {names} twice")
        world = World(scene, trace, profile, options, plan.warmup)
        found[names] = measure(specs, world, sampling)
    conditions = next(iter(found.values()))[0]
    return conditions, [item for _, measured in found.values() for item in measured]


def judge_measured(
    limits: Limits,
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
