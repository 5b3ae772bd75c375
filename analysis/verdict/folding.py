"""Policies that did the same, bit by bit, and so take one row."""

from collections.abc import Sequence

from ...base.arrays import FloatArray


def fold_identical(labels: Sequence[str], values: FloatArray) -> dict[str, str]:
    """Return, for each label that is folded away, the label that stands for it.

    Of identical policies the first label in alphabetical order stands for all.

    Parameters
    ----------
    labels : P strings, all different
    values : (P, …) float64
        Every metric of every replicate, by policy; equal bits are equal, so that nan is itself.
    """
    first: dict[bytes, str] = {}
    folded: dict[str, str] = {}
    for label, of in sorted(zip(labels, values, strict=True), key=lambda pair: pair[0]):
        stands = first.setdefault(of.tobytes(), label)
        if stands != label:
            folded[label] = stands
    return folded
