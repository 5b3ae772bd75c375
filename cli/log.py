"""`lodbench log`: what a capture of frame times holds, and how two differ."""

import json
from pathlib import Path
from typing import Annotated

from typer import Argument, Option, Typer

from .shared.columns import Mapping, parse_columns
from .shared.options import AsJson
from .shared.terminal import table_console

app = Typer(
    name="log",
    help="Look at captures of frame times, and compare them.",
    no_args_is_help=True,
    add_completion=False,
)

Log = Annotated[
    str, Argument(metavar="LOG", help="PresentMon, CapFrameX, MangoHud, Unreal, CSV, JSON...")
]
First = Annotated[str, Argument(metavar="A", help="A capture.")]
Second = Annotated[str, Argument(metavar="B", help="Another, which is held against it.")]
LogFormat = Annotated[
    str | None, Option("--format", help="Format of the log; else its content decides.")
]
Html = Annotated[Path | None, Option(metavar="FILE.html", help="Write a page with charts.")]
Seed = Annotated[int, Option(min=0, help="Same seed, same intervals.")]


@app.command()
def info(
    log: Log,
    *,
    mapping: Mapping = "",
    log_format: LogFormat = None,
    html: Html = None,
    as_json: AsJson = False,
) -> None:
    """Show what a capture holds: columns and their units, metrics, and what to beware of.

    The metrics are those of compare, by the same definitions.
    """
    from ..analysis.captures.capture_frames import intervals_of
    from ..analysis.captures.capture_info import capture_record
    from ..analysis.captures.capture_table import print_capture
    from ..analysis.fit.log_files import read_log
    from ..base.files.whole_file import write_whole
    from ..base.files.writable import require_file_writable

    if html is not None:
        require_file_writable(html)
    held = read_log(log, parse_columns(mapping) or None, log_format)
    record, intervals = capture_record(held), intervals_of(held)
    if html is not None:
        from ..analysis.captures.capture_page import render_capture

        write_whole(html, render_capture(record, intervals).encode())
    if as_json:
        print(json.dumps(record, ensure_ascii=False))
    else:
        first = next(iter(intervals.values()), None)
        print_capture(record, first, table_console(100))


@app.command()
def compare(
    first: First,
    second: Second,
    *,
    mapping: Mapping = "",
    log_format: LogFormat = None,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Show how captures differ: each metric of B minus that of A, with an interval.

    Intervals are of a block bootstrap over successive frames.
    """
    from ..analysis.captures.capture_compare import compare_captures
    from ..analysis.captures.capture_table import print_difference
    from ..analysis.fit.log_files import read_log

    columns = parse_columns(mapping) or None
    logs = [read_log(name, columns, log_format) for name in (first, second)]
    record = compare_captures(logs[0], logs[1], seed)
    if as_json:
        print(json.dumps(record, ensure_ascii=False))
    else:
        print_difference(record, table_console(110))
