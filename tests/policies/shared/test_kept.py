"""What is kept as long as the candidates stay."""

from collections.abc import Callable
from typing import Any

import numpy as np

from lodbench.policies.shared.kept import Kept
from lodbench.policies.view import View

Make = Callable[..., Any]


def test_a_value_is_made_anew_only_for_other_candidates(make_scene: Make, make_view: Make) -> None:
    """The same ids in another array keep it; fewer, others, and a buffer written anew do not."""
    view: View = make_view(make_scene(np.zeros((4, 3)) - 5.0))
    made: list[list[int]] = []

    def gather(seen: View) -> list[int]:
        made.append(seen.ids.tolist())
        return made[-1]

    kept, buffer = Kept(gather), np.array([0, 1], dtype=np.int32)
    assert kept.of(view.at(buffer)) == [0, 1]
    assert kept.of(view.at(np.array([0, 1], dtype=np.int32))) is made[0]
    buffer[1] = 3
    assert kept.of(view.at(buffer)) == [0, 3]
    assert kept.of(view.at(buffer[:1])) == [0]
    assert kept.of(view.at(buffer[:0])) == []
    assert kept.of(view.at(buffer[:0])) is made[3]
    assert len(made) == 4
