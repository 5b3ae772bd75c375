"""`lodbench tune` prints what it found, keeps it, and refuses what it cannot search."""

import json
from pathlib import Path

import pytest

from lodbench.cli.main import run
from lodbench.policies.registry import parse_policy

WASTEFUL = '''
from dataclasses import dataclass
import numpy as np
from lodbench.policies import Capabilities, Selection
from lodbench.policies.knob import Knob

@dataclass
class Wasteful:
    """Draws the nearer part of what is in view in full, and wastes a share of that."""

    part: float = 0.5
    waste: float = 0.9

    capabilities = Capabilities()
    knob = Knob("part", 0.01, 1.0)

    def reset(self, scene, budget_ms):
        self.coarsest = scene.types.levels.level_count - 1

    def select(self, view):
        far = view.distance_m.argsort(kind="stable").argsort(kind="stable")
        full = far < self.part * len(view.ids)
        wasted = (far % 10) < 10 * self.waste
        coarsest = self.coarsest[view.type_index].astype(float)
        return Selection(view.ids, np.where(full & ~wasted, 0.0, coarsest))
'''


@pytest.mark.slow
def test_a_known_best_parameter_is_found_and_kept(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """A policy of one's own that ships with waste is better with less: the record says so."""
    mine, out = tmp_path / "mine.py", tmp_path / "found.json"
    mine.write_text(WASTEFUL, encoding="utf-8")
    command = ["tune", f"{mine}:Wasteful", "--over", "waste=0:0.9", "--trials", "4", "--quick"]
    assert run([*command, "--out", str(out), "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert json.loads(out.read_text(encoding="utf-8")) == record
    assert record["schema"] == "lodbench.tune/1"
    assert record["better"]
    assert record["found"]["params"]["waste"] < 0.5
    assert not set(record["training"]) & set(record["judged"])
    spec = parse_policy(record["policy_line"])
    assert spec.params == record["found"]["params"]
    assert record["provenance"]["command"].startswith(f"lodbench tune {mine}:Wasteful --over")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["feedbak"], "did you mean feedback?"),
        (["feedback", "--over", "gian"], "did you mean gain?"),
        (["feedback", "--over", "target"], "expected parameters beside the knob"),
        (["feedback", "--trials", "0"], "trials: expected a whole number >= 1"),
        (["feedback", "--paths", "1"], "paths: expected 2 or more, got 1"),
        (["feedback", "--scene", "plazza"], "did you mean plaza?"),
        (["feedback", "--out", "no/such/place.json"], "no/such: expected a folder"),
    ],
)
def test_bad_input(
    arguments: list[str],
    message: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Exit code 2, one line, and nothing written."""
    monkeypatch.chdir(tmp_path)
    assert run(["tune", *arguments]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert message in error
    assert len(error.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []
