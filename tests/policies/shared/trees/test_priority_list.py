"""The priority list against sorting, and what it counts."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from lodbench.policies.shared.trees.priority_list import PriorityList

ALL = np.ones(6, dtype=bool)


def test_counts_one_comparison_a_node_and_one_a_place_moved() -> None:
    """A list in order costs its length; two neighbours that change places cost two more."""
    nodes = PriorityList()
    nodes.update(ALL, np.array([6.0, 5.0, 4.0, 3.0, 2.0, 1.0]))
    assert nodes.comparisons == 6
    nodes.update(ALL, np.array([6.0, 4.5, 5.0, 3.0, 2.0, 1.0]))
    assert nodes.ids.tolist() == [0, 2, 1, 3, 4, 5]
    assert nodes.comparisons == 8


def test_new_nodes_come_from_behind() -> None:
    """A node that enters at the end moves no other; the old ones keep their order."""
    nodes = PriorityList()
    first = np.array([True, True, True, True, False, False])
    priority = np.array([4.0, 3.0, 6.0, 5.0, 2.0, 1.0])
    nodes.update(first, priority)
    nodes.update(ALL, priority)
    assert nodes.ids.tolist() == [2, 3, 0, 1, 4, 5]
    assert nodes.comparisons == 6


@given(
    frames=st.lists(
        st.lists(st.tuples(st.booleans(), st.integers(0, 9)), min_size=12, max_size=12),
        min_size=1,
        max_size=5,
    )
)
def test_always_sorted_and_never_cheaper_than_an_insertion_sort(
    frames: list[list[tuple[bool, int]]],
) -> None:
    """After any sequence of frames: the listed nodes, falling, at no less than n + inversions."""
    nodes = PriorityList()
    for frame in frames:
        listed = np.array([shown for shown, _ in frame])
        priority = np.array([float(value) for _, value in frame])
        stay = [i for i in nodes.ids.tolist() if listed[i]]
        before = stay + [i for i in np.flatnonzero(listed).tolist() if i not in stay]
        nodes.update(listed, priority)
        assert sorted(nodes.ids.tolist()) == np.flatnonzero(listed).tolist()
        assert (np.diff(priority[nodes.ids]) <= 0).all()
        inversions = sum(
            priority[a] < priority[b] for i, a in enumerate(before) for b in before[i + 1 :]
        )
        assert nodes.comparisons >= len(before) + inversions
