"""Who keeps the budget, who ranks where, and that the words never contradict the table."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.analysis.study.comparison_parts import PolicyResult
from lodbench.analysis.study.score import Scored
from lodbench.analysis.verdict.judged import Judged
from lodbench.analysis.verdict.verdict import Terms, Verdict, reach_verdict
from lodbench.policies.bounds.full import Full
from lodbench.policies.policy_spec import PolicySpec

BUDGET_MS = 16.0
PATHS = 10
TERMS = Terms(BUDGET_MS, 0.1, "such paths", tuple(f"trial-{number}" for number in range(PATHS)), 0)

MakeJudged = Callable[..., Judged]


@pytest.fixture
def judged(made_scored: Callable[..., Scored]) -> MakeJudged:
    """Return a builder of a policy's runs: error, pops and work by path, the same in two seeds."""

    def build(
        label: str,
        *,
        error_px: Any = 2.0,
        pops: Any = 5.0,
        mean_ms: Any = 12.0,
        judged_ms: Any = 14.0,
        oracle: bool = False,
        missing: float = 0.0,
    ) -> Judged:
        rows = [np.broadcast_to(of, PATHS) for of in (error_px, pops, mean_ms, judged_ms)]
        runs = tuple(
            tuple(
                made_scored(
                    judged_ms=float(limit),
                    visible_error_px=None if np.isnan(error) else float(error),
                    visible_pops_per_s=float(pop),
                    work_ms_mean=float(mean),
                    missing_objects_mean=missing,
                )
                for _ in range(2)
            )
            for error, pop, mean, limit in zip(*rows, strict=True)
        )
        spec = PolicySpec(label, label, Full, {})
        return Judged(spec, label, oracle, None, runs, (), np.array(rows[3], dtype=np.float64))

    return build


def ranks(verdict: Verdict) -> dict[str, int | None]:
    """Return the ranks by label, in the order of the table."""
    return {policy.label: policy.rank for policy in verdict.policies}


def test_the_gate_comes_before_the_picture(judged: MakeJudged) -> None:
    """The finest picture wins nothing if it takes too long; among those that keep, it does."""
    verdict = reach_verdict(
        [
            judged("fine-late", error_px=0.5, judged_ms=20.0),
            judged("coarse", error_px=6.0),
            judged("fine", error_px=2.0),
        ],
        [],
        {},
        TERMS,
    )
    assert ranks(verdict) == {"fine": 1, "coarse": 2, "fine-late": None}
    assert verdict.answer[0].startswith("Take fine: it keeps 16 ms on such paths (it kept 10 of 10")
    assert "coarse" not in verdict.answer[0]
    assert "fine-late (20 ms)" in verdict.answer[2]


def test_a_path_in_ten_that_is_missed_is_not_surely_kept(judged: MakeJudged) -> None:
    """Nine paths at 14 ms and one at 30 leave less than .9 for the next, whoever's mean is low."""
    times = np.full(PATHS, 14.0)
    times[3] = 30.0
    verdict = reach_verdict([judged("mostly", judged_ms=times)], [], {}, TERMS)
    (policy,) = verdict.policies
    assert policy.rank is None
    keeps = policy.keeps_budget
    assert keeps is not None
    # ln(14/16) = -.134 nine times and .629 once: mean -.0573, sd .241; T = .227 with 9 degrees.
    assert keeps.probability == pytest.approx(0.587, abs=0.002)
    assert (keeps.kept, keeps.paths) == (9, 10)
    assert verdict.least_miss is not None
    assert verdict.least_miss.label == "mostly"
    assert verdict.answer[0] == "No policy surely keeps 16 ms on such paths."


def test_differences_within_the_margin_share_a_rank(judged: MakeJudged) -> None:
    """A fifth of a pixel is not seen; a pixel is; then pops split, then work."""
    verdict = reach_verdict(
        [
            judged("a", error_px=1.0, pops=50.0),
            judged("b", error_px=1.2, pops=5.0),
            judged("c", error_px=1.1, pops=5.0, mean_ms=15.0),
            judged("d", error_px=2.0, pops=0.0),
        ],
        [],
        {},
        TERMS,
    )
    assert ranks(verdict) == {"b": 1, "c": 2, "a": 3, "d": 4}


def test_policies_of_equal_distribution_share_a_rank(judged: MakeJudged) -> None:
    """Two that differ by noise of 5 % on each path are not told apart; the leader is named."""
    rng = np.random.default_rng(5)
    first, second = 2.0 * rng.lognormal(0.0, 0.05, (2, PATHS))
    verdict = reach_verdict(
        [judged("one", error_px=first), judged("two", error_px=second)], [], {}, TERMS
    )
    assert set(ranks(verdict).values()) == {1}
    leaders = {policy.leader for policy in verdict.policies}
    assert len(leaders) == 1
    assert "not shown to be worse" in verdict.answer[0]
    near = verdict.order.p_near_best
    assert min(near.values()) > 0.9


def test_identical_policies_are_one_row(judged: MakeJudged) -> None:
    """They stand beside each other with one rank, and neither counts against the other."""
    verdict = reach_verdict(
        [judged("twin"), judged("other", error_px=8.0), judged("also")], [], {}, TERMS
    )
    assert [policy.label for policy in verdict.policies] == ["also", "twin", "other"]
    assert [policy.same_as for policy in verdict.policies] == [None, "also", None]
    assert verdict.order.p_best == {"also": 1.0, "other": 0.0}
    assert "twin" not in verdict.answer[0]


def test_a_hole_is_a_fault_and_no_saving(judged: MakeJudged) -> None:
    """Who leaves objects out has no error where they were, and ranks behind all who draw them."""
    verdict = reach_verdict(
        [judged("holes", error_px=0.0, pops=0.0, mean_ms=2.0, missing=30.0), judged("whole")],
        [],
        {},
        TERMS,
    )
    assert ranks(verdict) == {"whole": 1, "holes": 2}
    alone = reach_verdict([judged("holes", error_px=0.0, pops=0.0, missing=30.0)], [], {}, TERMS)
    assert "with 30 objects missing" in alone.answer[0]


def test_who_draws_nothing_is_worst_and_nobodys_path_is_lost(judged: MakeJudged) -> None:
    """A policy without any picture has no error of its own: it is behind the coarsest."""
    verdict = reach_verdict(
        [judged("nothing", error_px=np.nan), judged("coarse", error_px=9.0)], [], {}, TERMS
    )
    assert ranks(verdict) == {"coarse": 1, "nothing": 2}


def test_where_nothing_is_in_view_only_work_is_compared(judged: MakeJudged) -> None:
    """A path that looks at the sky has no picture error under any policy, and no traceback."""
    verdict = reach_verdict(
        [judged("dear", error_px=np.nan), judged("cheap", error_px=np.nan, mean_ms=5.0)],
        [],
        {},
        TERMS,
    )
    assert ranks(verdict) == {"cheap": 1, "dear": 2}


def test_an_oracle_has_no_rank(judged: MakeJudged) -> None:
    """It is shown behind all others, and cannot take the first place from them."""
    verdict = reach_verdict(
        [judged("seer", error_px=0.1, oracle=True), judged("mortal")], [], {}, TERMS
    )
    assert ranks(verdict) == {"mortal": 1, "seer": None}
    assert verdict.answer[2] == "Every policy that was scored keeps the budget."


def test_where_nothing_can_be_seen_the_cheaper_wins(judged: MakeJudged) -> None:
    """And the answer says that the budget leaves room."""
    verdict = reach_verdict(
        [
            judged("dear", error_px=0.0, pops=0.0, mean_ms=12.0),
            judged("cheap", error_px=0.0, pops=0.0, mean_ms=7.0),
        ],
        [],
        {},
        TERMS,
    )
    assert ranks(verdict) == {"cheap": 1, "dear": 2}
    assert "the budget leaves room" in verdict.answer[0]


def test_policies_without_scores_come_last(judged: MakeJudged) -> None:
    """What failed or does not apply is in the record with its reason, and in no rank."""
    failed = PolicyResult("x", "x", {}, None, "failed", "frame 3: raised", oracle=False)
    verdict = reach_verdict([judged("good")], [failed], {}, TERMS)
    assert ranks(verdict) == {"good": 1, "x": None}
    nobody = reach_verdict([], [failed], {}, TERMS)
    assert nobody.answer[0] == "No policy was scored."


def test_the_order_of_the_input_decides_nothing(judged: MakeJudged) -> None:
    """The same policies in any order give the same verdict."""
    rng = np.random.default_rng(2)
    items = [judged(f"p{number}", error_px=rng.lognormal(0.5, 0.3, PATHS)) for number in range(6)]
    one, other = (reach_verdict(some, [], {}, TERMS) for some in (items, items[::-1]))
    assert [policy.label for policy in one.policies] == [p.label for p in other.policies]
    assert ranks(one) == ranks(other)
    assert one.answer == other.answer


def test_a_budget_that_asks_nothing_is_warned_of(judged: MakeJudged) -> None:
    """Full detail within the budget, and nobody who keeps it, each with the number."""
    terms = Terms(200.0, 0.1, "such paths", TERMS.paths, 0)
    easy = reach_verdict([judged("a"), judged("b", error_px=5.0)], [], {}, terms)
    (told,) = easy.warnings
    assert told.startswith("full detail of all in view takes 100 ms at most, within the budget of")
    hard = reach_verdict([judged("a", judged_ms=99.0)], [], {}, TERMS)
    (told,) = hard.warnings
    assert told.startswith("no policy surely keeps 16 ms, where full detail takes 100 ms")
