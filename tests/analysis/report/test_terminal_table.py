"""The tables of the terminal."""

import io
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.report.summary import HEADLINE, best_labels
from lodbench.analysis.report.terminal_table import print_comparison
from lodbench.analysis.report.values import format_value
from lodbench.analysis.study.compare import CompareOptions, compare
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
    options = CompareOptions(workers=1, warmup_s=0.5, draws=2)
    replay = ReplayOptions(budget_ms=8.0)
    policies = [parse_policy(text) for text in texts]
    return compare(policies, small_scene, turn_trace, fitted_machine, replay, options)[0]


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


@pytest.mark.parametrize("width", [40, 80])
def test_narrow_terminal_gets_several_short_tables(comparison: Comparison, width: int) -> None:
    """Columns that do not fit stand below the others, none is cut, and every row has its name."""
    text = printed(comparison, width)
    tables = text.count("\npolicy ")
    assert tables > 1
    assert text.count("\nfull ") == tables
    assert "…" not in text
    assert max(len(line) for line in text.splitlines() if line.startswith("full ")) <= width


def test_policies_of_one_reason_share_a_line(comparison: Comparison) -> None:
    """Policies that do not fit the scene are named once, before what they have in common."""
    other = replace(comparison.policies[3], label="other-trees")
    text = printed(replace(comparison, policies=(*comparison.policies, other)), 100)
    assert "mine.py:OnlyTrees, other-trees: the scene is flat" in text


def test_table_says_what_was_replayed(comparison: Comparison) -> None:
    """Scene, trace, hardware that is assumed, budget and window are named."""
    text = printed(comparison, 100)
    for part in (
        "small, 60 nodes",
        "turn, 3.0 s, up to 751 frames",
        "machine (assumed)",
        "budget 8 ms",
    ):
        assert part in text
    assert "over 0.5 to 3 s of the path" in text


def test_failures_are_told_with_their_reason(comparison: Comparison) -> None:
    """A failed policy has no row of numbers but a line with frame and reason."""
    text = printed(comparison, 100)
    assert "mine.py:Raises: frame 70: ValueError" in text
    assert "mine.py:OnlyTrees: the scene is flat" in text


def test_best_of_each_column_is_marked_without_colour(comparison: Comparison) -> None:
    """A star marks the best, and an oracle never gets one."""
    rows = [line for line in printed(comparison, 100).splitlines() if line.startswith("full ")]
    assert "0*" in rows[0]  # full detail never toggles
    for column in HEADLINE:
        assert not any("Seer" in label for label in best_labels(comparison, column.metric))
    assert best_labels(comparison, "sse_px_p95") == {"full"}
    assert best_labels(comparison, "missed_vsync_fraction") == set()


def test_equal_values_have_no_best(comparison: Comparison) -> None:
    """Where all policies are equal, none is marked."""
    assert best_labels(comparison, "missing_objects_mean") == set()


def test_unsettled_mean_is_a_lower_bound(comparison: Comparison) -> None:
    """Full detail never settles: its settling time is marked."""
    row = next(line for line in printed(comparison, 100).splitlines() if line.startswith("full "))
    assert ">" in row


def test_wide_table_has_every_metric_with_its_interval(comparison: Comparison) -> None:
    """With --wide every id is listed with its unit, and intervals stand in brackets."""
    text = printed(comparison, 160, wide=True)
    for metric in METRICS:
        assert metric.id in text
    low = comparison.policies[0].metrics["work_ms_mean"].low
    assert f"[{format_value(low)}, " in text


def test_narrow_terminal_gets_several_wide_tables(comparison: Comparison) -> None:
    """What does not fit beside each other stands below each other."""
    assert printed(comparison, 80, wide=True).count("frame_ms_mean") == 3
