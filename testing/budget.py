"""A frame budget to assert: `lodbench check` as a function."""

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..analysis.gate.check import CheckPlan, judge_measured, measure_plan
from ..analysis.gate.limits_file import choose_limits
from ..analysis.gate.measurements import MeasureOptions
from ..analysis.gate.plain_text import describe, describe_failures
from ..analysis.study.inputs import WHOLE, Seconds, load_trace
from ..models.machine.hardware import HardwareProfile
from ..models.machine.profile_catalog import load_hardware
from ..models.scene.scene import Scene
from ..models.scene.scene_catalog import load_scene
from ..policies.registry import parse_policy
from ..sim.frame_log import FrameLog
from ..sim.replay import ReplayOptions, replay
from ..traces.cameras.camera_trace import CameraTrace
from .naming import name_policy


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameBudget:
    """What is asserted, and how much is replayed; as the options of `lodbench check`.

    Attributes
    ----------
    limits : Path or None
        TOML file; None for the budget alone.
    baseline : Path
    paths : int
        Paths of a kind of movement.
    seeds : int
        Replays on each path.
    seconds : (start, end)
        Stretch of each path that is replayed; an end of None is the path's.
    strict : bool
        What is undecided fails.
    allow_new : bool
        What the baseline lacks passes.
    """

    limits: Path | None = None
    baseline: Path = Path("baseline.json")
    hardware: str | HardwareProfile = "desktop-assumed"
    budget_ms: float | None = None
    paths: int = 4
    seed: int = 0
    seeds: int = 4
    seconds: Seconds = WHOLE
    warmup_s: float = 1.0
    strict: bool = False
    allow_new: bool = False


def assert_budget(
    policy: str | type[Any],
    scene: str | Scene = "district",
    trace: str | CameraTrace = "trial",
    budget: FrameBudget | None = None,
) -> None:
    """Assert that a policy keeps its limits in a scene, on a trace or on paths of a kind.

    The message of a failure is what `lodbench check` prints of it; what is undecided is a warning.

    Raises
    ------
    AssertionError
        If a limit fails, or with `strict` is undecided.
    InputError
        If a name, file or limit cannot be used, or nothing there could break the budget.
    """
    __tracebackhide__ = True  # for pytest: the message says all
    chosen = budget or FrameBudget()
    limits = choose_limits(chosen.limits, chosen.baseline)
    plan = CheckPlan(
        policies=(name_policy(policy),),
        scenes=(scene,),
        traces=(trace,),
        paths=chosen.paths,
        hardware=chosen.hardware,
        budget_ms=chosen.budget_ms,
        seed=chosen.seed,
        seconds=chosen.seconds,
        warmup_s=chosen.warmup_s,
    )
    conditions, measured = measure_plan(plan, MeasureOptions(seeds=chosen.seeds))
    report = judge_measured(
        limits,
        measured,
        conditions,
        chosen.baseline,
        strict=chosen.strict,
        allow_new=chosen.allow_new,
    )
    if not report.passed:
        raise AssertionError(describe_failures(report))
    for verdict in report.verdicts:
        if verdict.outcome == "undecided":
            warnings.warn(describe(verdict), stacklevel=2)


def replay_policy(
    policy: str | type[Any],
    scene: str | Scene = "district",
    trace: str | CameraTrace = "trial",
    budget: FrameBudget | None = None,
    *,
    seed: int | None = None,
    seconds: Seconds | None = None,
) -> FrameLog:
    """Replay a policy in a scene on a trace; seed and stretch may be others than the budget's.

    Raises
    ------
    InputError
        If a name or file cannot be used.
    PolicyError
        If the policy breaks its contract.
    """
    chosen = budget or FrameBudget()
    hardware = chosen.hardware
    profile = load_hardware(hardware) if isinstance(hardware, str) else hardware
    world = load_scene(scene) if isinstance(scene, str) else scene
    path = load_trace(trace, world) if isinstance(trace, str) else trace
    options = ReplayOptions(
        budget_ms=profile.budget_ms(chosen.budget_ms),
        seed=chosen.seed if seed is None else seed,
    )
    path = path.stretch(*(chosen.seconds if seconds is None else seconds))
    name = name_policy(policy)
    return replay(parse_policy(name).make(), world, path, profile, options, name=name)
