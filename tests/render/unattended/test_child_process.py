"""Commands that run for so long and no longer."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from lodbench.render.unattended.child_process import ChildError, run_child


def run(code: str, limit_s: float = 60.0) -> str:
    """Run Python code as a child."""
    command = [sys.executable, "-c", code]
    return run_child(command, limit_s=limit_s, more={"MORE": "1"})


def test_what_is_printed_is_returned() -> None:
    """The environment has what is added, and there is nobody to ask."""
    code = "import os, sys; print(os.environ['MORE'], repr(sys.stdin.read()))"
    assert run(code) == "1 ''\n"


def test_a_failure_is_told_by_its_last_line() -> None:
    """An error of ours is one line; a crash without a word is told by its status."""
    with pytest.raises(ChildError, match=r"^error: no driver$"):
        run("import sys; sys.exit('a warning\\nerror: no driver')")
    with pytest.raises(ChildError, match=r"^exit -11$"):
        run("import os; os.kill(os.getpid(), 11)")


def test_what_hangs_is_stopped_with_all_that_it_started(tmp_path: Path) -> None:
    """A grandchild that ignores the end of its parent does not live on."""
    note = tmp_path / "pid"
    code = (
        "import os, time; child = os.fork()\n"
        f"if not child: open({str(note)!r}, 'w').write(str(os.getpid()))\n"
        "time.sleep(600)"
    )
    begin = time.monotonic()
    with pytest.raises(ChildError, match="stopped after 4 s"):
        run(code, limit_s=4.0)
    assert time.monotonic() - begin < 30.0
    grandchild = int(note.read_text())
    state = subprocess.run(
        ["ps", "-o", "stat=", "-p", str(grandchild)], capture_output=True, text=True
    ).stdout.strip()
    assert state[:1] in {"", "Z"}  # its priority may stand behind
    assert grandchild != os.getpid()
