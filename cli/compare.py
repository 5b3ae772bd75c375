"""`lodbench compare`: bring policies to one budget, judge them on the same paths, and say which."""

from pathlib import Path
from typing import Annotated

from typer import Argument, Exit, Option

from ..base.errors import InputError
from .shared import options, printed_files
from .shared.command_line import command_of
from .shared.eyes import make_eyes
from .shared.progress import progress_bar
from .shared.terminal import (
    failure_of,
    open_named_scene,
    print_record,
    table_console,
    tell_field_of_view,
)

Folders = Annotated[
    list[Path] | None,
    Argument(
        metavar="[DIR1 DIR2]",
        help="Two folders that `compare --out` wrote: what changed from the first to the second.",
    ),
]
Policies = Annotated[
    list[str] | None,
    Option(
        help=f"{options.POLICY_HELP}; may be repeated. Without it, every registered policy. One "
        "named bare is tuned to the budget; with parameters it runs as typed."
    ),
]
Out = Annotated[
    Path | None,
    Option(
        metavar="DIR",
        help="Write report.html, comparison.json, runs.parquet, frames/POLICY.parquet, and "
        "moments/POLICY.png of the first policies' worst moments. "
        "Only a folder that compare wrote is replaced. The same command goes on where it was "
        "stopped.",
    ),
]
AsShipped = Annotated[bool, Option("--as-shipped", help="Tune no policy: run each as it ships.")]
Seeds = Annotated[
    int | None, Option(help="Replays of each path under other noise; else 2, or 5 of one path.")
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
Memory = Annotated[float | None, Option(metavar="BYTES", help="Bound of the loader's memory.")]

_NO_MATTER = (
    "folders",
    "out",
    "figures",
    "csv",
    "latex",
    "markdown",
    "baseline",
    "as_json",
    "wide",
    "workers",
    "scheduler",
    "policy_timeout",
    "policy_memory",
)
"""Parameters that do not change the comparison."""


def compare(
    folders: Folders = None,
    *,
    scene: options.Scene = "district",
    trace: options.Traces = None,
    paths: options.Paths = None,
    seconds: options.Seconds = "0:",
    warmup: options.Warmup = 1.0,
    hardware: options.Hardware = "desktop-assumed",
    policy: Policies = None,
    budget_ms: options.BudgetMs = None,
    miss: options.Miss = 0.01,
    visible: options.Visible = 1.0,
    margin: options.Margin = 0.1,
    as_shipped: AsShipped = False,
    quick: options.Quick = False,
    seed: options.Seed = 0,
    seeds: Seeds = None,
    out: Out = None,
    figures: printed_files.Figures = None,
    csv: printed_files.Csv = None,
    latex: printed_files.Latex = None,
    markdown: printed_files.Markdown = False,
    baseline: printed_files.Baseline = None,
    as_json: options.AsJson = False,
    wide: Wide = False,
    workers: options.Workers = 0,
    scheduler: options.Scheduler = None,
    policy_timeout: options.PolicyTimeout = 60.0,
    policy_memory: options.PolicyMemory = None,
    draws: options.Draws = 8,
    place: options.Place = "shrink",
    display: Display = None,
    refresh_hz: RefreshHz = None,
    frames_in_flight: FramesInFlight = None,
    pacing: options.Pacing = None,
    latency_limit: options.LatencyLimit = None,
    fovy_deg: options.FovyDeg = None,
    players: options.Players = 1,
    eyes: options.Eyes = None,
    eye_size: options.EyeSize = None,
    single_pass: options.SinglePass = False,
    crossfade_ms: CrossfadeMs = 0.0,
    measurement_delay: MeasurementDelay = 0,
    faults: FaultyTimers = "",
    memory: Memory = None,
) -> None:
    """Compare policies at one budget: who keeps it, and who looks best then."""
    from ..analysis.report.terminal_table import print_comparison
    from ..analysis.study.compare import (
        DEFAULT_PATHS,
        DEFAULT_TRACE,
        QUICK_LENGTH_S,
        QUICK_PATHS,
        CompareSettings,
        compared_policies,
    )
    from ..analysis.study.compare import compare as compare_policies
    from ..analysis.study.comparison_target import claimed_target
    from ..analysis.study.engine.limits import make_limits
    from ..analysis.study.engine.open_engine import prepare_engine
    from ..analysis.study.field_of_view import field_of_view
    from ..analysis.study.inputs import adjust_machine, parse_seconds
    from ..analysis.study.paths import load_paths
    from ..models.machine.profile_catalog import load_hardware
    from ..policies.registry import parse_policy
    from ..sim.machine.faults import parse_faults
    from ..sim.replay import ReplayOptions

    told = command_of(compare, locals(), _NO_MATTER)
    printed = printed_files.PrintedFiles(figures, csv, latex, markdown, baseline, as_json)
    if folders:
        _print_changes(folders, printed, as_json=as_json)
        return
    printed.check(out)
    before = printed.read_baseline()
    limits = make_limits(policy_timeout, policy_memory)
    with claimed_target(out) as target:
        prepare_engine(scheduler)
        profile = adjust_machine(
            load_hardware(hardware), display, refresh_hz, frames_in_flight, pacing, latency_limit
        )
        opened = open_named_scene(scene)
        world, meshes = opened.scene, None if out is None else opened.read_geometry
        policies = [parse_policy(text) for text in policy or compared_policies()]
        walked = load_paths(
            trace or [DEFAULT_TRACE],
            world,
            place,
            paths=paths if paths is not None else QUICK_PATHS if quick else DEFAULT_PATHS,
            length_s=QUICK_LENGTH_S if quick else None,
            seconds=parse_seconds(seconds),
            seed=seed,
            players=players,
        )
        replay = ReplayOptions(
            budget_ms=profile.budget_ms(budget_ms),
            seed=seed,
            visible_px=visible,
            fovy_deg=field_of_view(walked, fovy_deg),
            crossfade_ms=crossfade_ms,
            measurement_delay=measurement_delay,
            faults=parse_faults(faults),
            memory_bytes=memory,
            eyes=make_eyes(eyes, eye_size, single_pass=single_pass),
        )
        tell_field_of_view(walked, replay.fovy_deg)
        settings = CompareSettings(
            warmup_s=warmup,
            miss=miss,
            margin=margin,
            as_shipped=as_shipped,
            seeds=seeds,
            draws=draws,
            workers=workers,
            policy_limits=limits,
            scheduler=scheduler,
            command=told,
        )
        with progress_bar("replay") as progress:
            compared = compare_policies(
                policies,
                world,
                walked,
                profile,
                replay,
                settings,
                progress=progress,
                target=target,
                meshes=meshes,
            )
        unwritten = target and failure_of(lambda: target.write(compared))
        if as_json:
            print_record(compared.comparison)
        elif markdown:
            print(printed.summary(compared, before), end="")
        else:
            print_comparison(compared.comparison, table_console(160 if wide else 100), wide=wide)
        if unwritten:  # while the folder is held, whose runs are then kept
            raise unwritten
    printed.write(compared)
    if out is not None and not (as_json or markdown):
        print(f"report: {out / 'report.html'}")
    if compared.comparison.failed:
        raise Exit(1)


def _print_changes(
    folders: list[Path], printed: printed_files.PrintedFiles, *, as_json: bool
) -> None:
    """Print what changed from one folder to another."""
    from ..analysis.report.changes_table import print_changes
    from ..analysis.study.comparison_folder import read_results
    from ..analysis.verdict.changes import find_changes

    if len(folders) != 2:
        raise InputError(f"compare: expected two folders or none, got {len(folders)}; name two")
    if printed.baseline is not None:
        raise InputError("--baseline: expected none beside two folders: the first is that")
    for folder in folders:
        printed.check(folder)
    before, after = map(read_results, folders)
    changes = find_changes(before, after)
    printed.write(after)
    if as_json:
        print_record(changes)
    elif printed.markdown:
        print(printed.summary(after, before), end="")
    else:
        print_changes(changes, table_console(100))
