"""Plots as records: axes, paths and labels, worked by hand."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.analysis.report.names import readable, short_name, whole_name
from lodbench.analysis.report.palette import Ink
from lodbench.analysis.report.plots import (
    HIGH,
    WIDE,
    Axis,
    Mark,
    label_height_px,
    label_marks,
    line_of,
    path_of,
    round_step,
)

INK = Ink("", "", "", 0, 0)


@pytest.mark.parametrize(
    ("scale", "value", "share"),
    [("linear", 4.0, 0.25), ("root", 4.0, 0.5), ("log", 4.0, 0.5)],
)
def test_axis_places_by_its_scale(scale: str, value: float, share: float) -> None:
    """4 of 0 to 16 lies at a quarter; its root at half; of 1 to 16 its logarithm at half."""
    axis = Axis("", 1.0 if scale == "log" else 0.0, 16.0, scale)  # type: ignore[arg-type]
    assert axis.at(value) == pytest.approx(share)


def test_ticks_are_round_and_within_the_axis() -> None:
    """Linear ones at even steps of 1, 2 or 5; others at 1, 2, 5 with room; none is -0."""
    assert Axis("", -0.5, 4.4).ticks[0] == (10.2, "0")
    assert [text for _, text in Axis("", 0.0, 6.0).ticks] == ["0", "2", "4", "6"]
    assert [text for _, text in Axis("", 1.0, 100.0, "log").ticks][::2] == ["1", "5", "20", "100"]
    assert Axis("", 0.0, 400.0, "root").ticks[0] == (0.0, "0")
    assert Axis("", 0.0, 0.0).ticks == ()


@given(st.floats(1e-6, 1e6))
def test_steps_are_round(least: float) -> None:
    """A step is at least what is asked, and at most two and a half times that."""
    assert 0.998 * least <= round_step(least) <= 2.51 * least


def test_path_by_hand() -> None:
    """A path starts where its first point is, y downwards, and goes on by differences."""
    shares = np.array([0.0, 0.5, 0.5, 1.0])
    path = path_of(shares, np.array([1.0, 0.0, 0.0, 1.0]))
    assert path == f"M0 0l{WIDE // 2} {HIGH} {WIDE // 2} {-HIGH}"
    assert path_of(shares[:0], shares[:0]) == ""
    assert path_of(shares[1:3], shares[1:3]) == f"M{WIDE // 2} {HIGH // 2}h1"


def test_lines_leave_out_what_has_no_value_and_stay_near() -> None:
    """NaN and infinity are no points; what lies far beyond an axis is drawn close outside it."""
    axes = (Axis("", 0.0, 2.0), Axis("", 0.0, 1.0))
    points = np.array([0.0, 1.0, 2.0, 2.0]), np.array([0.0, np.nan, np.inf, 1e9])
    assert line_of(INK, axes, points).path == f"M0 {HIGH}l{WIDE} {-4 * HIGH}"


@given(st.lists(st.floats(0.0, 100.0), min_size=1, max_size=25))
def test_labels_never_overlap_and_keep_their_order(below: list[float]) -> None:
    """However marks lie, labels have a line's height each, inside the plot, in their order."""
    marks = [Mark(INK, 50.0, at, "") for at in below]
    height_px = label_height_px(len(marks), 200)
    labels, leaders = label_marks(marks, [str(at) for at in below], height_px)
    places = [label.below for label in labels]
    room = 100.0 * 17 / height_px
    assert all(b - a >= room - 0.02 for a, b in pairwise(places))
    assert min(places) >= room / 2 - 0.02
    assert max(places) <= 100.0 - room / 2 + 0.02
    assert [float(label.text) for label in labels] == sorted(below)
    assert len(leaders) == len(marks)


def test_long_names_are_cut_and_short_ones_stay() -> None:
    """A name that can be read is untouched; a long one is cut, in sentences, too."""
    long = "a" * 10_000
    assert (short_name("full"), whole_name("full")) == ("full", "")
    assert len(short_name(long)) == 80
    assert short_name(f"{long}/mine.py:Broken").endswith("aaa/mine.py:Broken")
    assert len(whole_name(long)) == 500
    assert readable(f"Take {long}: it", ["full", long]) == f"Take {short_name(long)}: it"
