"""`lodbench check`: the frame-budget gate for continuous integration."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:  # numpy and what needs it are loaded by the command
    from ..analysis.gate.check_result import CheckReport
    from ..analysis.gate.limits import Limits
    from ..analysis.gate.measurements import Conditions, MeasuredPolicy


def check(
    run: Annotated[
        Path | None,
        typer.Argument(
            metavar="[DIR]",
            help="A folder that `compare --out` wrote, to be judged instead of a run of its own.",
        ),
    ] = None,
    *,
    limits: Annotated[
        Path | None,
        typer.Option(
            help="Limits in TOML; else work_ms_p95 within the budget, and, with a "
            "baseline, frame_ms_p99 at most 2.5% up."
        ),
    ] = None,
    policy: Annotated[
        list[str] | None,
        typer.Option(help="NAME, NAME:key=value, or file.py:Class; may be repeated."),
    ] = None,
    scene: Annotated[
        list[str] | None, typer.Option(help="A bundled scene or a file; may be repeated.")
    ] = None,
    trace: Annotated[
        list[str] | None,
        typer.Option(help="`tour`, a kind of movement, or a file; may be repeated."),
    ] = None,
    hardware: Annotated[
        str, typer.Option(help="A bundled profile, or a TOML file.")
    ] = "desktop-assumed",
    baseline: Annotated[Path, typer.Option(help="What relative limits are held against.")] = Path(
        "baseline.json"
    ),
    update_baseline: Annotated[
        bool, typer.Option("--update-baseline", help="Write the baseline instead of judging.")
    ] = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="An undecided limit fails the check.")
    ] = False,
    junit: Annotated[Path | None, typer.Option(metavar="FILE", help="Write JUnit XML.")] = None,
    github: Annotated[
        bool, typer.Option("--github", help="Print annotations for GitHub Actions too.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON document.")] = False,
    budget_ms: Annotated[
        float | None, typer.Option(help="Time a frame may take; else one refresh of the display.")
    ] = None,
    seed: Annotated[int, typer.Option(help="The first seed.")] = 0,
    seeds: Annotated[int, typer.Option(help="Replays of each policy, a seed each.")] = 4,
    frames: Annotated[
        int | None, typer.Option(help="Frames to replay; else as long as the trace lasts.")
    ] = None,
    warmup: Annotated[int, typer.Option(help="Frames at the start that do not count.")] = 30,
    draws: Annotated[
        int, typer.Option(help="Posterior draws of the cost model to replay, if there are any.")
    ] = 16,
    resamples: Annotated[int, typer.Option(help="Bootstrap resamples.")] = 200,
    place: Annotated[
        str, typer.Option(help="How a trace's file is put into a scene: shrink, fit, center, none.")
    ] = "shrink",
    workers: Annotated[
        int, typer.Option(help="Processes; 0 for one a processor.  Results are the same.")
    ] = 0,
) -> None:
    """Hold a policy's frame times and flicker against limits: 0 passed, 1 failed, 2 bad input."""
    from ..analysis.gate.check import CheckPlan, judge_measured, measure_plan
    from ..analysis.gate.limits_file import choose_limits
    from ..analysis.gate.measurements import MeasureOptions, measure_run

    chosen = choose_limits(limits, baseline, updating=update_baseline)
    if run is not None:
        conditions, measured = measure_run(run)
    else:
        plan = CheckPlan(
            policies=tuple(policy or ()),
            scenes=tuple(scene or ("plaza",)),
            traces=tuple(trace or ("tour",)),
            hardware=hardware,
            budget_ms=budget_ms,
            seed=seed,
            frames=frames,
            warmup=warmup,
            place=place,
        )
        sampling = MeasureOptions(seeds=seeds, resamples=resamples, draws=draws, workers=workers)
        conditions, measured = measure_plan(plan, sampling)
    if update_baseline:
        _update(baseline, chosen, conditions, measured, as_json=as_json)
        return
    report = judge_measured(chosen, measured, conditions, baseline, strict=strict)
    if junit is not None:
        from ..analysis.gate.junit import write_junit

        write_junit(junit, report)
    _print(report, limits, as_json=as_json, github=github)
    if not report.passed:
        raise typer.Exit(1)


def _update(
    path: Path,
    limits: "Limits",
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
        raise typer.Exit(1)
    write_baseline(path, make_baseline(conditions, measured, limits))
    if as_json:
        print(json.dumps({"schema": "lodbench.check/1", "baseline": str(path)}))
    else:
        print(f"baseline: {path}")


def _print(report: "CheckReport", limits: Path | None, *, as_json: bool, github: bool) -> None:
    from ..analysis.gate.check_result import encode_report
    from ..analysis.gate.github import annotations
    from ..analysis.gate.plain_text import lines

    if as_json:
        print(encode_report(report).decode(), end="")
    else:
        print("\n".join(lines(report)))
    if github:
        for line in annotations(report, limits):
            # GitHub reads both streams; stdout is kept for the one document.
            print(line, file=sys.stderr if as_json else sys.stdout)
