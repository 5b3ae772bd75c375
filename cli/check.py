"""`lodbench check`: the frame-budget gate for continuous integration."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Exit, Option

from .compare import (
    CrossfadeMs,
    Display,
    FaultyTimers,
    FramesInFlight,
    MeasurementDelay,
    Memory,
    RefreshHz,
)
from .shared import options
from .shared.eyes import make_eyes
from .shared.progress import progress_bar
from .shared.terminal import print_record, print_result

if TYPE_CHECKING:  # numpy and what needs it are loaded by the command
    from ..analysis.gate.check_result import CheckReport
    from ..analysis.gate.limits import LimitRules
    from ..analysis.gate.measurements import Conditions, MeasuredPolicy

Run = Annotated[
    Path | None,
    Argument(
        metavar="[DIR]",
        help="A folder that `compare --out` wrote, to be judged instead of a run of its own.",
    ),
]
LimitsFile = Annotated[
    Path | None,
    Option(
        help="Limits in TOML; else work_ms_p99 within the budget on such paths, and, with a "
        "baseline, work_ms_p99 at most 2.5% up on these."
    ),
]
Scenes = Annotated[list[str] | None, Option(help="A bundled scene or a file; may be repeated.")]
Paths = Annotated[int, Option(help="Paths of a kind of movement, each by a seed of its own.")]
Baseline = Annotated[Path, Option(help="What relative limits are compared with.")]
UpdateBaseline = Annotated[
    bool, Option("--update-baseline", help="Write the baseline instead of judging.")
]
AllowNew = Annotated[
    bool, Option("--allow-new", help="What the baseline lacks passes, and is said to be new.")
]
Strict = Annotated[bool, Option("--strict", help="An undecided limit fails the check.")]
JUnit = Annotated[Path | None, Option(metavar="FILE", help="Write JUnit XML.")]
GitHub = Annotated[bool, Option("--github", help="Print annotations for GitHub Actions too.")]
FirstSeed = Annotated[int, Option(help="The first seed.")]
Seeds = Annotated[int, Option(help="Replays of each policy on each path, a seed each.")]


def check(
    run: Run = None,
    *,
    limits: LimitsFile = None,
    policy: options.Policies = None,
    scene: Scenes = None,
    trace: options.Traces = None,
    paths: Paths = 4,
    seconds: options.Seconds = "0:",
    warmup: options.Warmup = 1.0,
    hardware: options.Hardware = "desktop-assumed",
    baseline: Baseline = Path("baseline.json"),
    update_baseline: UpdateBaseline = False,
    allow_new: AllowNew = False,
    strict: Strict = False,
    junit: JUnit = None,
    github: GitHub = False,
    as_json: options.AsJson = False,
    budget_ms: options.BudgetMs = None,
    visible: options.Visible = 1.0,
    seed: FirstSeed = 0,
    seeds: Seeds = 4,
    place: options.Place = "shrink",
    workers: options.Workers = 0,
    scheduler: options.Scheduler = None,
    policy_timeout: options.PolicyTimeout = 60.0,
    policy_memory: options.PolicyMemory = None,
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
    """Judge policies by limits on their metrics: 0 passed, 1 failed, 2 bad input."""
    from ..analysis.gate.check import CheckPlan, judge_measured, measure_plan, require_load
    from ..analysis.gate.limits_file import choose_limits
    from ..analysis.gate.measurements import MeasureOptions
    from ..analysis.study.engine.limits import make_limits
    from ..analysis.study.engine.open_engine import prepare_engine
    from ..analysis.study.field_of_view import USUAL_FOVY_DEG
    from ..analysis.study.inputs import adjust_machine, parse_seconds
    from ..base.files.writable import require_file_writable
    from ..models.machine.profile_catalog import load_hardware
    from ..sim.machine.faults import parse_faults

    chosen = choose_limits(limits, baseline, updating=update_baseline)
    if update_baseline:
        require_file_writable(baseline, make_parents=True)
    elif junit is not None:
        require_file_writable(junit, make_parents=True)
    if run is not None:
        from ..analysis.gate.stored_run import measure_run

        conditions, measured = measure_run(run)
    else:
        plan = CheckPlan(
            policies=tuple(policy or ()),
            scenes=tuple(scene or ("district",)),
            traces=tuple(trace or ("trial",)),
            paths=paths,
            hardware=adjust_machine(
                load_hardware(hardware),
                display,
                refresh_hz,
                frames_in_flight,
                pacing,
                latency_limit,
            ),
            budget_ms=budget_ms,
            seed=seed,
            seconds=parse_seconds(seconds),
            warmup_s=warmup,
            visible_px=visible,
            fovy_deg=fovy_deg,
            crossfade_ms=crossfade_ms,
            measurement_delay=measurement_delay,
            faults=parse_faults(faults),
            memory_bytes=memory,
            eyes=make_eyes(eyes, eye_size, single_pass=single_pass),
            players=players,
            place=place,
        )
        sampling = MeasureOptions(
            seeds=seeds,
            workers=workers,
            policy_limits=make_limits(policy_timeout, policy_memory),
            scheduler=scheduler,
        )
        prepare_engine(scheduler)
        with progress_bar("replay") as progress:
            conditions, measured = measure_plan(plan, sampling, progress)
        if fovy_deg is None and conditions.fovy_deg != USUAL_FOVY_DEG:
            told = f"field of view of {conditions.fovy_deg:.4g} degrees, as the paths state it"
            print(f"note: {told}", file=sys.stderr)
    if update_baseline:
        require_load(measured, conditions.budget_ms)
        _update(baseline, chosen, conditions, measured, as_json=as_json)
        return
    report = judge_measured(
        chosen, measured, conditions, baseline, strict=strict, allow_new=allow_new
    )
    _print(report, limits, as_json=as_json, github=github)
    if junit is not None:
        from ..analysis.gate.junit import write_junit

        write_junit(junit, report)
    if not report.passed:
        raise Exit(1)


def _update(
    path: Path,
    limits: "LimitRules",
    conditions: "Conditions",
    measured: "list[MeasuredPolicy]",
    *,
    as_json: bool,
) -> None:
    """Write the baseline; a policy that failed has no place in one."""
    from ..analysis.gate.baseline import make_baseline, write_baseline

    broken = [item for item in measured if item.failed]
    if broken:
        print(f"FAILS: {broken[0].policy}: {broken[0].reason}", file=sys.stderr)
        raise Exit(1)
    write_baseline(path, make_baseline(conditions, measured, limits))
    record = {"schema": "lodbench.check/2", "baseline": str(path)}
    print_result(record, f"baseline: {path}", as_json=as_json)


def _print(report: "CheckReport", limits: Path | None, *, as_json: bool, github: bool) -> None:
    from ..analysis.gate.github import annotations
    from ..analysis.gate.plain_text import lines

    if as_json:
        print_record(report)
    else:
        print("\n".join(lines(report)))
    if github:
        for line in annotations(report, limits):
            # GitHub reads both streams; stdout is kept for the one document.
            print(line, file=sys.stderr if as_json else sys.stdout)
