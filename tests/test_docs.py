"""The documentation is true: its commands run, its links lead somewhere, its tables are current.

A page is run from top to bottom in an empty folder.  A fence ``python file=NAME`` is written there;
the ``lodbench`` commands of a fence ``sh`` are run there, and have to end with 0, or with N after
``sh exit=N``.  Where a page names ``data/``, that is the folder of real data.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from lodbench.cli.main import COMMANDS

ROOT = Path(__file__).parents[1]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])
TEXT = {page: page.read_text(encoding="utf-8") for page in PAGES}
FENCE = re.compile(r"^```(\w+)(?: (\w+)=(\S+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
OTHER_TOOLS = {"cd", "git", "make", "pip"}


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


def run_page(page: Path, folder: Path) -> None:
    """Write the files and run the commands of a page, in order."""
    environment = os.environ | {
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "COLUMNS": "100",
    }
    for language, key, value, block in FENCE.findall(TEXT[page]):
        if key == "file":
            (folder / value).write_text(block, encoding="utf-8")
        for line in shell_lines(block) if language == "sh" else ():
            if not line.startswith("lodbench "):
                continue
            run = subprocess.run(
                ["bash", "-c", line], cwd=folder, env=environment, capture_output=True, text=True
            )
            expected = int(value) if key == "exit" else 0
            assert run.returncode == expected, f"{line}\n{run.stdout}{run.stderr}"
            assert "Traceback" not in run.stderr


def with_real_data(page: Path) -> bool:
    """Whether a page's commands read the folder of real data."""
    return any("data/" in line for line in commands(page))


@pytest.mark.parametrize("page", [p for p in PAGES if not with_real_data(p)], ids=page_name)
def test_commands_run(page: Path, tmp_path: Path) -> None:
    """Every command of a page does what the page says."""
    run_page(page, tmp_path)


@pytest.mark.realdata
@pytest.mark.parametrize("page", [p for p in PAGES if with_real_data(p)], ids=page_name)
def test_commands_run_on_real_data(page: Path, tmp_path: Path, data_dir: Path) -> None:
    """Every command of a page that works on real data does what the page says."""
    (tmp_path / "data").symlink_to(data_dir.resolve())
    run_page(page, tmp_path)


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
