"""The first path from above, and where on it each policy did most work."""

import numpy as np

from ....base.arrays import FloatArray
from ..blocks import Paragraph
from ..names import short_name
from ..palette import Ink
from ..plots import Axis, Mark, Plot, Plots, line_of
from ..results import Results, section
from ..series import thinned
from ..values import counted, format_value

_POINTS = 800
_SHARE = 1.12
"""Of the path's extent that the plot shows."""
_ABOUT_S = 0.5
"""Two moments closer than this are about the same place."""


def _in_short(results: Results) -> str:
    """Return when the first of the answer did most work, and how many others did about then."""
    when_s: list[float] = []
    for policy in results.drawn:
        run = results.first_path(policy.label)
        when_s.append(float(run.time_s[run.work_ms.argmax()]))
    near = sum(abs(time_s - when_s[0]) <= _ABOUT_S for time_s in when_s[1:])
    others = counted(len(when_s) - 1, "other policy", "other policies")
    text = f"{results.first.label} did most work {when_s[0]:.2f} s into this path"
    return f"{text}; {near} of {others} within {_ABOUT_S:g} s of it." if near else f"{text}."


@section("The first path from above", takeaway=_in_short)
def from_above(results: Results) -> tuple[Plots] | tuple[Paragraph]:
    """Each point on the camera's way is where a policy did most work; it begins at the grey one."""
    if not results.drawn:
        return (Paragraph("Nothing to draw in this run.", "dim"),)
    log = results.logs[results.drawn[0].label]
    x_m, y_m = thinned(log["x_m"], _POINTS), thinned(log["y_m"], _POINTS)
    axes = _axes(x_m, y_m)
    way = Ink("", "", "")
    marks = [_mark(way, axes, float(x_m[0]), float(y_m[0]), "the path begins here")]
    marks += _worst(results, axes)
    plot = Plot("above", "Seen from above", *axes, [line_of(way, axes, (x_m, y_m))], marks,
                square=True)  # fmt: skip
    return (Plots([plot]),)


def _axes(x_m: FloatArray, y_m: FloatArray) -> tuple[Axis, Axis]:
    """Return axes of one scale about the middle of the path, twice as wide as high."""
    middle = [0.5 * float(at.min() + at.max()) for at in (x_m, y_m)]
    half = 0.5 * _SHARE * max(float(np.ptp(x_m)), 2.0 * float(np.ptp(y_m)), 1.0)
    x, y = middle
    return Axis("east, m", x - half, x + half), Axis("north, m", y - 0.5 * half, y + 0.5 * half)


def _worst(results: Results, axes: tuple[Axis, Axis]) -> list[Mark]:
    """Return where on the first path each policy did most work in what is judged of it."""
    marks: list[Mark] = []
    for policy in results.drawn:
        run = results.first_path(policy.label)
        at = int(run.work_ms.argmax())
        most = f"{format_value(float(run.work_ms[at]))} ms at {run.time_s[at]:.2f} s"
        words = f"{short_name(policy.label)}: {most}"
        place = float(run["x_m"][at]), float(run["y_m"][at])
        marks.append(_mark(results.inks[policy.label], axes, *place, words))
    return marks


def _mark(ink: Ink, axes: tuple[Axis, Axis], x: float, y: float, words: str) -> Mark:
    left, below = (round(100.0 * axis.at(at), 3) for axis, at in zip(axes, (x, y), strict=True))
    return Mark(ink, left, below, words)
