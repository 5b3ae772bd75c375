"""`lodbench reproduce`: each paper's experiments, printed beside what it reported."""

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from .shared import options
from .shared.command_line import command_of
from .shared.progress import progress_bar
from .shared.terminal import print_result, table_console

Paper = Annotated[
    str,
    Argument(
        help="lodmanager, zach, peng, hlod, gobbetti, funkhouser, or one experiment such as "
        "gumbau/fig6; all for all of them."
    ),
]
Reduced = Annotated[
    bool, Option("--reduced", help="Fewer frames, seeds and steps, as the tests have it.")
]
Out = Annotated[
    Path | None,
    Option(
        metavar="DIR",
        help="Write report.html, reproduction.md with its pictures, reproduction.json, and the "
        "numbers of each trial.  The same command goes on where it was stopped.",
    ),
]

_NO_MATTER = ("out", "as_json", "workers", "scheduler", "policy_timeout", "policy_memory", "paper")
"""Parameters that do not change the result, and the paper, which has no option."""


def reproduce(
    paper: Paper = "all",
    *,
    reduced: Reduced = False,
    out: Out = None,
    as_json: options.AsJson = False,
    workers: options.Workers = 0,
    scheduler: options.Scheduler = None,
    policy_timeout: options.PolicyTimeout = 600.0,
    policy_memory: options.PolicyMemory = None,
) -> None:
    """Carry out the experiments of papers, and print each beside what the paper reported.

    A claim that does not come out is a result, too: 0 done, 1 an experiment failed, 2 bad input.
    """
    import msgspec

    from ..analysis.report.reproduction_table import print_reproduction
    from ..analysis.reproduce.charts import require_charts
    from ..analysis.reproduce.page import write_page
    from ..analysis.reproduce.registry import find_experiments
    from ..analysis.reproduce.reproduce import reproduce as carry_out
    from ..analysis.reproduce.web_page import render_reproduction
    from ..analysis.study.engine.limits import make_limits
    from ..analysis.study.engine.open_engine import prepare_engine
    from ..base.files.whole_file import write_whole
    from ..base.files.writable import require_file_writable

    told = command_of(reproduce, locals(), _NO_MATTER).replace("reproduce", f"reproduce {paper}", 1)
    limits = make_limits(policy_timeout, policy_memory)
    experiments = find_experiments(paper)
    if out is not None:
        require_charts()
        out.mkdir(parents=True, exist_ok=True)
        for name in ("reproduction.md", "report.html"):
            require_file_writable(out / name)
    prepare_engine(scheduler)
    with progress_bar("reproduce", "trials") as progress:
        result = carry_out(
            experiments,
            reduced=reduced,
            out=out,
            workers=workers,
            limits=limits,
            scheduler=scheduler,
            command=told,
            progress=progress,
        )
    record = result.to_json()
    if out is not None:
        write_page(result, out / "reproduction.md")
        text = msgspec.json.format(msgspec.json.encode(record), indent=1)
        write_whole(out / "reproduction.json", text + b"\n")
        write_whole(out / "report.html", render_reproduction(result))
    if as_json:
        print_result(record, "", as_json=True)
    else:
        print_reproduction(result, table_console(120))
        if out is not None:
            print(f"report: {out / 'report.html'}")
