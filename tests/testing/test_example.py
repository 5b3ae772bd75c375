"""The example project works as a team would find it: copied, with lodbench from a wheel."""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
import time
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "docs" / "examples" / "my-engine"
GUIDE = ROOT / "docs" / "ci.md"
CHECK = [
    *("lodbench", "check", "--policy", "lod_policy.py:FinestThatFits"),
    *("--scene", "district", "--trace", "trial", "--paths", "4"),
    *("--limits", "limits.toml", "--baseline", "baseline.json"),
]


def run_in(folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    """Run a command with the fresh environment's programs before all others."""
    programs = folder.parent / "venv" / "bin"
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    environment["PATH"] = f"{programs}{os.pathsep}{environment['PATH']}"
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory, tracked_files: list[str]) -> Path:
    """Return a copy of the example beside a fresh environment with the built wheel.

    The dependencies are those of this interpreter, by a .pth file; lodbench itself is only there
    as the wheel.
    """
    base = tmp_path_factory.mktemp("team")
    for name in tracked_files:
        if not name.startswith(("tests/", "docs/")):
            (base / "clone" / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, base / "clone" / name)
    python = sys.executable
    build = [python, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(base / "dist")]
    subprocess.run(build, cwd=base / "clone", capture_output=True, check=True)
    subprocess.run([python, "-m", "venv", "--without-pip", str(base / "venv")], check=True)
    (wheel,) = (base / "dist").glob("*.whl")
    fresh = base / "venv" / "bin" / "python"
    install = [python, "-m", "pip", "--python", str(fresh), "install", "--quiet", "--no-index"]
    subprocess.run([*install, "--no-deps", str(wheel)], check=True)
    (site,) = (base / "venv").glob("lib/python*/site-packages")
    (site / "dependencies.pth").write_text(sysconfig.get_path("purelib"), encoding="utf-8")
    shutil.copytree(EXAMPLE, base / "my-engine")
    return base / "my-engine"


@pytest.mark.slow
def test_the_example_passes_its_own_gate_and_tests(project: Path) -> None:
    """Baseline, check and pytest as in the workflow; pytest within a minute."""
    where = run_in(project, "python", "-c", "import lodbench; print(lodbench.__file__)")
    assert Path(where.stdout.strip()).is_relative_to(project.parent / "venv")
    baseline = run_in(project, *CHECK, "--update-baseline")
    assert baseline.returncode == 0, baseline.stderr
    check = run_in(project, *CHECK, "--github", "--junit", "results/budget.xml", "--strict")
    assert check.returncode == 0, check.stdout + check.stderr
    assert len(ET.parse(project / "results" / "budget.xml").findall(".//testcase")) == 3
    start = time.monotonic()
    tests = run_in(project, "python", "-m", "pytest", "--junit-xml=results/tests.xml")
    assert tests.returncode == 0, tests.stdout + tests.stderr
    assert time.monotonic() - start < 60.0
    assert "20 skipped" in tests.stdout  # the nightly sweep


@pytest.mark.slow
def test_a_worse_policy_fails_the_example(project: Path) -> None:
    """A change that aims at three times the budget fails the check and names what broke."""
    worse = project.parent / "worse"
    shutil.copytree(EXAMPLE, worse)
    assert run_in(worse, *CHECK, "--update-baseline").returncode == 0
    policy = worse / "lod_policy.py"
    text = policy.read_text(encoding="utf-8")
    assert "0.9 * budget_ms" in text
    policy.write_text(text.replace("0.9 * budget_ms", "3.0 * budget_ms"), encoding="utf-8")
    check = run_in(worse, *CHECK, "--json")
    assert check.returncode == 1, check.stdout + check.stderr
    verdicts = json.loads(check.stdout)["verdicts"]
    failed = {(v["metric"], v["population"]) for v in verdicts if v["outcome"] == "fails"}
    assert {("work_ms_p99", "such-paths"), ("work_ms_p99", "this-path")} <= failed
    tests = run_in(worse, "python", "-m", "pytest", "-q")
    assert tests.returncode == 1
    assert "smallest example found (example): 1 object, 1 frame" in tests.stdout


@pytest.mark.parametrize("name", [".github/workflows/lod-budget.yml", ".gitlab-ci.yml"])
def test_the_guide_shows_the_files_of_the_example(name: str) -> None:
    """What is printed in the guide is what the example holds."""
    assert (EXAMPLE / name).read_text(encoding="utf-8") in GUIDE.read_text(encoding="utf-8")


def test_workflows_run_what_is_tested() -> None:
    """The command of both workflows is the one above, written over several lines."""
    for name in (".github/workflows/lod-budget.yml", ".gitlab-ci.yml"):
        words = (EXAMPLE / name).read_text(encoding="utf-8").split()
        start = words.index("lodbench")
        assert words[start : start + len(CHECK)] == CHECK
