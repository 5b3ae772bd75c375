"""The report: complete, self-contained, safe with any name, and honest about what is missing."""

import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import msgspec
import pytest

from lodbench.analysis.metrics.measured_frames import MeasuredFrames
from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.report import sections
from lodbench.analysis.report.blocks import (
    Across,
    Cell,
    Command,
    Paragraph,
    Section,
    Table,
    Terms,
    Tile,
    Tiles,
)
from lodbench.analysis.report.page import render_page
from lodbench.analysis.report.palette import Ink, inks
from lodbench.analysis.report.plots import Axis, Label, Mark, Plot, Plots, Row, Rule
from lodbench.analysis.report.render import SECTIONS, render_report
from lodbench.analysis.report.results import Results
from lodbench.analysis.report.sections import cost_breakdown
from lodbench.analysis.report.sections.the_answer import policy_spec
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
    assert "Intervals: " in text
    assert "--wide" not in text  # an option of the terminal


def test_the_table_is_in_the_order_of_the_answer(results: Compared) -> None:
    """Rows stand by rank, then who misses, then oracles; whom the answer names is the first."""
    html = page_of(results)
    ranking = html[html.index(">Ranking<") : html.index("What each policy gives")]
    shown = [policy for policy in results.comparison.ok if policy.same_as is None]
    places = [ranking.index(f">{policy.label}</td>") for policy in shown]
    assert places == sorted(places)
    assert shown[0].rank == 1
    assert results.comparison.answer[0].startswith(f"Take {shown[0].label}")
    misses, oracles = ranking.index("not surely within the budget"), ranking.index("Oracles")
    for place, policy in zip(places, shown, strict=True):
        assert (place > misses) == (policy.rank is None)
        assert (place > oracles) == policy.oracle
    (full,) = (policy for policy in shown if policy.label == "full")
    assert full.keeps_budget is not None
    ratio = full.keeps_budget.work_ms / results.comparison.budget_ms
    assert f'scope="row">{ratio:.2f} ×</th>' in ranking


def test_the_page_reads_from_the_answer_to_its_warrant(results: Compared) -> None:
    """Answer, ranking, what is given for what, the path, and at the end where it comes from."""
    html = page_of(results)
    heads = re.findall(r"<h2>(.*?)</h2>", html)
    assert heads[:3] == ["Ranking", "What each policy gives for its work", "Along the first path"]
    assert heads[-1] == "Where the numbers come from"
    order = ("Take ", "--policy ", "How sure", "On which machine", ">Ranking<", 'class="legend"',
             'id="chart-tradeoff"', 'id="chart-switches"', 'id="chart-work"')  # fmt: skip
    places = [html.index(part) for part in order]
    assert places == sorted(places)


def test_the_line_to_paste_is_the_policy_as_it_was_set(results: Compared) -> None:
    """The recommended policy with its knob can be typed again; what was typed stays as it was."""
    leader = next(policy for policy in results.comparison.ok if policy.rank == 1)
    line = f"--policy {policy_spec(leader)}"
    assert line in page_of(results)
    assert leader.knob is not None
    spec = parse_policy(policy_spec(leader))
    assert spec.params[leader.knob.name] == pytest.approx(leader.knob.value)
    assert leader.name == "static-screen"
    for engine in ("unity", "unreal"):
        assert f"lodbench export . --engine {engine} --policy static-screen<" in page_of(results)
    assert "--engine cesium" not in page_of(results)
    typed = replace(leader, label=f"x:{leader.knob.name}={leader.knob.value:g}")
    assert policy_spec(typed) == typed.label
    assert policy_spec(replace(leader, label="x:a=1")).startswith("x:a=1,")
    assert policy_spec(replace(leader, knob=None)) == leader.label


def test_markup_in_names_stays_text(results: Compared) -> None:
    """A policy whose name or reason holds tags adds none to the page."""
    html = page_of(results)
    assert "<b>patience</b>" not in html
    assert "&lt;b&gt;patience&lt;/b&gt;" in html


def test_markup_in_cells_stays_text() -> None:
    """Every text of every kind of block is escaped, attributes included."""
    tag = '<b title="x">'
    ink = Ink("", "dash", "circle", 0, 0)
    cell = Cell(tag, small=tag, hint=tag, tags=(tag,), ink=ink)
    axis = Axis(tag, 0.0, 1.0)
    plot = Plot(
        "p", tag, axis, axis, marks=[Mark(ink, 0.0, 0.0, tag)], labels=[Label(ink, 0.0, tag)],
        rules=[Rule(True, 0.0, tag)], caption=tag, rows=[Row(ink, tag, ())],
    )  # fmt: skip
    blocks = (
        Table((cell, tag), ((cell, tag), Across(cell, "text")), "facts", folded=tag),
        Tiles((Tile(tag, (cell, tag), tag),)),
        Paragraph(tag, "warn"),
        Command(tag, tag),
        Terms(tag, ((tag, tag),)),
        Plots((plot,)),
    )
    sections = [Section(tag, tag, blocks), Section(tag, tag, (), folded=True)]
    html = render_page(tag, tag, sections, [cell])
    assert tag not in html
    assert Page(html).open == []


HOSTILE = "</script><script>alert('\"')</script>" + "é" * 10_000


def test_names_of_any_kind_are_text_that_can_be_read(results: Compared) -> None:
    """A name of markup, quotes and 10,000 characters is escaped and cut, and the page stays small.

    Sentences, tables, legend and plots show its beginning; the line to paste has all of it.
    """
    was = results.comparison.ok[0].label
    text = msgspec.json.encode(results.comparison).decode()
    renamed = msgspec.json.decode(
        text.replace(f'"{was}"', msgspec.json.encode(HOSTILE).decode()).replace(
            f"Take {was}", "Take " + msgspec.json.encode(HOSTILE).decode()[1:-1]
        ),
        type=type(results.comparison),
    )
    renamed = replace(renamed, scene=HOSTILE, hardware=HOSTILE, paths=(HOSTILE, "other"))
    logs = {HOSTILE if label == was else label: log for label, log in results.logs.items()}
    html = render_report(renamed, logs)
    assert "alert('" not in html
    assert html.count("<script>") == page_of(results).count("<script>")
    assert html.count("&lt;/script&gt;&lt;script&gt;") > 10
    assert len(re.findall("é{1000,}", html)) == 1, "in the line to paste alone"
    assert len(html) < len(page_of(results)) + 100_000
    assert Page(html).open == []


def test_every_control_is_a_button_and_every_wide_table_scrolls(results: Compared) -> None:
    """Headings that sort, the legend and zoom take the keyboard; tables scroll in their own box."""
    html = page_of(results)
    assert html.count("<table") == html.count('<div class="scroll" tabindex="0" role="region"')
    assert html.count('<th scope="col"><button') + html.count('"col"><button') >= 10
    for policy in results.comparison.ok:
        if policy.same_as is None:
            assert f"</i>{policy.label}</button>" in html
    assert "onclick" not in html
    assert "{display:none}" not in html.split("</style>")[1], "few policies are all drawn"


def test_a_page_draws_the_first_of_many_policies(results: Compared) -> None:
    """Whom the legend does not draw at first is hidden in every plot until a reader asks."""
    entries = [Cell(f"p{i}", ink=Ink("", "", "", 0, i)) for i in range(4)]
    html = render_page("", "", [Section("", "", (Plots(()),))], entries, drawn_at_first=3)
    assert html.count('[data-p="3"]:not(button){display:none}') == 1
    assert html.count('aria-pressed="true"') == 3
    assert html.count('aria-pressed="false"') == 1


def test_the_page_needs_no_library_and_is_small(results: Compared) -> None:
    """Charts are drawn by the page itself: far below the 3 MB that a mail takes."""
    html = page_of(results)
    assert "Plotly.newPlot" not in html
    assert len(html.encode()) < 400_000


def test_every_section_is_on_the_page_once() -> None:
    """Each file of ``sections/`` is registered, under its own name."""
    files = {path.stem for path in Path(sections.__file__).parent.glob("*.py")} - {"__init__"}
    assert sorted(SECTIONS) == sorted(files)


def test_charts_hold_every_policy(results: Compared) -> None:
    """Each chart draws each policy that was scored, and the one that failed nowhere."""
    html = page_of(results)
    charts = dict(re.findall(r'id="chart-([\w-]+)"(.*?)</figure>', html, re.DOTALL))
    chosen = inks(results.comparison)
    for name in ("work", "lag", "pops", "error", "work-tail", "frame-tail", "flicker", "step-0"):
        for policy in results.comparison.policies:
            drawn = f'data-p="{chosen[policy.label].index}"' in charts[name]
            expected = policy.status == "ok" and policy.same_as is None
            assert drawn == expected, (name, policy.label)
    assert {"tradeoff", "switches", "above"} <= set(charts)


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


def test_costs_add_up_to_the_time_of_a_frame(results: Compared) -> None:
    """Of each side the terms and the constant are the mean frame; no counted term is negative."""
    shown = Results(results.comparison, results.logs, inks(results.comparison))
    costs = results.comparison.unit_costs
    for policy in shown.drawn:
        found = cost_breakdown.mean_ms(shown, policy.label)
        run = MeasuredFrames(results.logs[policy.label], *results.comparison.window_s[0])
        for side, unit_ms in (("gpu", costs.gpu), ("cpu", costs.cpu)):
            terms = [found[f"{side} {name}"] for name in unit_ms if f"{side} {name}" in found]
            assert sum(terms) + found[f"{side} constant"] == pytest.approx(found[side])
            assert min(terms, default=0.0) >= 0.0
            assert run[f"{side}_ms"].min() <= found[side] <= run[f"{side}_ms"].max()
        assert found["gpu triangles"] > 0.0
    assert ">What costs what<" in page_of(results)
