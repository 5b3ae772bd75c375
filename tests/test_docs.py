"""The documentation is true: its commands run, its links lead somewhere, its tables are current.

A page is run from top to bottom in an empty folder.  A fence ``python file=NAME`` is written there;
the ``lodbench`` commands of a fence ``sh`` are run there, and have to end with 0, or with N after
``sh exit=N``.  Where a page names ``data/``, that is the folder of real data.  Commands run in this
process, which has imported what they need.  One page is run by the installed command, as it stands.
"""

import os
import re
import shlex
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from lodbench.cli.main import COMMANDS, run

ROOT = Path(__file__).parents[1]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])
TEXT = {page: page.read_text(encoding="utf-8") for page in PAGES}
FENCE = re.compile(r"^```(\w+)(?: (\w+)=(\S+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
OTHER_TOOLS = {"cd", "dask", "git", "make", "pip", "python"}
ON_A_CLUSTER = ROOT / "docs" / "clusters.md"
STUDIO = ROOT / "docs" / "studio.md"
"""Its files are a studio's; ``tests/docs/test_studio_page.py`` makes such ones, and runs it."""
CAMERAS = ROOT / "docs" / "several-cameras.md"
"""It is run by ``tests/docs/test_several_cameras_page.py``, with what its table claims."""
README = ROOT / "README.md"
"""It is run by ``tests/docs/test_readme.py``, with what it shows and claims."""


def page_name(page: Path) -> str:
    """``docs/traces.md`` for the identifiers of parametrised tests."""
    return page.relative_to(ROOT).as_posix()


def shell_lines(block: str) -> list[str]:
    """Return the commands of a block, continued lines joined and comments left out."""
    lines = block.replace("\\\n", " ").splitlines()
    return [line.strip() for line in lines if line.strip() and not line.startswith("#")]


def commands(page: Path) -> list[str]:
    """Return all lines of a page's shell blocks."""
    blocks = [block for language, _, _, block in FENCE.findall(TEXT[page]) if language == "sh"]
    return [line for block in blocks for line in shell_lines(block)]


def run_page(page: Path, run: Callable[[str], tuple[int, str]]) -> None:
    """Write the files of a page to the current folder and run its commands, in order."""
    for language, key, value, block in FENCE.findall(TEXT[page]):
        if key == "file":
            Path(value).write_text(block, encoding="utf-8")
        for line in shell_lines(block) if language == "sh" else ():
            if line.startswith("lodbench "):
                if "record --calibrate" in line:
                    # Tests run beside others, whom the wall clock would count; fits refuse that.
                    line += " --clock thread"  # noqa: PLW2901 - the same line, told more
                code, output = run(line)
                assert code == (int(value) if key == "exit" else 0), f"{line}\n{output}"
                assert "Traceback" not in output


@pytest.fixture
def command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> Callable[[str], tuple[int, str]]:
    """Return what runs a command line in an empty folder: its exit code and all that it printed."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")

    def run_line(line: str) -> tuple[int, str]:
        _, *arguments = shlex.split(line)
        code = run(arguments)
        return code, "".join(capfd.readouterr())

    return run_line


def run_installed(line: str) -> tuple[int, str]:
    """Run a command line in a shell that finds the installed command."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    ended = subprocess.run(
        ["bash", "-c", line], env=os.environ | {"PATH": path}, capture_output=True, text=True
    )
    return ended.returncode, ended.stdout + ended.stderr


RUNNING = [
    page
    for page in PAGES
    if page not in {ON_A_CLUSTER, STUDIO, CAMERAS, README}
    and any(line.startswith("lodbench ") for line in commands(page))
]
ON_REAL_DATA = [page for page in RUNNING if any("data/" in line for line in commands(page))]
LONG = {
    "ci.md",
    "figures.md",
    "fitting.md",
    "hardware.md",
    "lod-models.md",
    "logs.md",
    "recording.md",
    "reproducing.md",
    "scenes.md",
    "suite.md",
    "sweeps.md",
    "tuning.md",
    "viewer.md",
}
"""Pages that draw, fit or simplify for some ten seconds; quick tests run each command briefly."""


def params(pages: list[Path]) -> list[Any]:
    """Return pages as parameters of a test, the long ones marked slow."""
    slow = pytest.mark.slow
    return [pytest.param(p, marks=[slow] if p.name in LONG else [], id=page_name(p)) for p in pages]


@pytest.mark.parametrize("page", params([p for p in RUNNING if p not in ON_REAL_DATA]))
def test_commands_run(page: Path, command: Callable[[str], tuple[int, str]]) -> None:
    """Every command of a page does what the page says."""
    run_page(page, command)


@pytest.mark.realdata
@pytest.mark.parametrize("page", params(ON_REAL_DATA))
def test_commands_run_on_real_data(
    page: Path, command: Callable[[str], tuple[int, str]], data_dir: Path
) -> None:
    """Every command of a page that works on real data does what the page says."""
    Path("data").symlink_to(data_dir.resolve())
    run_page(page, command)


@pytest.mark.slow
def test_commands_run_on_a_cluster(command: Callable[[str], tuple[int, str]]) -> None:
    """What a page starts in the background is there for the commands below it."""
    lines = [line.removesuffix("&") for line in commands(ON_A_CLUSTER) if line.endswith("&")]
    assert [line.split()[:2] for line in lines] == [["dask", "scheduler"], ["dask", "worker"]]
    with ExitStack() as stack:
        for line in lines:
            _, kind, *arguments = shlex.split(line)
            started = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *arguments]
            process = stack.enter_context(subprocess.Popen(started, stderr=subprocess.DEVNULL))
            stack.callback(process.terminate)
        until = time.monotonic() + 60.0
        while not Path("scheduler.json").exists():
            assert time.monotonic() < until
            time.sleep(0.1)
        run_page(ON_A_CLUSTER, command)


def test_the_installed_command_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A page works by the command that a shell finds, as it does inside of one process."""
    monkeypatch.chdir(tmp_path)
    run_page(ROOT / "docs" / "export.md", run_installed)


@pytest.mark.parametrize("page", PAGES, ids=page_name)
def test_shell_blocks_hold_only_what_is_tested(page: Path) -> None:
    """A line that is no ``lodbench`` command is a well-known tool, and a make target exists."""
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for line in commands(page):
        tool, *arguments = line.split()
        assert tool in {"lodbench", *OTHER_TOOLS}, line
        if tool == "make":
            assert re.search(rf"^{arguments[0]}:", makefile, re.MULTILINE), line


def test_every_command_is_shown() -> None:
    """No command is left out of the documentation."""
    lines = [line.split() for page in PAGES for line in commands(page)]
    assert set(COMMANDS) <= {words[1] for words in lines if words[0] == "lodbench"}


def anchors(text: str) -> set[str]:
    """Return the anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading).lower().replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=page_name)
def test_links_lead_somewhere(page: Path) -> None:
    """Every link inside the repository names a file that is there, and a heading in it."""
    for link in re.findall(r"\]\((?!https?:)([^)\s]+)\)", TEXT[page]):
        name, _, anchor = link.partition("#")
        target = (page.parent / name).resolve() if name else page
        assert target.exists(), link
        if anchor:
            assert anchor in anchors(target.read_text(encoding="utf-8")), link


def test_every_page_is_reached() -> None:
    """The index of the documentation links every page."""
    index = ROOT / "docs" / "index.md"
    pages = {page.name for page in PAGES if page.parent == index.parent and page != index}
    assert {name for name in pages if f"]({name})" not in TEXT[index]} == set()


def test_generated_tables_are_current() -> None:
    """Tables made from the code are as ``make docs`` would write them."""
    run = subprocess.run(
        [sys.executable, "docs/scripts/build_tables.py", "--check"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stdout + run.stderr
