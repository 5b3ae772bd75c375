"""Files that end or hang the process which loads them."""

import subprocess
import sys
from pathlib import Path

import pytest

MINE = "from lodbench.policies.bounds.full import Full as Mine\n"


@pytest.mark.parametrize(
    ("deed", "how"),
    [
        ("import os; os._exit(0)", "ends the process with status 0"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "with status -11"),
        ("import time; time.sleep(3600)", "is not done in time"),
    ],
)
def test_a_file_that_ends_its_process_is_refused(tmp_path: Path, deed: str, how: str) -> None:
    """A command says so in one line and ends with 2, never in silence and with success."""
    file = tmp_path / "mine.py"
    file.write_text(f"{deed}\n{MINE}", encoding="utf-8")
    program = (
        "import lodbench.base.rehearsal as module; module.LONGEST_S = 2.0; "
        "from lodbench.cli.main import main; main()"
    )
    command = [
        sys.executable,
        "-c",
        program,
        "check",
        "--seconds",
        "0:2",
        "--policy",
        f"{file}:Mine",
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith(f"error: {file}: expected a Python file that loads, got one that")
    assert how in done.stderr


def test_what_a_file_prints_and_raises_is_told_once(tmp_path: Path) -> None:
    """The rehearsal is silent, and an error is told when the file is loaded for good."""
    file = tmp_path / "mine.py"
    file.write_text("print('hello')\nraise ValueError('no')\n", encoding="utf-8")
    command = [sys.executable, "-m", "lodbench", "check", "--policy", f"{file}:Mine"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.splitlines() == [
        "hello",
        f"error: {file}: expected a Python file that loads, got ValueError: no",
    ]
