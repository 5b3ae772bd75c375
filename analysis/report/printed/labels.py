"""Names of points in a column beside the axes, a thin line from each to its point."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ....base.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Label:
    """A name, the point it belongs to, and the colour of the line between them."""

    text: str
    x: float
    y: float
    color: str


def label_points(axes: Any, labels: Sequence[Label], apart_in: float) -> None:
    """Write names to the right of axes, in the order of their points, at least so far apart.

    The limits of the axes have to be set.
    """
    if not labels:
        return
    left, right = axes.get_xlim()
    to_share = axes.transData + axes.transAxes.inverted()
    height_in = 0.8 * axes.figure.get_figheight()  # what titles and ticks leave
    # Of points at one height the one further right is named first, so that lines cross less.
    ordered = sorted(labels, key=lambda label: (label.y, -label.x))
    share = to_share.transform([(label.x, label.y) for label in ordered])[:, 1]
    places = spread(np.clip(share, 0.0, 1.0), apart_in / height_in)
    for label, place in zip(ordered, places.tolist(), strict=True):
        axes.annotate(
            label.text, (min(max(label.x, left), right), label.y), xytext=(1.05, place),
            textcoords="axes fraction", va="center", ha="left", fontsize="small",
            annotation_clip=False,
            arrowprops={
                "arrowstyle": "-", "lw": 0.5, "color": label.color, "shrinkA": 1.0, "shrinkB": 2.0,
                "relpos": (0.0, 0.5),
            },
        )  # fmt: skip


def spread(wanted: FloatArray, apart: float) -> FloatArray:
    """Return the places nearest to those wanted, in least squares, that are so far apart.

    Wanted places ascend; those returned do, and begin at 0 or above.  Pools of neighbours that
    would touch share their mean, as in isotonic regression.

    Source: Ayer et al., Annals of Mathematical Statistics 26 (1955), pool adjacent violators.
    """
    steps = apart * np.arange(len(wanted), dtype=np.float64)
    pools: list[tuple[float, int]] = []
    for value in (wanted - steps).tolist():
        mean, count = value, 1
        while pools and pools[-1][0] > mean:
            before, many = pools.pop()
            mean = (before * many + mean * count) / (many + count)
            count += many
        pools.append((mean, count))
    means = np.array([mean for mean, _ in pools], dtype=np.float64)
    fitted = np.repeat(means, [count for _, count in pools])
    return np.maximum(fitted, 0.0) + steps
