"""Accuracy of levels by hand."""

from collections.abc import Callable

import pytest

from lodbench.models.scene.benefit import level_accuracy, level_primitives
from lodbench.models.scene.levels import LevelTable

MakeLevels = Callable[..., LevelTable]


def test_accuracy_by_hand(make_levels: MakeLevels) -> None:
    """``1 - 0.5 / n``: 0.5 for one triangle, 0.95 for ten, and nothing for an empty level."""
    levels = make_levels([(10, 2, 1, 0)])
    assert level_primitives(levels).tolist() == [10, 2, 1, 0]
    assert level_accuracy(levels).tolist() == [0.95, 0.75, 0.5, 0.0]
    assert level_accuracy(levels, 2.0) == pytest.approx([0.995, 0.875, 0.5, 0.0])
