"""Ctrl-C and SIGTERM in the middle of a comparison: what is done is kept, and it goes on."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

POLICIES = ("full", "static-screen", "feedback", "lodmanager", "hoppe", "gobbetti")
RUNS = 2 * len(POLICIES)  # each once for its scores and once for its frame log
ARGUMENTS = [
    *("compare", "--scene", "plaza", "--trace", "tour", "--seconds", "0:7", "--workers", "1"),
    *("--as-shipped", "--seeds", "1"),
]
# What is started in the background of a script does not hear Ctrl-C.
COMMAND = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)
from lodbench.cli.main import main
main()
"""


def start(out: Path) -> subprocess.Popen[str]:
    """Start the command as a user does."""
    policies = [word for name in POLICIES for word in ("--policy", name)]
    return subprocess.Popen(
        [sys.executable, "-c", COMMAND, *ARGUMENTS, *policies, "--out", str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "COLUMNS": "100"},
    )


def wait_for_results(work: Path) -> None:
    """Return once some results are durable."""
    until = time.monotonic() + 120.0
    while not list(work.glob("parts/early-*.parquet")):
        assert time.monotonic() < until, "no result came"
        time.sleep(0.01)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="has no such signals")
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_keeps_what_is_done(tmp_path: Path, number: int, code: int) -> None:
    """The runs that are done are kept, which stderr says, and the same command does the others."""
    out = tmp_path / "out" / "run"
    first = start(out)
    wait_for_results(out.with_name(".lodbench-run.unfinished"))
    first.send_signal(number)
    printed, told = first.communicate(timeout=60.0)
    assert (first.returncode, printed) == (code, "")
    (line,) = [line for line in told.splitlines() if " kept" in line]
    assert re.fullmatch(r"(1 run is|\d+ runs are) kept; run the same command again to go on", line)
    second = start(out)
    printed, told = second.communicate(timeout=300.0)
    assert (second.returncode, told.count("kept")) == (0, 0)
    assert "gobbetti" in printed
    info = json.loads((out / "run-info.json").read_text(encoding="utf-8"))
    assert sum(policy["runs"] for policy in info["policies"].values()) == RUNS
    assert [path.name for path in out.parent.iterdir()] == ["run"]
