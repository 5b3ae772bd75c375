"""The worked example of the page on the verdict: its numbers follow from its tables.

Each is worked out here by the formula that the page states, from scipy's distributions, and asked
of the functions that commands use: the page, the formula and the code have to agree.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from lodbench.analysis.verdict.answer import ORDER
from lodbench.analysis.verdict.chances import order_chances, tuning_spread
from lodbench.analysis.verdict.criterion import (
    LAG_MARGIN_MS,
    PICTURE_MARGIN_PX,
    RELATIVE_MARGIN,
    Criterion,
)
from lodbench.analysis.verdict.intervals import such_paths, this_path
from lodbench.analysis.verdict.keeping import exact_bound, p_keeps
from lodbench.analysis.verdict.operating_point import SURE, operating_point
from lodbench.analysis.verdict.ranking import ALPHA, ranking
from lodbench.analysis.verdict.verdict import POPS_MARGIN_PER_S
from lodbench.base.arrays import FloatArray

PAGE = (Path(__file__).parents[2] / "docs" / "verdict.md").read_text(encoding="utf-8")
EXAMPLE = PAGE.partition("## A worked example")[2].partition("\n## ")[0]
BUDGET_MS = 16.0


def table(head: str) -> list[list[str]]:
    """Return the cells of the example's table whose head begins with these cells."""
    found = re.search(rf"^\| {re.escape(head)}.*\n\| ---.*\n((?:\|.*\n)+)", EXAMPLE, re.MULTILINE)
    assert found, head
    return [[cell.strip() for cell in row.strip("|").split(" | ")] for row in found[1].splitlines()]


def numbers(rows: list[list[str]], start: int) -> FloatArray:
    """Return the five paths of each row, from the column `start` on."""
    return np.array([[float(cell) for cell in row[start : start + 5]] for row in rows])


WORK_MS = numbers(table("A at"), 1)
TOLERANCE = np.array([float(row[0].split()[-1]) for row in table("A at")])
SEEDS = numbers(table("A | path 1"), 1)
SEEN = numbers(table("metric | policy"), 2).reshape(4, 3, 5)
"""Visible error, visible pops, lag and work of A, B and C on the paths."""
CRITERIA = tuple(  # but for objects that are left out: all three draw all
    Criterion(name, values, absolute=least)
    for name, values, least in zip(
        ORDER[1:], SEEN, (PICTURE_MARGIN_PX, POPS_MARGIN_PER_S, LAG_MARGIN_MS, 0.0), strict=True
    )
)


def below(t: float) -> float:
    """Return the probability that Student's t of five paths is below a value."""
    return float(np.asarray(stats.t.cdf(t, 4), dtype=np.float64))


def test_the_gate_of_the_example() -> None:
    """P(keeps) is that of Student's t as the page says, at each tolerance, beside exact bounds."""
    for row, work_ms in zip(table("tolerance |"), WORK_MS, strict=True):
        x = np.log(work_ms / BUDGET_MS)
        t = -x.mean() / (x.std(ddof=1) * np.sqrt(1 + 1 / 5))
        keeps = below(t)
        kept = int((work_ms <= BUDGET_MS).sum())
        exact = stats.binomtest(kept, 5).proportion_ci(0.9, method="exact")
        assert row[1:] == [
            f"{x.mean():.3f}",
            f"{x.std(ddof=1):.4f}",
            f"{t:.2f}",
            f"{keeps:.3f}",
            f"{kept} of 5",
            f"{exact.low:.2f} to {exact.high:.2f}",
        ]
        assert p_keeps(work_ms, BUDGET_MS) == pytest.approx(keeps)
        assert exact_bound(kept, 5) == pytest.approx((exact.low, exact.high))


def test_the_operating_point_of_the_example() -> None:
    """2.8 px is the finest tolerance that surely keeps the budget: 2 px does not."""
    point = operating_point(TOLERANCE, WORK_MS, BUDGET_MS)
    assert point.value == 2.8
    assert "2.8 is the finest that passes" in EXAMPLE
    assert f"P(keeps) of {SURE:g} or more" in PAGE


def test_the_intervals_of_the_example() -> None:
    """Both intervals are what the page's formulas give, and far from each other in width."""
    (of_this, of_such) = table("interval |")
    variance, means = SEEDS.var(axis=0, ddof=1), SEEDS.mean(axis=0)
    errors = variance / 2
    degrees = errors.sum() ** 2 / (errors**2 / (1 + 2)).sum() - 2
    half = stats.t.ppf(0.95, degrees) * np.sqrt(errors.sum()) / 5
    v = means.std(ddof=1) / means.mean()
    factor = np.exp(stats.t.ppf(0.95, 4) * np.sqrt((v**2 + v**4 / 2) / 5))
    mean = means.mean()
    assert of_this[1:] == [f"{mean - half:.2f}", f"{mean + half:.2f}"]
    assert of_such[1:] == [f"{mean / factor:.2f}", f"{mean * factor:.2f}"]
    assert f"gives {degrees:.1f} degrees of freedom" in EXAMPLE
    assert f"to 1.41 · {factor:.2f}" in EXAMPLE
    this, such = this_path(SEEDS.T), such_paths(means, "positive")
    assert such is not None
    assert (this.low, this.high) == pytest.approx((mean - half, mean + half))
    assert (such.low, such.high) == pytest.approx((mean / factor, mean * factor))
    assert means.tolist() == pytest.approx(SEEN[0, 0].tolist())


def test_the_ranks_of_the_example() -> None:
    """C, A, B: by pops within the margin of the error, and by an error beyond it."""
    assert [row[-1] for row in table("metric | policy")] == [
        f"{values.mean():.2f}" for metric in SEEN for values in metric
    ]
    groups = ranking(["A", "B", "C"], CRITERIA)
    assert table("rank | policy") == [
        [str(group.rank), *group.members, group.behind_by or ""] for group in groups
    ]
    error, pops, _, _ = SEEN
    beyond = error[1] - error[0] - PICTURE_MARGIN_PX
    of_mean = error[1] - error[0] - RELATIVE_MARGIN * error[0]
    p_error = max(stats.ttest_1samp(d, 0, alternative="greater").pvalue for d in (beyond, of_mean))
    p_pops = stats.ttest_1samp(pops[0] - pops[2] - 1.0, 0, alternative="greater").pvalue
    assert f"{beyond.mean():.2f} beyond the margin" in EXAMPLE
    assert f"p = {p_error:.4f}. B falls behind" in EXAMPLE
    assert f"p = {p_pops:.3f}. A falls" in EXAMPLE
    assert p_error < ALPHA
    assert p_pops < ALPHA
    assert (error[2] - error[0]).mean() < PICTURE_MARGIN_PX


def test_the_chances_of_the_example() -> None:
    """The table is what the functions draw, and C's lead what Student's t makes of it."""
    found = order_chances(CRITERIA, spread=tuning_spread(5))
    columns = (found.p_best, found.p_within_margin, found.regret)
    assert table("policy | P(best)") == [
        [label, *(f"{column[at]:.2f}" for column in columns)] for at, label in enumerate("ABC")
    ]
    # C is first unless its pops come within 1 a second of A's: that takes t of 4 degrees beyond 5.
    lead = SEEN[1, 0] - SEEN[1, 2] - 1.0
    t = lead.mean() / (1.5 * lead.std(ddof=1) / np.sqrt(5))
    assert found.p_best[2] == pytest.approx(below(t), abs=0.01)


def test_half_the_speed_of_the_example() -> None:
    """At half the speed even the coarsest tolerance misses, as surely as the page says."""
    keeps = p_keeps(WORK_MS[0], BUDGET_MS / 2)
    assert f"P(keeps) of 8 ms is {keeps:.2f}" in EXAMPLE
    assert keeps < SURE
