"""Identical policies take one row."""

import numpy as np

from lodbench.analysis.verdict.folding import fold_identical


def test_equal_bits_fold_to_the_first_label() -> None:
    """Three alike fold to the first by the alphabet, whatever the order of the input."""
    row = np.array([1.0, 2.0, np.nan])
    values = np.array([row, row, row, row])
    values[1, 0] = np.nextafter(1.0, 2.0)
    assert fold_identical(["c", "x", "a", "b"], values) == {"b": "a", "c": "a"}
    back = [3, 2, 1, 0]
    labels = ["b", "a", "x", "c"]
    assert fold_identical(labels, values[back]) == {"b": "a", "c": "a"}


def test_different_policies_stay() -> None:
    """Equality in one of two metrics is none."""
    values = np.array([[[1.0], [2.0]], [[1.0], [3.0]]])
    assert fold_identical(["a", "b"], values) == {}
