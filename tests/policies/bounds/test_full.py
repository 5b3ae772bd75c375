"""Full detail in every kind of scene."""

from collections.abc import Callable

import pytest

from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.bounds.full import Full
from lodbench.policies.view import View


@pytest.mark.parametrize(
    ("continuous", "expected"), [(False, [0, 0]), (True, [1, 1]), ([True, False], [1, 0])]
)
def test_full_is_level_0_or_resolution_1(
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., LevelTable],
    make_view: Callable[..., View],
    continuous: bool | list[bool],
    expected: list[int],
) -> None:
    """Discrete nodes are drawn at level 0 and continuous ones at resolution 1."""
    levels = make_levels([(10, 5), (10, 5)], continuous=continuous)
    view = make_view(make_scene([(0.0, 0.0, -10.0)] * 2, kind=[0, 1], levels=levels))
    selection = Full().select(view)
    assert selection.ids is view.ids
    assert selection.detail.tolist() == expected
