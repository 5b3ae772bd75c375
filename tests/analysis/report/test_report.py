"""The report: complete, self-contained, safe with any name, and honest about what is missing."""

import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.report import sections
from lodbench.analysis.report.blocks import Across, Cell, Paragraph, Section, Table, Tile, Tiles
from lodbench.analysis.report.page import render_page
from lodbench.analysis.report.palette import inks
from lodbench.analysis.report.render import SECTIONS, render_report
from lodbench.analysis.report.series import envelope, tail
from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.comparison_folder import Compared
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.camera_trace import CameraTrace


class Page(HTMLParser):
    """Collects what a browser would load, the tags left open, and the text."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.loads: list[str] = []
        self.open: list[str] = []
        self.text = ""
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note a tag and what it refers to."""
        self.loads += [str(value) for key, value in attrs if key in {"src", "href"}]
        if tag not in {"meta", "link", "img", "br", "input", "hr"}:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        """Close the innermost tag, which has to be this one."""
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        """Collect text outside scripts and styles."""
        if self.open and self.open[-1] not in {"script", "style"}:
            self.text += data


@pytest.fixture(scope="module")
def results(
    small_scene: Scene, turn_trace: CameraTrace, machine: HardwareProfile, bad_policies: Path
) -> Compared:
    """Return a comparison with a failed policy, whose reason holds markup."""
    texts = [
        "full",
        "static-screen",
        "feedback:target=0.9",
        f"{bad_policies}:Raises",
        f"{bad_policies}:Seer",
    ]
    policies = [parse_policy(text) for text in texts]
    settings = CompareSettings(workers=1, warmup_s=0.2)
    replay = ReplayOptions(budget_ms=8.0)
    paths = [
        replace(turn_trace.stretch(0.5 - 0.05 * at, 2.0 - 0.05 * at), name=f"turn {at}")
        for at in (0, 1)
    ]
    return compare(policies, small_scene, paths, machine, replay, settings)


def page_of(results: Compared) -> str:
    """Return the page of a comparison."""
    return render_report(results.comparison, results.logs)


def test_page_is_whole_and_loads_nothing(results: Compared) -> None:
    """Every tag is closed, and nothing is fetched from anywhere."""
    page = Page(page_of(results))
    assert page.open == []
    assert page.loads == []


def test_page_says_all_that_matters(results: Compared) -> None:
    """Policies, every metric with its source, provenance, warm-up and the step are on the page."""
    comparison = results.comparison
    text = Page(page_of(results)).text
    for part in (
        "full",
        "static-screen",
        "feedback",
        "2 paths such as turn 0, 0.2 to 1.5 s",
        *comparison.answer,
        "made up for tests",
    ):
        assert part in text
    for metric in METRICS:
        assert metric.id in text
        assert " ".join(metric.source.split()) in " ".join(text.split())
    assert "is assumed, not measured" in text
    (full,) = (policy for policy in comparison.ok if policy.label == "full")
    assert full.steps[0].overshoot_ratio > 1.2
    assert f"{full.steps[0].overshoot_ratio:.2f} ×" in text
    assert "frame 70: ValueError: lost <b>patience</b>" in text


def test_the_table_is_in_the_order_of_the_answer(results: Compared) -> None:
    """Rows stand by rank, then who misses, then oracles; whom the answer names is the first."""
    html = page_of(results)
    ranking = html[html.index(">Ranking<") : html.index("What each policy gives")]
    shown = [policy for policy in results.comparison.ok if policy.same_as is None]
    places = [ranking.index(f">{policy.label}<") for policy in shown]
    assert places == sorted(places)
    assert shown[0].rank == 1
    assert results.comparison.answer[0].startswith(f"Take {shown[0].label}")
    misses = ranking.index("Not surely within the budget")
    assert [place > misses for place in places] == [policy.rank is None for policy in shown]


def test_markup_in_names_stays_text(results: Compared) -> None:
    """A policy whose name or reason holds tags adds none to the page."""
    html = page_of(results)
    assert "<b>patience</b>" not in html
    assert "&lt;b&gt;patience&lt;/b&gt;" in html


def test_markup_in_cells_stays_text() -> None:
    """Every text of every kind of block is escaped, attributes included."""
    tag = '<b title="x">'
    cell = Cell(tag, small=tag, hint=tag, tags=(tag,))
    blocks = (
        Table((cell, tag), ((cell, tag), Across(cell, "text")), "facts"),
        Tiles((Tile(tag, (cell, tag), tag),)),
        Paragraph(tag, "warn"),
    )
    html = render_page(tag, tag, [Section(tag, tag, blocks), Section(tag, tag, (), folded=True)])
    assert tag not in html
    assert html.count("&lt;b title=&#34;x&#34;&gt;") == sum(
        (3, 2 * 2, 3 * 4 + 2, 3 + 3, 1)  # of the page, its sections, table, tile and paragraph
    )


def test_every_section_is_on_the_page_once() -> None:
    """Each file of ``sections/`` is registered, under its own name."""
    files = {path.stem for path in Path(sections.__file__).parent.glob("*.py")} - {"__init__"}
    assert sorted(SECTIONS) == sorted(files)


def test_charts_hold_every_policy(results: Compared) -> None:
    """Each chart draws each policy that was scored, and the one that failed nowhere."""
    html = page_of(results)
    for chart in ("time", "distribution", "steps", "tradeoff"):
        assert html.count(f'id="chart-{chart}"') == 1, chart
    assert len(re.findall(r'"name":"static-screen"', html)) >= 4 + 2 + 1 + 4
    assert not re.search(r'"name":"[^"]*Raises"', html)


def test_same_results_same_page(results: Compared) -> None:
    """The page has no random identifiers and no dates."""
    assert page_of(results) == page_of(results)


def test_page_of_failures_only(
    small_scene: Scene, turn_trace: CameraTrace, machine: HardwareProfile, bad_policies: Path
) -> None:
    """With nothing to draw the page still says what went wrong."""
    results = compare(
        [parse_policy(f"{bad_policies}:Nan")],
        small_scene,
        [turn_trace],
        machine,
        ReplayOptions(budget_ms=8.0),
        CompareSettings(workers=1),
    )
    page = Page(page_of(results))
    assert page.open == []
    assert "nan" in page.text
    assert "Nothing to draw" in page.text


def test_inks_are_distinct(results: Compared) -> None:
    """No two policies look alike, in charts or as markers."""
    chosen = inks(results.comparison)
    assert len(set(chosen.values())) == len(chosen) == 5


def test_envelope_keeps_extremes_and_ends_of_short_lines() -> None:
    """A short line is untouched; of a long one every bucket keeps its lowest and highest."""
    x = np.arange(1000.0)
    y = np.sin(x)
    y[517] = 40.0
    assert [part.tolist() for part in envelope(x[:20], y[:20], 10)] == [
        x[:20].tolist(),
        y[:20].tolist(),
    ]
    few_x, few_y = envelope(x, y, 50)
    assert len(few_x) <= 100
    assert 40.0 in few_y
    assert (np.diff(few_x) > 0).all()


@given(st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=300), st.integers(1, 20))
def test_envelope_keeps_the_range(values: list[float], buckets: int) -> None:
    """Whatever is left out, the lowest and the highest value stay."""
    y = np.array(values)
    _, few = envelope(np.arange(len(y), dtype=np.float64), y, buckets)
    assert (few.min(), few.max()) == (y.min(), y.max())
    assert len(few) <= max(2 * buckets, len(y) if len(y) <= 2 * buckets else 0)


def test_tail_by_hand() -> None:
    """All time is in frames of the shortest at least, and half in the longest, which lasts so long.

    A frame that is never shown has no interval, and one that weighs nothing no time.
    """
    values = np.array([3.0, 1.0, np.nan, 2.0, 9.0, 7.0])
    x, share = tail(values, np.array([1.0, 1.0, 5.0, 1.0, 3.0, 0.0]), 100)
    assert x.tolist() == [1.0, 2.0, 3.0, 9.0]
    assert share == pytest.approx([1.0, 5 / 6, 4 / 6, 0.5])


def test_tail_is_thinned_in_its_body_only() -> None:
    """Of 10,000 frames the slowest twentieth is drawn in full."""
    x, share = tail(np.arange(10_000.0), np.ones(10_000), 100)
    assert len(x) <= 601
    assert x[-500:].tolist() == np.arange(9_500.0, 10_000.0).tolist()
    assert share[-1] == pytest.approx(1e-4)
