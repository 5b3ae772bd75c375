"""Figures: the same bytes again, as wide as a paper asks, and any name is text in them."""

from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from lodbench.analysis.report.palette import inks
from lodbench.analysis.report.printed import drawing
from lodbench.analysis.report.printed.drawing import drawing_style, require_matplotlib, save_figure
from lodbench.analysis.report.printed.figures import write_figures
from lodbench.analysis.report.printed.labels import spread
from lodbench.analysis.report.printed.sheet import Sheet
from lodbench.analysis.report.printed.tradeoff import draw_error_over_work
from lodbench.analysis.study.comparison_folder import Compared
from lodbench.base.errors import InputError
from lodbench.base.foreign_text import one_line

pytest.importorskip("matplotlib")

FIGURES = ("error-over-work", "switches-over-error", "work-along-the-path")
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def folder(hostile: Compared, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the figures of names that hold markup."""
    folder = tmp_path_factory.mktemp("figures") / "of" / "a-paper"
    write_figures(hostile, folder)
    return folder


@pytest.mark.slow
def test_each_figure_in_each_width_and_format(folder: Path) -> None:
    """Three figures, two widths, three formats, and nothing else."""
    assert {path.name for path in folder.iterdir()} == {
        f"{figure}-{width}.{kind}"
        for figure in FIGURES
        for width in ("column", "page")
        for kind in ("pdf", "svg", "png")
    }


@pytest.mark.slow
@pytest.mark.parametrize(("width", "inches"), [("column", 3.3), ("page", 7.0)])
@pytest.mark.parametrize("figure", FIGURES)
def test_widths_are_a_papers(folder: Path, figure: str, width: str, inches: float) -> None:
    """A column is 3.3 inches and a page 7: 72 points each in SVG and PDF, 300 dots in PNG."""
    svg = ET.parse(folder / f"{figure}-{width}.svg").getroot()
    assert svg.attrib["width"] == f"{72.0 * inches:g}pt"
    pdf = (folder / f"{figure}-{width}.pdf").read_bytes()
    assert f"/MediaBox [ 0 0 {72.0 * inches:g} ".encode() in pdf
    with Image.open(folder / f"{figure}-{width}.png") as picture:
        assert picture.width == round(300 * inches)


@pytest.mark.slow
@pytest.mark.parametrize("figure", FIGURES)
def test_names_are_text(folder: Path, figure: str, hostile_name: str) -> None:
    """A name is a text of the SVG, formulas and markup in it included, and no element."""
    svg = ET.parse(folder / f"{figure}-column.svg").getroot()
    texts = ["".join(text.itertext()) for text in svg.iter(f"{SVG}text")]
    assert any(one_line(hostile_name, 24) in text for text in texts)
    assert not list(svg.iter(f"{SVG}script"))


@pytest.mark.slow
def test_the_same_comparison_makes_the_same_bytes(
    hostile: Compared, folder: Path, tmp_path: Path
) -> None:
    """Written again, each file is what it was, and no file holds a date."""
    for path in write_figures(hostile, tmp_path):
        assert path.read_bytes() == (folder / path.name).read_bytes()
        assert b"CreationDate" not in path.read_bytes()


def test_a_figure_of_any_name(hostile: Compared, tmp_path: Path, hostile_name: str) -> None:
    """One figure, drawn twice: a name is a text in it, and the bytes are the same."""
    sheet = Sheet(hostile.comparison, hostile.logs, inks(hostile.comparison), 3.3)
    for at in (0, 1):
        with drawing_style(7.0, text__parse_math=False):
            save_figure(draw_error_over_work(sheet), tmp_path / f"{at}.svg")
    first, second = ((tmp_path / f"{at}.svg").read_bytes() for at in (0, 1))
    assert first == second
    texts = ["".join(text.itertext()) for text in ET.fromstring(first).iter(f"{SVG}text")]
    assert one_line(hostile_name, 24) in texts


def test_curve_point_and_budget_are_drawn(compared: Compared) -> None:
    """The tuned policy's curve and point are those of the record, and the budget is a line."""
    comparison = compared.comparison
    sheet = Sheet(comparison, compared.logs, inks(comparison), 3.3)
    with drawing_style(7.0):
        (axes,) = draw_error_over_work(sheet).axes
    lines: list[Any] = [np.column_stack(line.get_data()).tolist() for line in axes.lines]
    for label, curve in comparison.curve.items():
        drawn = list(zip(curve.work_ms, curve.visible_error_px, strict=True))
        assert [list(point) for point in drawn] in lines, label
    for policy in comparison.ok:
        assert policy.keeps_budget is not None
        assert [[policy.keeps_budget.work_ms, policy.value_of("visible_error_px")]] in lines
    assert [[8.0, 0.0], [8.0, 1.0]] in lines
    assert {text.get_text() for text in axes.texts} == {
        "budget 8 ms", *sheet.names().values()
    }  # fmt: skip


def test_spread_by_hand() -> None:
    """Two at 0.5 are moved a tenth apart about it; one far away stays; none goes below 0."""
    assert spread(np.array([0.5, 0.5, 0.9]), 0.1) == pytest.approx([0.45, 0.55, 0.9])
    assert spread(np.array([0.0, 0.0]), 0.1) == pytest.approx([0.0, 0.1])
    assert spread(np.array([0.2, 0.5]), 0.1) == pytest.approx([0.2, 0.5])


@given(st.lists(st.floats(0.0, 1.0), max_size=30), st.floats(0.001, 0.2))
def test_spread_keeps_apart(wanted: list[float], apart: float) -> None:
    """Neighbours are at least so far apart, in the order that was given."""
    places = spread(np.array(sorted(wanted)), apart)
    assert (np.diff(places) >= apart - 1e-12).all()
    assert (places >= 0.0).all()


def test_missing_matplotlib_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the extra, a line says how to install it."""

    def nothing(_name: str) -> None:
        """Find no module."""

    monkeypatch.setattr(drawing, "find_spec", nothing)
    with pytest.raises(InputError, match=r"--figures: expected matplotlib.*\[fit-plots\]"):
        require_matplotlib("--figures")
