"""The command ``lodbench``: which commands there are, and what happens to their errors.

A command's module is imported when the command is run, so that ``lodbench --help`` stays quick.
"""

import os
import signal
import sys
from collections.abc import Sequence
from importlib import import_module
from io import TextIOWrapper
from types import FrameType
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command, get_group

from ..base.errors import InputError, LodbenchError
from ..base.version import __version__

COMMANDS = {
    "compare": "Compare policies at one budget: who keeps it, and who looks best then.",
    "sweep": "Run a study over any axes, and ask questions to its results.",
    "tune": "Search parameters of a policy for a finer picture within the budget.",
    "suite": "Rank policies by a fixed study of scenes, paths, machines and budgets.",
    "check": "Judge policies by limits on their metrics: 0 passed, 1 failed, 2 bad input.",
    "report": "Write DIR/report.html again, or figures, tables and a summary of the comparison.",
    "view": "Show what policies draw along the first path, until Ctrl-C, or write it to a file.",
    "export": "Write a run for viewers (PresentMon, CapFrameX, Perfetto), or a policy for an "
    "engine.",
    "fit": "Fit a cost model to measured render logs: a hardware profile.",
    "log": "Look at captures of frame times, and compare them.",
    "record": "Draw a replay with OpenGL, the policy in closed loop, and log what frames hold and "
    "take.",
    "stress": "Search camera paths within speed and turn limits for one on which a policy does "
    "badly.",
    "validate": "Compare simulated with measured: frame times, metrics, verdict, and order of "
    "policies.",
    "reproduce": "Carry out the experiments of papers, and print each beside what the paper "
    "reported.",
    "list": "List policies, scenes, traces, hardware, metrics or formats of files.",
    "scene": "Build scenes from meshes, and look at them.",
    "trace": "Look at camera traces, convert them, and generate them.",
}
"""Name and line of help of every command; each is the file of its name."""


def load_command(name: str) -> Any:
    """Import a command, or the commands below it, and return it as typer runs it.

    Its file has a typer app, or a function of the command's name.
    """
    module = import_module(f".{name}", __package__)
    app = getattr(module, "app", None)
    if app is None:
        app = typer.Typer(add_completion=False)
        app.command(name)(getattr(module, name))
    return get_command(app)


class _LazyGroup(TyperGroup):
    """The group of all commands, which holds only their names and help until one is run."""

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        name, _, rest = super().resolve_command(ctx, args)
        return name, None if name is None else load_command(name), rest

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except LodbenchError as error:
            _print_error(f"error: {error}")
            raise typer.Exit(2 if isinstance(error, InputError) else 1) from error
        except OSError as error:
            if error.filename is None:
                raise
            _print_error(
                f"error: {error.filename}: expected a path to read or write, got "
                f"{error.strerror}; check the path and its permissions"
            )
            raise typer.Exit(2) from error
        except KeyboardInterrupt as error:
            _print_error("interrupted: nothing more is written")
            raise typer.Exit(143 if isinstance(error, _Terminated) else 130) from error


class _Terminated(KeyboardInterrupt):
    """SIGTERM, which ends a command as Ctrl-C does: what it started is ended with it."""


def _terminate(_number: int, _frame: FrameType | None) -> None:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)  # once is enough
    raise _Terminated


def _print_error(line: str) -> None:
    print(line, file=sys.stderr)


def _print_full(error: OSError) -> bool:
    """Tell of a full disk, if that is what happened to an output without a name, as stdout is."""
    from ..base.files.scratch import FULL

    full = error.errno in FULL
    if full:
        reason = f"got {error.strerror}; make room or write elsewhere"
        _print_error(f"error: expected a disk with room for the output, {reason}")
    return full


_app = typer.Typer(
    cls=_LazyGroup,
    add_completion=False,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"lodbench {__version__}")
        raise typer.Exit


@_app.callback()
def lodbench(
    *,
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Compare level-of-detail policies: replay a camera trace, simulate frames, score each."""


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code: 0 done, 1 failed, 2 bad input."""
    group = get_group(_app)
    for name, line in COMMANDS.items():
        group.add_command(TyperCommand(name, help=line))
    try:
        group.main(arguments, prog_name="lodbench")
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 0
    except OSError as error:
        if not _print_full(error):
            raise
        return 2
    return 0


def main() -> None:
    """Run the command line and leave the process; a reader that closed the pipe ends it quietly."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # an ASCII or Latin-1 terminal gets ? for × and ·
            stream.reconfigure(errors="replace")
    signal.signal(signal.SIGTERM, _terminate)
    code = run()
    try:
        sys.stdout.flush()
    except OSError as error:
        # The interpreter flushes once more at exit, and would complain.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if code != 2 and _print_full(error):  # else it has been told
            code = 2
    sys.exit(code)
