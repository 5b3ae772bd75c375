"""Replay, compare and check from Python: what the commands do, with objects in place of names.

A policy is a name as on a command line, a class or an object.  A scene, a trace and a hardware
profile are bundled names, files, or what was loaded or made of arrays.
"""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from ..policies.registry import PolicyLike, PolicyLikes, spec_of, specs_of
from ..policies.registry import register_policy as _register_policy
from ..sim.frame_log import FrameLog
from ..sim.machine.faults import Faults
from ..sim.replay import ReplayOptions
from ..sim.replay import replay as _replay
from .study.field_of_view import field_of_view
from .study.inputs import (
    WHOLE,
    EyesLike,
    HardwareLike,
    SceneLike,
    Seconds,
    TraceLike,
    as_eyes,
    as_hardware,
    as_scene,
    as_trace,
    read_meshes,
)

if TYPE_CHECKING:  # loaded by the function that needs them
    from .gate.check_result import CheckReport
    from .study.comparison import Comparison


def replay(
    policy: PolicyLike,
    scene: SceneLike,
    trace: TraceLike,
    hardware: HardwareLike,
    *,
    budget_ms: float,
    seed: int = 0,
    frames: int | None = None,
    fovy_deg: float | None = None,
    crossfade_ms: float = 0.0,
    measurement_delay: int = 0,
    faults: Faults | None = None,
    bound_every: int = 0,
    draw: int | None = None,
    memory_bytes: float | None = None,
    eyes: EyesLike = None,
    visible_px: float = 1.0,
) -> FrameLog:
    """Replay a trace through a scene under one policy; return what happened, one row a frame.

    It is replayed in this very process, where a debugger sees it and what it prints is seen, and
    which it can end: `compare` and `check` replay in processes apart.

    Keywords are those of `ReplayOptions`, but that `eyes` may be metres between them; a `fovy_deg`
    of None is what the trace states, or 60.  The same arguments give the same bytes.

    Raises `InputError` if something named cannot be loaded, and `PolicyError` if the policy raises
    or a selection breaks its contract.
    """
    spec, world = spec_of(policy), as_scene(scene)
    path, machine = as_trace(trace, world), as_hardware(hardware)
    options = ReplayOptions(
        budget_ms=budget_ms,
        seed=seed,
        frames=frames,
        fovy_deg=field_of_view([path], fovy_deg),
        crossfade_ms=crossfade_ms,
        measurement_delay=measurement_delay,
        faults=faults or Faults(),
        bound_every=bound_every,
        draw=draw,
        memory_bytes=memory_bytes,
        eyes=as_eyes(eyes),
        visible_px=visible_px,
    )
    return _replay(spec.make(), world, path, machine, options, name=spec.label)


def compare(
    policies: PolicyLikes | None = None,
    *,
    scene: SceneLike = "district",
    traces: TraceLike | Sequence[TraceLike] = "trial",
    paths: int = 10,
    hardware: HardwareLike = "desktop-assumed",
    budget_ms: float | None = None,
    miss: float = 0.01,
    visible_px: float = 1.0,
    margin: float = 0.1,
    as_shipped: bool = False,
    seed: int = 0,
    seeds: int | None = None,
    seconds: Seconds = WHOLE,
    warmup_s: float = 1.0,
    fovy_deg: float | None = None,
    crossfade_ms: float = 0.0,
    measurement_delay: int = 0,
    faults: Faults | None = None,
    memory_bytes: float | None = None,
    players: int = 1,
    eyes: EyesLike = None,
    place: str = "shrink",
    draws: int = 8,
    workers: int = 1,
    scheduler: str | None = None,
    policy_timeout_s: float = 60.0,
    policy_memory_bytes: int | None = None,
    out: str | Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> "Comparison":
    """Tune policies to one budget, judge them on the same paths, and say which to take.

    A policy that breaks its contract is reported as failed, and the others are finished.

    Parameters
    ----------
    policies
        One, several, or a mapping of labels to policies; None for every registered one.
    traces
        Names, files, patterns of files, kinds of movement, or traces.
    paths
        Of each kind of movement.
    budget_ms
        None for one refresh of the display.
    miss
        Share of time for which a policy may exceed the budget and still keep it.
    visible_px
        Least error, and change of it, that is seen.
    margin
        Part of the best's value within which another is as good.
    as_shipped
        Whether no policy is tuned; one with parameters, and an object, never is.
    seeds
        Replays of each path under other noise; None for 2, or 5 of a single path.
    seconds
        The stretch of each path that is replayed, (start, end); an end of None is the path's.
    warmup_s
        Seconds at its start that do not count.
    players
        How many share a screen: so many paths after each other are one.
    eyes
        Metres between two eyes, or an `Eyes`; None for one camera.
    workers
        Processes; 0 for as many as there are processors.  No policy is replayed in this process.
    scheduler
        Address of a Dask scheduler, in place of processes here (docs/clusters.md).
    policy_timeout_s, policy_memory_bytes
        What a policy may take before it fails: see `Limits`.
    out
        Folder for report.html, comparison.json, all runs, frames of every policy, and pictures of
        worst moments.  A comparison that was stopped goes on, and one that the folder holds is not
        repeated.
    progress
        Called with the replays done and the replays asked for so far.

    Raises `InputError` if something cannot be loaded, or a label or parameter is refused.
    """
    from .study.compare import CompareSettings, compared_policies
    from .study.compare import compare as compare_specs
    from .study.comparison_target import claimed_target
    from .study.engine.limits import Limits
    from .study.engine.open_engine import prepare_engine
    from .study.paths import load_paths

    limits = Limits(timeout_s=policy_timeout_s, memory_bytes=policy_memory_bytes)
    with claimed_target(None if out is None else Path(out)) as target:
        prepare_engine(scheduler)
        world, machine = as_scene(scene), as_hardware(hardware)
        walked = load_paths(
            _several(traces),
            world,
            place,
            paths=paths,
            seconds=seconds,
            seed=seed,
            players=players,
        )
        options = ReplayOptions(
            budget_ms=machine.budget_ms(budget_ms),
            seed=seed,
            fovy_deg=field_of_view(walked, fovy_deg),
            crossfade_ms=crossfade_ms,
            measurement_delay=measurement_delay,
            faults=faults or Faults(),
            memory_bytes=memory_bytes,
            eyes=as_eyes(eyes),
            visible_px=visible_px,
        )
        compared = compare_specs(
            specs_of(compared_policies() if policies is None else policies),
            world,
            walked,
            machine,
            options,
            CompareSettings(
                warmup_s=warmup_s,
                miss=miss,
                margin=margin,
                as_shipped=as_shipped,
                seeds=seeds,
                draws=draws,
                workers=workers,
                policy_limits=limits,
                scheduler=scheduler,
            ),
            progress=progress,
            target=target,
            meshes=None if out is None else partial(read_meshes, scene),
        )
        if target is not None:
            target.write(compared)
    return compared.comparison


def check(
    policies: PolicyLikes,
    *,
    limits: str | Path | None = None,
    baseline: str | Path = "baseline.json",
    allow_new: bool = False,
    scenes: SceneLike | Sequence[SceneLike] = "district",
    traces: TraceLike | Sequence[TraceLike] = "trial",
    paths: int = 4,
    hardware: HardwareLike = "desktop-assumed",
    budget_ms: float | None = None,
    seed: int = 0,
    seeds: int = 4,
    seconds: Seconds = WHOLE,
    warmup_s: float = 1.0,
    visible_px: float = 1.0,
    fovy_deg: float | None = None,
    crossfade_ms: float = 0.0,
    measurement_delay: int = 0,
    faults: Faults | None = None,
    memory_bytes: float | None = None,
    eyes: EyesLike = None,
    players: int = 1,
    place: str = "shrink",
    workers: int = 1,
    scheduler: str | None = None,
    policy_timeout_s: float = 60.0,
    policy_memory_bytes: int | None = None,
    strict: bool = False,
) -> "CheckReport":
    """Judge policies by limits on their metrics, as `lodbench check` does.

    Parameters
    ----------
    limits
        TOML file; None for the 99th percentile of the work time within the budget on such paths
        and, if there is a baseline, at most 2.5 % up on these.
    allow_new
        What the baseline lacks passes.
    paths
        Of a kind of movement, each by a seed of its own.
    seeds
        Replays of each policy on each path.
    seconds
        The stretch of each path that is replayed, (start, end).
    budget_ms, warmup_s, visible_px, eyes, players, workers, scheduler, policy_timeout_s,
    policy_memory_bytes
        As `compare` has them.
    strict
        What is undecided fails.

    Raises `InputError` if something cannot be loaded, the baseline is of other conditions, or paths
    and budget cannot tell a good policy from a bad one.
    """
    from .gate.check import CheckPlan, judge_measured, measure_plan
    from .gate.limits_file import choose_limits
    from .gate.measurements import MeasureOptions
    from .study.engine.limits import Limits
    from .study.engine.open_engine import prepare_engine

    chosen = choose_limits(None if limits is None else Path(limits), Path(baseline))
    plan = CheckPlan(
        policies=policies,
        scenes=_several(scenes),
        traces=_several(traces),
        paths=paths,
        hardware=hardware,
        budget_ms=budget_ms,
        seed=seed,
        seconds=seconds,
        warmup_s=warmup_s,
        visible_px=visible_px,
        fovy_deg=fovy_deg,
        crossfade_ms=crossfade_ms,
        measurement_delay=measurement_delay,
        faults=faults,
        memory_bytes=memory_bytes,
        eyes=as_eyes(eyes),
        players=players,
        place=place,
    )
    options = MeasureOptions(
        seeds=seeds,
        workers=workers,
        policy_limits=Limits(timeout_s=policy_timeout_s, memory_bytes=policy_memory_bytes),
        scheduler=scheduler,
    )
    prepare_engine(scheduler)
    conditions, measured = measure_plan(plan, options)
    return judge_measured(
        chosen, measured, conditions, Path(baseline), strict=strict, allow_new=allow_new
    )


def register(name: str, thing: Any) -> None:
    """Give a policy class, a `TraceFormat` or a `LogFormat` a name of its own in this process.

    From then on it goes by that name wherever one of ours does.

    Raises `InputError` if the name is one of ours, or the thing is none of these.
    """
    from ..traces.cameras import read_trace
    from ..traces.cameras.trace_format import TraceFormat
    from ..traces.logs import read_log as logs
    from ..traces.logs.log_format import LogFormat

    if isinstance(thing, TraceFormat):
        read_trace.register_format(name, thing)
    elif isinstance(thing, LogFormat):
        logs.register_format(name, thing)
    else:
        _register_policy(name, thing)


def _several(items: Any) -> tuple[Any, ...]:
    """Return one thing or a sequence of them as a tuple."""
    return tuple(cast("Sequence[Any]", items)) if isinstance(items, (list, tuple)) else (items,)
