"""`lodbench sweep`: carry out a study of many runs, and ask questions to its results."""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from typer import Argument, Exit, Option, Typer
from typer.core import TyperGroup

from .shared import options
from .shared.progress import progress_bar
from .shared.terminal import print_result
from .sweep_show import show

if TYPE_CHECKING:  # numpy and what needs it are loaded by the command
    from ..analysis.study.study import Study
    from ..analysis.study.sweep.estimate import Estimate
    from ..analysis.study.sweep.study_results import StudyResults

_SCHEMA = "lodbench.sweep/1"
_SAID = 10
"""Reasons for which runs failed that are printed."""


class _RunsByDefault(TyperGroup):
    """A group of which `run` need not be said: ``sweep STUDY.toml`` is ``sweep run STUDY.toml``."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        own = {*self.commands, *ctx.help_option_names}
        return super().parse_args(ctx, args if not args or args[0] in own else ["run", *args])


app = Typer(
    name="sweep",
    cls=_RunsByDefault,
    help="Run a study over any axes, and ask questions to its results.\n\n"
    "`lodbench sweep STUDY.toml` is short for `lodbench sweep run STUDY.toml`.",
    no_args_is_help=True,
    add_completion=False,
)
app.command("show")(show)

StudyFile = Annotated[
    Path, Argument(metavar="STUDY.toml", help="Axes and exclusions, see docs/sweeps.md.")
]
Out = Annotated[
    Path | None,
    Option(
        metavar="DIR",
        help="Folder of the results; else one in this folder called as the study's file.  What it "
        "holds of the study is not run again.",
    ),
]
DryRun = Annotated[
    bool,
    Option("--dry-run", help="Print what it would take, from a timed sample; write nothing."),
]
Overwrite = Annotated[
    bool, Option("--overwrite", help="Replace the results of another study in the folder.")
]
Scheduler = Annotated[
    str | None, Option(metavar="ADDR", help="Run on the workers of this Dask scheduler.")
]


@app.command()
def run(
    study: StudyFile,
    *,
    out: Out = None,
    workers: options.Workers = 0,
    scheduler: Scheduler = None,
    dry_run: DryRun = False,
    overwrite: Overwrite = False,
    policy_timeout: options.PolicyTimeout = 60.0,
    policy_memory: options.PolicyMemory = None,
    as_json: options.AsJson = False,
) -> None:
    """Carry out a study, or what is missing of it: 0 done, 1 a policy failed, 2 bad input."""
    from ..analysis.study.engine.limits import make_limits
    from ..analysis.study.engine.open_engine import prepare_engine
    from ..analysis.study.sweep.carry_out import check_folder
    from ..analysis.study.sweep.study_file import read_study

    limits = make_limits(policy_timeout, policy_memory)
    folder = Path(study.stem) if out is None else out
    if not dry_run:
        check_folder(folder)
    prepare_engine(scheduler)
    planned = read_study(study)
    settings: dict[str, Any] = {"workers": workers, "scheduler": scheduler, "limits": limits}
    if dry_run:
        _print_estimate(planned, settings, as_json=as_json)
        return
    with progress_bar("sweep") as progress:
        results = planned.run(out=folder, overwrite=overwrite, progress=progress, **settings)
    _print_results(planned, folder, results, as_json=as_json)
    if results.counts["failed"]:
        raise Exit(1)


def _print_estimate(study: "Study", settings: dict[str, Any], *, as_json: bool) -> None:
    """Print what a study would take on so many workers."""
    from ..analysis.study.engine.limits import count_processors
    from ..analysis.study.engine.open_engine import open_engine
    from ..analysis.study.sweep.estimate import estimate

    found = estimate(study, open_engine(study.inputs, **settings))
    workers = settings["workers"] or count_processors()
    time_s = found.run_s / min(workers, found.runs)
    record = {
        "schema": _SCHEMA,
        "study": study.name,
        "axes": study.axes,
        "runs": found.runs,
        "sampled": found.sampled,
        "kinds": found.kinds,
        "workers": workers,
        "time_s": time_s,
        "disk_bytes": found.disk_bytes,
    }
    print_result(record, _estimate_text(study, found, workers, time_s), as_json=as_json)


def _estimate_text(study: "Study", found: "Estimate", workers: int, time_s: float) -> str:
    from ..base.quantities import bytes_text, count_text, duration_text

    axes = ", ".join(f"{name} {len(cells):,}" for name, cells in study.axes.items())
    return (
        f"{study.name}: {count_text(found.runs, 'run')} ({axes})\n"
        f"about {duration_text(time_s)} on {count_text(workers, 'worker')} and "
        f"{bytes_text(found.disk_bytes)} of disk, from a timed sample of "
        f"{count_text(found.sampled, 'run')}, one each of {count_text(found.kinds, 'kind')} (a "
        "policy in a scene)"
    )


def _print_results(study: "Study", folder: Path, results: "StudyResults", *, as_json: bool) -> None:
    """Print what became of a study, and why runs have no scores."""
    from ..analysis.study.sweep.query import Query
    from ..base.quantities import count_text

    reasons = Query(results).unscored()
    counts = results.counts
    record = {
        "schema": _SCHEMA,
        "study": study.name,
        "axes": study.axes,
        "runs": len(results),
        "ok": counts["ok"],
        "failed": counts["failed"],
        "not_applicable": counts["not-applicable"],
        "unscored": [asdict(one) for one in reasons],
        "out": str(folder),
    }
    lines = [f"{study.name}: {count_text(len(results), 'run')}, " + ", ".join(_words(counts))]
    lines += [one.text for one in reasons[:_SAID]]
    more = len(reasons) - _SAID
    lines += [f"and {count_text(more, 'more reason')}"] if more > 0 else []
    lines.append(f"results: {folder} (lodbench sweep show {folder})")
    print_result(record, "\n".join(lines), as_json=as_json)


def _words(counts: dict[str, int]) -> list[str]:
    return [f"{count:,} {status.replace('-', ' ')}" for status, count in counts.items() if count]
