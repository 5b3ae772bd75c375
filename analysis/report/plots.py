"""Charts as records: lines and marks in shares of a plot, which the page draws as SVG.

A plot is drawn by the page's own markup and style, so that it needs no library, prints, takes the
page's colours in light and dark, and stretches to any width.  Widths are shares, heights pixels.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from ...base.arrays import FloatArray
from .palette import Ink
from .values import format_value

Scale = Literal["linear", "root", "log"]

WIDE, HIGH = 20_000, 2_000
"""Units of a plot's coordinates; finer than a screen, also where a plot is zoomed into."""
LEVEL_STYLES = tuple(f"level{shade}" for shade in range(8))
"""Styles of lines by level of detail, coarse to fine."""
_OUTSIDE = 3.0
"""How many widths or heights beyond the plot a line may lead."""
_LABEL_PX = 17
"""Height of a line of labels."""


@dataclass(frozen=True, slots=True)
class Axis:
    """An axis: its ends, and how values lie between them.

    Attributes
    ----------
    title : str
    low, high : float
    scale : {"linear", "root", "log"}
        A root shows what is close to zero apart, and zero itself.
    parts : int
        How many parts the ticks of a linear axis make, about.
    names : tuple of str
        What stands at 0, 1, … on a linear axis of things that are no numbers.
    """

    title: str
    low: float
    high: float
    scale: Scale = "linear"
    parts: int = 5
    names: tuple[str, ...] = ()

    def place(self, values: FloatArray) -> FloatArray:
        """Return where values lie, as shares of the axis, a little beyond its ends at most."""
        low, high = self._warp(np.array([self.low, self.high]))
        share = (self._warp(values) - low) / max(high - low, 1e-300)
        return np.clip(share, -_OUTSIDE, 1.0 + _OUTSIDE)

    def at(self, value: float) -> float:
        """Return where one value lies, within the axis."""
        return float(np.clip(self.place(np.array([value]))[0], 0.0, 1.0))

    def _warp(self, values: FloatArray) -> FloatArray:
        if self.scale == "log":
            return np.log(np.maximum(values, 1e-9))
        return np.sqrt(np.maximum(values, 0.0)) if self.scale == "root" else values

    @property
    def ticks(self) -> tuple[tuple[float, str], ...]:
        """Places of round values, in per cent of the axis, and their texts."""
        if self.low >= self.high:
            return ()
        if self.names:
            return tuple((round(100.0 * self.at(i), 2), name) for i, name in enumerate(self.names))
        values = self._even_values() if self.scale == "linear" else self._spread_values()
        return tuple((round(100.0 * self.at(value), 2), _tick_text(value)) for value in values)

    def _even_values(self) -> list[float]:
        """Return multiples of a round step."""
        step = round_step((self.high - self.low) / self.parts)
        first, last = math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9)
        return [step * at for at in range(first, last + 1)]

    def _spread_values(self) -> list[float]:
        """Return 1, 2 and 5 times powers of ten that keep a distance; zero where there is one."""
        last = math.ceil(math.log10(max(self.high, 1.0)))
        powers = 10.0 ** np.arange(-4, last + 1)
        values = np.concatenate(([0.0], (powers[:, None] * [1.0, 2.0, 5.0]).ravel()))
        inside = values[(values >= 0.999 * self.low) & (values <= 1.001 * self.high)]
        if self.scale == "log":
            inside = inside[inside > 0.0]
        kept: list[float] = []
        for value in inside.tolist():
            if not kept or self.at(value) - self.at(kept[-1]) >= 0.09:
                kept.append(value)
        return kept


def round_step(least: float) -> float:
    """Return 1, 2 or 5 times a power of ten, at least so large."""
    power = 10.0 ** np.floor(np.log10(max(least, 1e-9)))
    return float(next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= 0.999 * least))


def _tick_text(value: float) -> str:
    return f"{value:,.0f}" if abs(value) >= 1e3 else f"{value:.4g}"


@dataclass(frozen=True, slots=True)
class Line:
    """A policy's line; `path` is in units of the plot, y downwards.

    Attributes
    ----------
    style : str
        Class of the page's style: "leader", "band", "heat1" to "heat4" or one of `LEVEL_STYLES`.
    hint : str
        What its hover says, of a line in a row; of another, its name where it is not the legend's.
    """

    ink: Ink
    path: str
    style: str = ""
    hint: str = ""


@dataclass(frozen=True, slots=True)
class Row:
    """A policy's or an object's stretch of time as boxes in shades, in a row of its own.

    The legend rules rows whose ink has an index; `hint` is shown under the pointer.
    """

    ink: Ink
    name: str
    boxes: Sequence[Line]
    hint: str = ""


@dataclass(frozen=True, slots=True)
class Mark:
    """A policy's point, in per cent from the left and from below, and what it says."""

    ink: Ink
    left: float
    below: float
    hint: str


@dataclass(frozen=True, slots=True)
class Label:
    """A text beside the plot's right edge, in per cent from below."""

    ink: Ink
    below: float
    text: str


@dataclass(frozen=True, slots=True)
class Rule:
    """A dashed line across the plot with its text, in per cent from the left or from below."""

    upright: bool
    at: float
    text: str


@dataclass(frozen=True, slots=True)
class Plot:
    """Lines, marks and labels over two axes, or a row for each policy over the first.

    Attributes
    ----------
    name : str
        Unique on its page.
    title : str
    height_px : int
    link : str
        Plots of one link are zoomed together along x.
    square : bool
        Whether a unit is as long upwards as sideways, of a plot twice as wide as high.
    caption : str
        The sentence that a reader should take from it.
    shaded : bool
        Whether its rows show levels, on a ground of their own, with the key of their colours.
    """

    name: str
    title: str
    x: Axis
    y: Axis
    lines: Sequence[Line] = ()
    marks: Sequence[Mark] = ()
    labels: Sequence[Label] = ()
    rules: Sequence[Rule] = ()
    height_px: int = 200
    link: str = ""
    square: bool = False
    caption: str = ""
    rows: Sequence[Row] = ()
    shaded: bool = False


@dataclass(frozen=True, slots=True)
class Plots:
    """Plots below each other, or as many beside each other as fit."""

    kind: ClassVar = "plots"
    plots: Sequence[Plot]
    beside: bool = False
    zoom: str = ""


def line_of(ink: Ink, axes: tuple[Axis, Axis], points: tuple[FloatArray, FloatArray]) -> Line:
    """Return a policy's line through points; those without a value are left out."""
    x, y = (np.asarray(values, dtype=np.float64) for values in points)
    known = np.isfinite(x) & np.isfinite(y)
    return Line(ink, path_of(axes[0].place(x[known]), axes[1].place(y[known])))


def path_of(left: FloatArray, below: FloatArray) -> str:
    """Return an SVG path through shares of a plot, in whole units, each after the one before."""
    if not len(left):
        return ""
    x = np.rint(WIDE * left).astype(np.int64)
    y = np.rint(HIGH * (1.0 - below)).astype(np.int64)
    steps = np.column_stack((np.diff(x), np.diff(y)))
    steps = steps[np.any(steps != 0, axis=1)]
    return (
        f"M{x[0]} {y[0]}l" + " ".join(map(str, steps.ravel().tolist()))
        if len(steps)
        else (f"M{x[0]} {y[0]}h1")
    )


def mark_of(ink: Ink, axes: tuple[Axis, Axis], x: float, y: float, name: str) -> Mark:
    """Return a policy's point, with its values in words."""
    words = f"{name}: {axes[0].title} {format_value(x)}; {axes[1].title} {format_value(y)}"
    left, below = (
        round(100.0 * axis.at(value), 3) for axis, value in zip(axes, (x, y), strict=True)
    )
    return Mark(ink, left, below, words)


def label_marks(
    marks: Sequence[Mark], texts: Sequence[str], height_px: int
) -> tuple[list[Label], list[Line]]:
    """Return labels of marks in a column that do not overlap, each led to from its mark.

    Labels keep the order of their marks from below, and as near to them as there is room.
    """
    room = 100.0 * _LABEL_PX / height_px
    order = sorted(range(len(marks)), key=lambda i: (marks[i].below, -marks[i].left, i))
    places = _spread([marks[i].below for i in order], room)
    labels: list[Label] = []
    leaders: list[Line] = []
    for i, place in zip(order, places, strict=True):
        mark = marks[i]
        labels.append(Label(mark.ink, round(place, 2), texts[i]))
        ends = np.array([mark.left, 100.0]) / 100.0, np.array([mark.below, place]) / 100.0
        leaders.append(Line(mark.ink, path_of(*ends), "leader"))
    return labels, leaders


def label_height_px(count: int, least_px: int) -> int:
    """Return a height of a plot that has room for so many labels."""
    return max(least_px, _LABEL_PX * (count + 1))


def _spread(wanted: Sequence[float], room: float) -> list[float]:
    """Return rising places at least `room` apart, within 0 to 100 where they fit."""
    places: list[float] = []
    floor = room / 2
    for want in wanted:
        place = max(want, floor)
        places.append(place)
        floor = place + room
    ceiling = 100.0 - room / 2
    for i in reversed(range(len(places))):
        places[i] = min(places[i], ceiling)
        ceiling = places[i] - room
    return places
