"""`lodbench suite`: a fixed study of scenes, paths, machines and budgets, and its leaderboard."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Exit, Option

from .shared import options
from .shared.command_line import command_of
from .shared.progress import progress_bar
from .shared.terminal import failure_of, print_record, table_console

if TYPE_CHECKING:  # numpy and what needs it are loaded by the command
    from ..analysis.study.suite.suite_record import SuiteResult

Name = Annotated[str, Argument(help="standard (some ten minutes) or quick (one).")]
Submit = Annotated[
    list[str] | None,
    Option(
        help=f"A policy to be ranked among the suite's: {options.POLICY_HELP}; may be repeated."
    ),
]
Out = Annotated[
    Path | None,
    Option(
        metavar="DIR",
        help="Write report.html, suite.json, and a folder for each comparison.  The same command "
        "goes on where it was stopped.",
    ),
]

_NO_MATTER = ("out", "as_json", "workers", "scheduler", "policy_timeout", "policy_memory", "name")
"""Parameters that do not change the result, and the suite's name, which has no option."""

_RECORD, _REPORT = "suite.json", "report.html"


def suite(
    name: Name = "standard",
    *,
    submit: Submit = None,
    out: Out = None,
    as_json: options.AsJson = False,
    workers: options.Workers = 0,
    scheduler: options.Scheduler = None,
    policy_timeout: options.PolicyTimeout = 60.0,
    policy_memory: options.PolicyMemory = None,
) -> None:
    """Rank policies by a fixed study of scenes, paths, machines and budgets.

    By how many budgets they keep, then by their ranks.  0 done, 1 a policy failed, 2 bad input.
    """
    from ..analysis.report.suite_table import print_suite
    from ..analysis.study.engine.limits import make_limits
    from ..analysis.study.engine.open_engine import prepare_engine
    from ..analysis.study.suite.definition import find_suite
    from ..analysis.study.suite.run_suite import run_suite
    from ..base.files.writable import require_file_writable
    from ..policies.registry import parse_policy

    told = command_of(suite, locals(), _NO_MATTER).replace("suite", f"suite {name}", 1)
    limits = make_limits(policy_timeout, policy_memory)
    chosen = find_suite(name)
    submitted = [parse_policy(text) for text in submit or ()]
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        for file in (_RECORD, _REPORT):
            require_file_writable(out / file)
    prepare_engine(scheduler)
    result = run_suite(
        chosen,
        submitted,
        out=out,
        workers=workers,
        limits=limits,
        scheduler=scheduler,
        command=told,
        watch=lambda cell: progress_bar(cell, f"replays of {cell}"),
    )
    unwritten = out and failure_of(lambda: _write(out, result))
    if as_json:
        print_record(result)
    else:
        print_suite(result, table_console(120))
    if unwritten:
        raise unwritten
    if out is not None and not as_json:
        print(f"report: {out / _REPORT}")
    if any(leader.failed for leader in result.leaderboard):
        raise Exit(1)


def _write(out: Path, result: "SuiteResult") -> None:
    """Write the record and the page beside the comparisons."""
    from ..analysis.report.pages.suite_page import render_suite
    from ..base.files.strict_json import encode_record
    from ..base.files.whole_file import write_whole

    write_whole(out / _RECORD, encode_record(result))
    write_whole(out / _REPORT, render_suite(result))
