"""The page of experiments: counts, claims and charts as in the record, and no tag but its own."""

import re

from lodbench.analysis.reproduce.experiment import Chart, Constant, Experiment, Findings, Line
from lodbench.analysis.reproduce.reproduction import Entry, Reproduction, Section
from lodbench.analysis.reproduce.web_page import render_reproduction

TAG = '<script>alert("x")</script>'
TOY = Experiment(
    id="toy/double",
    title=f"doubling {TAG}",
    setting="`numbers` alone.",
    constants={"factor": Constant("2", "printed", f"section 1 {TAG}")},
    trials=lambda _reduced: (),
    judge=lambda _numbers, _reduced: Findings(()),
)
CHART = Chart(
    name="twice", caption="Twice is more.", x="n", y="twice",
    lines=(
        Line("paper", [1.0, 10.0], [2.0, 20.0], printed=True),
        Line("ours", [0.0, 1.0, 10.0], [5.0, 2.0, 21.0]),
        Line("nothing", [], []),
    ),
    log_x=True,
)  # fmt: skip


def result_of(verdicts: list[str]) -> Reproduction:
    """Return an experiment with a claim for each verdict."""
    entries = tuple(
        Entry(id=TOY.id, claim=f"claim {TAG}", paper="2", ours="2.1", tolerance="10 %",
              verdict=verdict, constants={})
        for verdict in verdicts
    )  # fmt: skip
    section = Section(TOY, entries, (CHART,), (f"It depends. {TAG}",))
    return Reproduction(
        command="lodbench reproduce toy", version="0", code="ab", reduced=True, sections=(section,)
    )


def test_the_page_counts_verdicts_and_draws_both_sides() -> None:
    """Two of four hold; printed and own lines have the entries of the legend, points their values.

    A point at zero has no place on a logarithmic axis, and a line without points none at all.
    """
    verdicts = ["reproduced", "reproduced", "in direction", "not reproduced: why"]
    page = render_reproduction(result_of(verdicts))
    assert "Of 4 claims, 2 are reproduced, 1 in direction, and 1 not." in page
    assert "1 experiment of 1 paper" in page
    assert "verdicts are hints" in page
    (chart,) = re.findall(r'id="chart-toy-double-twice"(.*?)</figure>', page, re.DOTALL)
    lines = re.findall(r'<path data-p="(\d)" data-n="(\w+)"', chart)
    assert lines == [("0", "paper"), ("1", "ours")]
    assert re.findall(r'data-t="(.*?)"', chart) == [
        "paper: n 1.00; twice 2.00", "paper: n 10.0; twice 20.0",
        "ours: n 1.00; twice 2.00", "ours: n 10.0; twice 21.0",
    ]  # fmt: skip
    assert "Twice is more." in chart
    assert "numbers alone." in page
    assert page == render_reproduction(result_of(verdicts))


def test_texts_stay_text() -> None:
    """Titles, claims, sources and notes add no tag."""
    page = render_reproduction(result_of(["reproduced"]))
    assert page.count("<script>") == 1
    assert page.count("&lt;script&gt;") >= 5
