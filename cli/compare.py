"""`lodbench compare`: replay policies in one world and score them on the same footing."""

from pathlib import Path
from typing import Annotated

from typer import Exit, Option

from .shared import options
from .shared.progress import progress_bar
from .shared.terminal import (
    failure_of,
    open_named_scene,
    print_record,
    table_console,
)

Policies = Annotated[
    list[str] | None,
    Option(help=f"{options.POLICY_HELP}; may be repeated. Without it, every registered policy."),
]
Out = Annotated[
    Path | None,
    Option(
        metavar="DIR",
        help="Write report.html, comparison.json and frames/POLICY.parquet. "
        "Only a folder that compare wrote is replaced. The same command goes on where it was "
        "stopped.",
    ),
]
Wide = Annotated[bool, Option("--wide", help="Print every metric with its interval.")]
Display = Annotated[
    str | None, Option(help="immediate, vsync, mailbox or vrr; else the profile's.")
]
RefreshHz = Annotated[float | None, Option(help="Refresh rate; else the profile's.")]
FramesInFlight = Annotated[int | None, Option(help="1 to 4; else the profile's.")]
CrossfadeMs = Annotated[
    float, Option(help="Time for which a switched node is drawn at both levels.")
]
MeasurementDelay = Annotated[
    int, Option(help="Frames after completion until a policy learns a frame's time.")
]
FaultyTimers = Annotated[
    str, Option(help="Faulty timers: missing=SHARE,zero=SHARE,stale=SHARE,saturated_ms=MS.")
]


def compare(
    *,
    scene: options.Scene = "plaza",
    trace: options.Trace = "tour",
    hardware: options.Hardware = "desktop-assumed",
    policy: Policies = None,
    budget_ms: options.BudgetMs = None,
    seed: options.Seed = 0,
    seconds: options.Seconds = "0:",
    out: Out = None,
    as_json: options.AsJson = False,
    wide: Wide = False,
    warmup_s: options.Warmup = 1.0,
    visible_px: options.Visible = 1.0,
    workers: options.Workers = 0,
    scheduler: options.Scheduler = None,
    policy_timeout: options.PolicyTimeout = 60.0,
    policy_memory: options.PolicyMemory = None,
    draws: options.Draws = 16,
    place: options.Place = "shrink",
    display: Display = None,
    refresh_hz: RefreshHz = None,
    frames_in_flight: FramesInFlight = None,
    fovy_deg: options.FovyDeg = 60.0,
    crossfade_ms: CrossfadeMs = 0.0,
    measurement_delay: MeasurementDelay = 0,
    faults: FaultyTimers = "",
) -> None:
    """Compare policies on a camera trace: budget, lag, flicker, quality and work."""
    from ..analysis.report.terminal_table import print_comparison
    from ..analysis.study import compare as study
    from ..analysis.study.comparison_target import claimed_target
    from ..analysis.study.engine.limits import make_limits
    from ..analysis.study.engine.open_engine import prepare_engine
    from ..analysis.study.inputs import adjust_machine, load_trace, parse_seconds
    from ..models.machine.profile_catalog import load_hardware
    from ..policies.registry import default_policies, parse_policy
    from ..sim.faults import parse_faults
    from ..sim.replay import ReplayOptions

    limits = make_limits(policy_timeout, policy_memory)
    with claimed_target(out) as target:
        prepare_engine(scheduler)
        profile = adjust_machine(load_hardware(hardware), display, refresh_hz, frames_in_flight)
        world = open_named_scene(scene).scene
        policies = [parse_policy(text) for text in policy or default_policies()]
        path = load_trace(trace, world, place).stretch(*parse_seconds(seconds))
        replay = ReplayOptions(
            budget_ms=profile.budget_ms(budget_ms),
            seed=seed,
            visible_px=visible_px,
            fovy_deg=fovy_deg,
            crossfade_ms=crossfade_ms,
            measurement_delay=measurement_delay,
            faults=parse_faults(faults),
        )
        scoring = study.CompareOptions(
            warmup_s=warmup_s,
            draws=draws,
            workers=workers,
            policy_limits=limits,
            scheduler=scheduler,
        )
        with progress_bar("replay") as progress:
            comparison, logs = study.compare(
                policies, world, path, profile, replay, scoring, progress=progress, target=target
            )
        unwritten = target and failure_of(lambda: target.write(comparison, logs))
        if as_json:
            print_record(comparison)
        else:
            print_comparison(comparison, table_console(160 if wide else 100), wide=wide)
        if unwritten:  # while the folder is held, whose runs are then kept
            raise unwritten
    if out is not None and not as_json:
        print(f"report: {out / 'report.html'}")
    if comparison.failed:
        raise Exit(1)
