"""The command line as a whole: what it says, how it fails, and that it stays quiet about itself."""

import os
import subprocess
import sys
import types
from collections.abc import Callable
from pathlib import Path

import pytest

from lodbench import __version__
from lodbench.base.errors import InputError, PolicyError
from lodbench.cli import main as command_line
from lodbench.cli.main import COMMANDS, load_command, run

CLI = Path(command_line.__file__).parent

Register = Callable[[Exception | type[BaseException]], None]


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch) -> Register:
    """Return a function that registers a command ``fail`` which raises the given exception."""

    def register(error: Exception | type[BaseException]) -> None:
        def fail() -> None:
            raise error

        module = types.ModuleType("lodbench.cli.fail")
        module.__dict__["fail"] = fail
        monkeypatch.setitem(sys.modules, module.__name__, module)
        monkeypatch.setitem(COMMANDS, "fail", "Fail.")

    return register


def test_every_command_file_is_registered() -> None:
    """Each file of ``cli/`` that speaks typer, but the entry point itself, is a command.

    A file named after one and an underscore holds a command below it, as ``scene_hlod`` does.
    """
    files = {
        path.stem for path in CLI.glob("*.py") if "from typer import" in path.read_text("utf-8")
    }
    below = {name for name in files if name.partition("_")[0] in COMMANDS and "_" in name}
    assert set(COMMANDS) == files - below - {"main"}


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_short_help_is_the_commands_own(name: str) -> None:
    """The line shown without loading a command is the first paragraph of its own help."""
    first, _, _ = load_command(name).help.partition("\n\n")
    assert " ".join(first.split()) == COMMANDS[name]


def test_help_lists_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    """``lodbench --help`` names every command with its line, and exits with 0."""
    assert run(["--help"]) == 0
    shown = capsys.readouterr().out
    assert all(name in shown for name in COMMANDS)


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    """``--version`` prints the package's version."""
    assert run(["--version"]) == 0
    assert capsys.readouterr().out == f"lodbench {__version__}\n"


@pytest.mark.parametrize("arguments", [["--nope"], ["lits"], ["list"], ["list", "metrics", "-x"]])
def test_wrong_usage_exits_with_2(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """Unknown options and commands and missing arguments are refused on stderr alone."""
    assert run(arguments) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert "Usage: lodbench" in shown.err


def test_unknown_command_suggests_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    """A misspelt command is answered by the one that was meant."""
    run(["lits"])
    assert "Did you mean 'list'?" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("error", "code", "line"),
    [
        (
            InputError("expected a number, got NaN; give one", path="walk.csv", line=7),
            2,
            "error: walk.csv:7: expected a number, got NaN; give one\n",
        ),
        (
            PolicyError("mine", 12, "returned NaN"),
            1,
            "error: policy mine, frame 12: returned NaN\n",
        ),
        (
            PermissionError(13, "Permission denied", "out/report.html"),
            2,
            (
                "error: out/report.html: expected a path to read or write, got Permission denied; "
                "check the path and its permissions\n"
            ),
        ),
        (KeyboardInterrupt, 130, "interrupted: nothing more is written\n"),
    ],
)
def test_errors_become_one_line(
    failing: Register,
    capsys: pytest.CaptureFixture[str],
    error: Exception | type[BaseException],
    code: int,
    line: str,
) -> None:
    """Bad input exits with 2, a failed policy with 1, Ctrl-C with 130; each says one line."""
    failing(error)
    assert run(["fail"]) == code
    assert capsys.readouterr() == ("", line)


@pytest.mark.parametrize("bug", [ZeroDivisionError("a bug"), OSError("no file in it")])
def test_a_bug_is_not_hidden(failing: Register, bug: Exception) -> None:
    """An exception that no command raises on purpose keeps its traceback."""
    failing(bug)
    with pytest.raises(type(bug)):
        run(["fail"])


def test_real_bad_input_exits_with_2(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """A file that does not exist is refused in one line that names it."""
    absent = tmp_path / "absent.csv"
    assert run(["trace", "info", str(absent)]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.startswith(f"error: {absent}: expected ")
    assert shown.err.count("\n") == 1


def test_a_terminal_without_unicode_gets_the_rest() -> None:
    """What ASCII cannot say becomes a question mark, not a traceback."""
    shown = subprocess.run(
        [sys.executable, "-m", "lodbench", "compare", "--help"],
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
    )
    assert (shown.returncode, shown.stderr) == (0, b"")
    assert b"--budget-ms" in shown.stdout
    assert shown.stdout.isascii()


def test_a_closed_pipe_ends_quietly() -> None:
    """Output into ``head`` that has gone away is no error worth a word."""
    process = subprocess.Popen(
        [sys.executable, "-m", "lodbench", "list", "metrics"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert process.stdout is not None
    assert process.stderr is not None
    with process:
        process.stdout.close()
        assert process.stderr.read() == b""


def test_running_the_package_is_the_command() -> None:
    """``python -m lodbench`` is ``lodbench``."""
    command = [sys.executable, "-m", "lodbench", "--version"]
    shown = subprocess.run(command, capture_output=True, text=True, check=True)
    assert shown.stdout == f"lodbench {__version__}\n"
