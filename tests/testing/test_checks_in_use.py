"""The contract checks as a team uses them: as tests, without pytest, and as the page shows."""

import re
import subprocess
import sys
from functools import partial
from pathlib import Path

from lodbench.policies.thresholds.static_screen import StaticScreen
from lodbench.testing import parametrize_with_checks

ROOT = Path(__file__).parents[2]


def test_tests_are_called_after_policy_and_check() -> None:
    """Identifiers name the class, the parameters bound to it, and the check."""
    mark = parametrize_with_checks([StaticScreen, partial(StaticScreen, bias=2.0)]).mark
    assert mark.args[0] == ("policy_factory", "check")
    names = [pair.id for pair in mark.args[1]]
    assert names[0] == "StaticScreen-valid_selections"
    assert names[-1] == "StaticScreen(bias=2.0)-hysteresis_holds"
    assert len(names) == 2 * 15


def test_checks_do_without_pytest_and_hypothesis() -> None:
    """Only tests and drawn examples need them; a policy is checked where neither is installed."""
    script = """
import sys
sys.modules["pytest"] = sys.modules["hypothesis"] = None
from lodbench.policies.bounds.full import Full
from lodbench.testing import check_policy
print(all(result.passed for result in check_policy(Full)))
"""
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "True"


def test_the_documented_test_passes(tmp_path: Path) -> None:
    """The policy and the test of the page about adding one, run as a reader would."""
    page = (ROOT / "docs" / "adding-a-policy.md").read_text(encoding="utf-8")
    files = dict(re.findall(r"^```python file=(\S+)\n(.*?)^```$", page, re.MULTILINE | re.DOTALL))
    for name in ("nearest.py", "test_nearest.py"):
        (tmp_path / name).write_text(files[name], encoding="utf-8")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_nearest.py"]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    assert re.search(r"\d+ passed in", run.stdout)
