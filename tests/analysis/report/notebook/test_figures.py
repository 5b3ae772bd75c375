"""Figures of a comparison hold its numbers, and every name in them is text."""

from math import log10
from typing import Any

import pytest

from lodbench.analysis.report.notebook.figures import FIGURES, as_text
from lodbench.analysis.study.comparison_folder import Compared
from lodbench.base.errors import InputError


def traces_of(figure: Any, name: str) -> dict[str, Any]:
    """Return what a figure draws under a name, by how it is drawn."""
    return {trace.mode: trace for trace in figure.data if trace.name == name}


def test_the_tradeoff_is_that_of_the_record(compared: Compared, ordinary_name: str) -> None:
    """A line is the curve, a point the work that was judged with its error, a rule the budget."""
    comparison = compared.comparison
    first, full = comparison.ok
    figure = comparison.figure("tradeoff")
    curve = comparison.curve[ordinary_name]
    drawn = traces_of(figure, ordinary_name)
    assert drawn["lines"].x == curve.work_ms
    assert drawn["lines"].y == curve.visible_error_px
    assert first.keeps_budget is not None
    assert drawn["markers"].x == (first.keeps_budget.work_ms,)
    assert drawn["markers"].y == (first.value_of("visible_error_px"),)
    assert [trace.showlegend for trace in drawn.values()] == [False, None], "one entry a policy"
    assert set(traces_of(figure, full.label)) == {"markers"}
    (rule,) = figure.layout.shapes
    assert (rule.x0, rule.x1) == (8.0, 8.0)
    (note,) = figure.layout.annotations
    assert (note.text, note.x) == ("budget 8 ms", log10(8.0))


def test_switches_are_those_of_the_record(compared: Compared, ordinary_name: str) -> None:
    """The other figure has visible pops over visible error."""
    comparison = compared.comparison
    drawn = traces_of(comparison.figure("switches"), ordinary_name)
    curve = comparison.curve[ordinary_name]
    assert (drawn["lines"].x, drawn["lines"].y) == (curve.visible_error_px, curve.pops_per_s)


@pytest.mark.parametrize("name", FIGURES)
def test_names_are_text_in_figures(name: str, hostile: Compared, hostile_name: str) -> None:
    """What plotly takes for a tag, an entity or TeX is written so that it shows it as it is."""
    figure = hostile.comparison.figure(name)
    names = {trace.name for trace in figure.data}
    (shown,) = (shown for shown in names if "alert" in shown)
    assert not {"<", "$"} & set(shown)
    assert as_text("a & <b> $x$") == "a &amp; &lt;b&gt; &#36;x&#36;"


def test_another_name_is_refused_in_one_line(compared: Compared) -> None:
    """The error names those that there are, and the nearest."""
    with pytest.raises(InputError) as refused:
        compared.comparison.figure("tradeof")
    expected = "figure: expected one of tradeoff, switches, got tradeof; did you mean tradeoff?"
    assert str(refused.value) == expected
