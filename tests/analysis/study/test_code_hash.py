"""What a policy is known by: all of the user's code that it is made of."""

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from lodbench.analysis.study.code_hash import code_hash, package_hash, policy_hash
from lodbench.policies.bounds.full import Full
from lodbench.policies.registry import parse_policy, specs_of

MINE = """
import numpy as np
from lodbench.policies import Capabilities, Selection
from mine_helpers.level import level

class Mine:
    capabilities = Capabilities()
    def reset(self, scene, budget_ms): pass
    def select(self, view): return Selection(view.ids, np.full(len(view), level()))
"""
LEVEL = "import mine_numbers\ndef level(): return mine_numbers.LEVEL\n"


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Return a folder on Python's path with a policy, what it uses, and what that uses."""
    (tmp_path / "mine_helpers").mkdir()
    (tmp_path / "mine.py").write_text(MINE)
    (tmp_path / "mine_helpers" / "level.py").write_text(LEVEL)
    (tmp_path / "mine_numbers.py").write_text("LEVEL = 0.0\n")
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    forget()


def forget() -> None:
    """Let the next process, so to say, load the user's modules anew."""
    for name in [name for name in sys.modules if name.startswith(("mine", "lodbench_user_"))]:
        del sys.modules[name]
    importlib.invalidate_caches()


def known_by(folder: Path) -> str:
    """Return the hash of the policy as a new process would."""
    forget()
    return policy_hash(parse_policy(f"{folder}/mine.py:Mine"))


def test_a_change_anywhere_in_the_users_code_changes_the_hash(mine: Path) -> None:
    """In the policy's file, in a module that it uses, and in one that this uses; else nothing."""
    before = known_by(mine)
    assert known_by(mine) == before
    found = {before}
    for place in ("mine_numbers.py", "mine_helpers/level.py", "mine.py"):
        with (mine / place).open("a") as file:
            file.write("# changed\n")
        found.add(known_by(mine))
    assert len(found) == 4


def test_objects_are_known_by_what_they_hold() -> None:
    """Two of one class differ by their parameters, and equal ones are equal."""
    hashes = {
        policy_hash(spec)
        for given in (Full(), Full())
        for spec in specs_of({"mine": given, "other": given})
    }
    assert len(hashes) == 2  # by label


def test_the_package_is_more_than_what_runs_depend_on() -> None:
    """Pages and verdicts have a hash of their own, which the runs' does not change with."""
    assert code_hash() != package_hash()
