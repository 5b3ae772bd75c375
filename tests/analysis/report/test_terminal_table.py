"""The tables of the terminal."""

import io
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.report.summary import HEADLINE, describe_run, keeps_text
from lodbench.analysis.report.terminal_table import print_comparison
from lodbench.analysis.report.values import format_value
from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.comparison import Comparison
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.camera_trace import CameraTrace


@pytest.fixture(scope="module")
def comparison(
    small_scene: Scene, turn_trace: CameraTrace, fitted_machine: HardwareProfile, bad_policies: Path
) -> Comparison:
    """Return a comparison with a winner, an oracle, a failure and a policy that does not fit."""
    texts = ["full", "static-screen:first=0.5,hysteresis=0.02,bias=1.5"]
    texts += [f"{bad_policies}:{name}" for name in ("Raises", "OnlyTrees", "Seer")]
    settings = CompareSettings(workers=1, warmup_s=0.5, draws=2, seeds=3)
    replay = ReplayOptions(budget_ms=8.0)
    policies = [parse_policy(text) for text in texts]
    return compare(policies, small_scene, [turn_trace], fitted_machine, replay, settings).comparison


def printed(comparison: Comparison, width: int, *, wide: bool = False) -> str:
    """Return the table as a pipe would get it."""
    file = io.StringIO()
    console = Console(file=file, width=width, highlight=False)
    print_comparison(comparison, console, wide=wide)
    return file.getvalue()


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "–"),
        (0.0, "0"),
        (12345.6, "12,346"),
        (99.96, "100"),
        (16.667, "16.7"),
        (9.996, "10.0"),
        (1.0, "1.00"),
        (0.0123, "0.012"),
        (0.0004, "4e-4"),
        (-2.5, "-2.50"),
    ],
)
def test_numbers_have_three_digits(value: float | None, text: str) -> None:
    """Large numbers have separators, small ones an exponent, absent ones a dash."""
    assert format_value(value) == text


def test_short_table_fits_in_100_columns(comparison: Comparison) -> None:
    """No line of the table is cut or wider than 100; only reasons run on."""
    text = printed(comparison, 100)
    lines = [line for line in text.splitlines() if not line.startswith(("failed", "not-appl"))]
    assert max(map(len, lines)) <= 100
    assert "…" not in text


@pytest.mark.parametrize(
    ("probability", "text"),
    [(0.8999, "0.89 3/4"), (0.9, "0.90 3/4"), (0.895, "0.89 3/4"), (0.9951, "1.00 3/4")],
)
def test_who_misses_is_not_printed_as_sure(
    comparison: Comparison, probability: float, text: str
) -> None:
    """From .9 on a policy keeps the budget: what is short of it is not rounded to it."""
    first = comparison.ok[0]
    assert first.keeps_budget is not None
    keeps = replace(first.keeps_budget, probability=probability, kept=3, paths=4)
    assert keeps_text(replace(first, keeps_budget=keeps)) == text


def test_what_puts_a_policy_behind_is_told(comparison: Comparison) -> None:
    """The metric of the verdict stands in its row in a word."""
    first = replace(comparison.ok[0], rank=2, behind_by="visible_pops_per_s")
    text = printed(replace(comparison, policies=(first,)), 100)
    row = next(line for line in text.splitlines() if line.startswith("2 "))
    assert " pops " in row


@pytest.mark.parametrize("width", [40, 80])
def test_narrow_terminal_gets_several_short_tables(comparison: Comparison, width: int) -> None:
    """Columns that do not fit stand below the others, none is cut, and every row has its name."""
    text = printed(comparison, width)
    tables = text.count("rank ")
    rows = [line for line in text.splitlines() if " full " in line and "misses" in line]
    assert tables > 1
    assert len(rows) == tables
    assert "…" not in text
    assert max(map(len, rows)) <= width


def test_policies_of_one_reason_share_a_line(comparison: Comparison) -> None:
    """Policies that do not fit the scene are named once, before what they have in common."""
    (unfit,) = (policy for policy in comparison.policies if policy.status == "not-applicable")
    other = replace(unfit, label="other-trees")
    text = printed(replace(comparison, policies=(*comparison.policies, other)), 100)
    assert "mine.py:OnlyTrees, other-trees: the scene is flat" in text


def test_the_answer_comes_first(comparison: Comparison) -> None:
    """A reader who stops after a line knows whom to take."""
    text = " ".join(printed(comparison, 60).split())
    assert text.startswith(comparison.answer[0])
    assert max(len(line.rstrip()) for line in printed(comparison, 60).splitlines()[:8]) <= 60


def test_sixty_columns_get_two_tables(comparison: Comparison) -> None:
    """The second leaves out knob and gate, so that all other numbers stand beside each other."""
    lines = printed(comparison, 60).splitlines()
    heads = [line.split()[:3] for line in lines if line.startswith("rank ")]
    assert [head[2] for head in heads][:1] == ["knob"]
    assert len(heads) == 2
    assert "knob" not in heads[1]


def test_a_terminal_of_ascii_prints_no_other_lines(comparison: Comparison) -> None:
    """Where only ASCII can be written, rules are of hyphens, and nothing fails."""
    raw = io.BytesIO()
    file = io.TextIOWrapper(raw, encoding="ascii", errors="replace")
    print_comparison(comparison, Console(file=file, width=80, highlight=False), wide=False)
    file.flush()
    text = raw.getvalue().decode("ascii")
    assert "---" in text
    assert "─" not in text


def test_long_names_are_cut_and_markup_is_text(comparison: Comparison) -> None:
    """A name of 10,000 characters leaves a table that can be read, and a tag is printed."""
    name = "[red]<b>" + "n" * 10_000
    first = replace(comparison.ok[0], label=name)
    others = tuple(p for p in comparison.policies if p is not comparison.ok[0])
    answer = (f"Take {name}.", *comparison.answer[1:])
    renamed = replace(comparison, policies=(first, *others), scene=name, answer=answer)
    for wide in (False, True):
        text = printed(renamed, 100, wide=wide)
        assert text.startswith("Take [red]<b>nnn")
        assert text.count("n" * 40) < 10
        assert max(len(line) for line in text.splitlines() if "nnn" in line) <= 100


def test_table_says_what_was_replayed(comparison: Comparison) -> None:
    """Scene, trace, hardware that is assumed, budget and window are named."""
    text = printed(comparison, 100)
    for part in (
        "small, 60 nodes",
        "turn, 0.5 to 3 s",
        "machine (assumed)",
        "budget 8 ms",
    ):
        assert part in text
    for sentence in comparison.answer:
        assert sentence in " ".join(text.split())


def test_pacing_is_told_where_there_is_any(comparison: Comparison) -> None:
    """The lag of two comparisons may differ by it alone."""
    assert "pacing" not in describe_run(comparison)
    conditions = replace(comparison.conditions, pacing="limiter")
    assert "pacing limiter" in describe_run(replace(comparison, conditions=conditions))


def test_failures_are_told_with_their_reason(comparison: Comparison) -> None:
    """A failed policy has no row of numbers but a line with frame and reason."""
    text = printed(comparison, 100)
    assert "mine.py:Raises: frame 70: ValueError" in text
    assert "mine.py:OnlyTrees: the scene is flat" in text


def test_rows_are_in_the_order_of_the_answer(comparison: Comparison) -> None:
    """By rank, then who misses, then oracles, which have no rank; twins are folded into one row."""
    twin = replace(comparison.ok[0], label="twin", same_as=comparison.ok[0].label)
    text = printed(replace(comparison, policies=(*comparison.policies, twin)), 140)
    rows = [line.split()[0] for line in text.splitlines() if "/1 " in line]
    assert rows == ["1", "misses", "oracle"] * (len(rows) // 3)
    assert rows
    assert f"twin did the same as {comparison.ok[0].label} in every run" in text
    for column in HEADLINE:
        assert column.header.split()[0] in text


def test_the_table_tells_how_the_knob_was_set(comparison: Comparison) -> None:
    """A value that was typed is told from one that was tuned to the budget."""
    (policy,) = (item for item in comparison.ok if item.name == "static-screen")
    assert policy.knob is not None
    assert "bias=1.5 (as given)" in printed(comparison, 140)
    tuned = replace(policy, knob=replace(policy.knob, tuned=True))
    text = printed(replace(comparison, policies=(tuned,)), 140)
    assert "bias=1.5" in text
    assert "as given" not in text


def test_wide_table_has_every_metric_with_its_interval(comparison: Comparison) -> None:
    """With --wide every id is listed with its unit, and intervals stand in brackets."""
    text = printed(comparison, 160, wide=True)
    for metric in METRICS:
        assert metric.id in text
    span = comparison.policies[0].metrics["work_ms_mean"].this_path
    assert span is not None
    assert f"({format_value(span[0])}, {format_value(span[1])})" in text


def test_narrow_terminal_gets_several_wide_tables(comparison: Comparison) -> None:
    """What does not fit beside each other stands below each other."""
    assert printed(comparison, 80, wide=True).count("frame_ms_mean") == 3
