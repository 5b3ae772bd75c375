"""How comparisons tune and judge: variations, folds, what is typed, and who breaks on the way."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from lodbench.analysis.study.compare import VARIATIONS, CompareSettings

ONE = CompareSettings(workers=1, draws=0, warmup_s=0.5, seeds=1)
SHORT = CompareSettings(workers=1, draws=0, warmup_s=0.1)

BREAKS = """
import os
from lodbench.policies.knob import Knob
from lodbench.policies.thresholds.static_screen import StaticScreen

class Breaks(StaticScreen):
    knob = Knob("bias", 0.005, 50.0)
    def reset(self, scene, budget_ms):
        super().reset(scene, budget_ms)
        self.frames = 0
    def select(self, view):
        self.frames += 1
        if self.bias > 1.0 and self.frames > 5:
            {}
        return super().select(view)
"""


def test_a_single_path_is_tuned_on_its_variations(world: Any) -> None:
    """No value of the knob is chosen on the path that judges it, and the answer is of that path."""
    settings = replace(SHORT, seeds=2)
    compared = world.compare("static-screen", settings=settings, paths=world.short_paths(1))
    comparison = compared.comparison
    assert comparison.paths == ("path 0",)
    assert comparison.population == "this path"
    assert "variations" in comparison.sampling.tuned_on
    assert "on this path" in comparison.answer[0]
    assert compared.runs is not None
    rows = compared.runs.select(["trace", "judged", "knob", "seed"]).to_pylist()
    knob = comparison.policies[0].knob
    assert knob is not None
    assert knob.tuned
    assert {(row["trace"], row["knob"]) for row in rows if row["judged"]} == {
        ("path 0", knob.value)
    }
    tuned_on = {row["trace"] for row in rows if not row["judged"]}
    assert len(tuned_on) == VARIATIONS
    assert "path 0" not in tuned_on


def test_of_few_paths_each_is_judged_at_a_knob_tuned_on_the_others(world: Any) -> None:
    """Two easy paths and a hard one: the hard one's knob is the finest, for it was never seen.

    The budget of 8 ms binds where the objects are in view for most of the path.
    """
    hard = replace(world.trace.stretch(1.2, 1.7), name="hard")
    away = [
        replace(world.trace.stretch(0.1 * at, 0.5 + 0.1 * at), name=f"away {at}") for at in (0, 1)
    ]
    comparison = world.compare("static-screen", settings=SHORT, paths=[*away, hard]).comparison
    (policy,) = comparison.policies
    assert policy.knob is not None
    *easy, unseen = policy.knob.folds
    assert len(policy.knob.folds) == 3
    assert unseen == 50.0  # the finest of its range: where nothing is in view, all is kept
    assert max(easy) < unseen
    assert comparison.population == "such paths"
    assert policy.keeps_budget is not None
    assert policy.keeps_budget.paths == 3


@pytest.mark.parametrize("as_shipped", [False, True])
def test_what_is_typed_runs_as_typed_and_as_shipped_nobody_is_tuned(
    world: Any, *, as_shipped: bool
) -> None:
    """A policy with parameters is replayed with these alone; so are bare ones if told so."""
    compared = world.compare(
        "static-screen", "static-screen:bias=0.5",
        settings=replace(SHORT, as_shipped=as_shipped), paths=world.short_paths(2),
    )  # fmt: skip
    by_label = {policy.label: policy for policy in compared.comparison.policies}
    bare, typed = by_label["static-screen"], by_label["static-screen:bias=0.5"]
    assert bare.knob is not None
    assert typed.knob is not None
    assert (typed.knob.value, typed.knob.tuned, typed.params) == (0.5, False, {"bias": 0.5})
    assert bare.knob.tuned is not as_shipped
    assert (bare.knob.value == 1.0) is as_shipped
    assert set(compared.comparison.curve) == (set() if as_shipped else {"static-screen"})
    assert compared.runs is not None
    knobs = {
        row["knob"]
        for row in compared.runs.select(["policy", "knob"]).to_pylist()
        if row["policy"] == "static-screen:bias=0.5"
    }
    assert knobs == {None}


def test_the_answer_names_the_first_rank_and_no_other(world: Any) -> None:
    """Whoever shares rank 1 is in the first sentence, who misses in the third, and nobody else."""
    names = ("static-screen:bias=0.02", "static-screen:bias=0.03", "static-screen:bias=0.9")
    names += ("feedback:target=0.8", "feedback:target=0.81", "full")
    comparison = world.compare(*names, settings=replace(ONE, seeds=3)).comparison
    first, _, misses = comparison.answer
    seen: list[int | None] = []
    for policy in comparison.policies:
        if policy.same_as is None:
            seen.append(policy.rank)
            assert (policy.label in first) == (policy.rank == 1), policy
            assert (policy.label in misses) == (policy.rank is None), policy
        else:
            assert policy.label not in first + misses
    assert seen[0] == 1
    assert 2 in seen
    assert seen[-1] is None


@pytest.mark.parametrize("deed", ["os._exit(3)", "raise ValueError('no')"])
def test_a_policy_that_breaks_at_some_knob_fails_alone(
    world: Any, tmp_path: Path, deed: str
) -> None:
    """It ends its process or raises in the middle of its tuning; the others are as without it."""
    mine = tmp_path / "breaks.py"
    mine.write_text(BREAKS.format(deed), encoding="utf-8")
    others, hostile = ("full", "static-screen"), f"{mine}:Breaks"
    settings, paths = replace(SHORT, workers=2), world.short_paths(2)
    alone = world.compare(*others, settings=settings, paths=paths).comparison
    comparison = world.compare(*others, hostile, settings=settings, paths=paths).comparison
    (failed,) = comparison.failed
    assert failed.label == hostile
    assert failed.metrics == {}
    assert (comparison.ok, comparison.curve) == (alone.ok, alone.curve)
    assert (comparison.answer, comparison.p_best) == (alone.answer, alone.p_best)
