"""The plugin as a team's own tests use it, in a process of its own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

LIMITS = '[limits]\nwork_ms_p99 = { max = 0.5, population = "this-path" }\n'
TESTS = """
import pytest


@pytest.fixture(scope="session")
def frame_budget(frame_budget):
    from dataclasses import replace
    return replace(frame_budget, seconds=(0.0, 2.0), paths=2, seeds=2)


def test_budget(assert_budget):
    assert_budget("full", "district", "walk")


def test_replay(replay):
    log = replay("static-screen", "plaza", "tour", seed=3)
    assert (log.header.trace, log.header.seed) == ("tour 0:2 s", 3)
    assert log.header.policy == "static-screen"


@pytest.mark.lodbench_sweep
def test_sweep():
    assert False
"""


def run_pytest(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run pytest in a project; what is installed registers the plugin."""
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        env=os.environ | {"COLUMNS": "300"},
    )


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Return a project with limits that no policy keeps."""
    (tmp_path / "pytest.ini").write_text(
        "[pytest]\nlodbench_limits = ci/limits.toml\naddopts = --strict-markers\n",
        encoding="utf-8",
    )
    (tmp_path / "ci").mkdir()
    (tmp_path / "ci" / "limits.toml").write_text(LIMITS, encoding="utf-8")
    (tmp_path / "test_mine.py").write_text(TESTS, encoding="utf-8")
    return tmp_path


def test_a_failed_budget_says_what_the_command_says(project: Path) -> None:
    """Line for line the message is that of `lodbench check` on the same limits."""
    run = run_pytest(project, "-k", "test_budget")
    assert run.returncode == 1, run.stdout + run.stderr
    command = [sys.executable, "-m", "lodbench", "check", "--limits", "ci/limits.toml"]
    command += ["--policy", "full", "--trace", "walk", "--paths", "2", "--seconds", "0:2"]
    command += ["--seeds", "2", "--workers", "1"]
    check = subprocess.run(command, cwd=project, capture_output=True, text=True)
    assert check.returncode == 1, check.stderr
    (fails,) = [line for line in check.stdout.splitlines() if line.startswith("FAILS")]
    assert f"AssertionError: {fails}" in run.stdout


@pytest.mark.slow
def test_sweeps_run_when_asked_for(project: Path) -> None:
    """A marked test is skipped with its reason, and runs with the option; the marker is known."""
    run = run_pytest(project, "-k", "sweep or replay", "-rs")
    assert run.returncode == 0, run.stdout + run.stderr
    assert "a slow sweep; run it with --lodbench-sweeps" in run.stdout
    assert run_pytest(project, "-k", "sweep", "--lodbench-sweeps").returncode == 1


@pytest.mark.slow
def test_tests_are_spread_over_processes(project: Path) -> None:
    """With pytest-xdist the same tests pass and fail."""
    run = run_pytest(project, "-n", "2")
    assert "1 failed, 1 passed, 1 skipped" in run.stdout, run.stdout + run.stderr


def test_the_plugin_loads_nothing_until_used(tmp_path: Path) -> None:
    """A project that does not use it imports neither numpy nor hypothesis for it."""
    (tmp_path / "test_other.py").write_text(
        "import sys\n\ndef test_other():\n"
        "    assert 'lodbench.testing.plugin' in sys.modules\n"
        "    assert 'numpy' not in sys.modules\n",
        encoding="utf-8",
    )
    run = run_pytest(tmp_path, "-p", "no:hypothesispytest", "-p", "no:benchmark", "-p", "no:xdist")
    assert run.returncode == 0, run.stdout + run.stderr


def test_missing_tools_are_named() -> None:
    """Without hypothesis the error says what to install; unknown names are ordinary errors."""
    script = """
import sys
sys.modules["hypothesis"] = None
import lodbench.testing
try:
    lodbench.testing.scenes
except ImportError as error:
    print(error)
print(hasattr(lodbench.testing, "scnes"))
"""
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    told, known = run.stdout.splitlines()
    assert told.startswith("lodbench.testing.scenes needs hypothesis, which is not installed; ")
    assert told.endswith("pip install 'lodbench[testing]'")
    assert known == "False"
