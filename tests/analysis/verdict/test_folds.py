"""The rotation of paths over training and judging."""

import pytest

from lodbench.analysis.verdict.folds import folds


@pytest.mark.parametrize("n", range(2, 24))
def test_each_path_is_judged_once_and_never_on_itself(n: int) -> None:
    """Judged sets share out the paths, evenly; each training set is the rest."""
    turns = folds(n)
    assert len(turns) == min(n, 5)
    assert sorted(i for turn in turns for i in turn.judge.tolist()) == list(range(n))
    for turn in turns:
        assert sorted(turn.train.tolist() + turn.judge.tolist()) == list(range(n))
    sizes = [len(turn.judge) for turn in turns]
    assert max(sizes) - min(sizes) <= 1


def test_ten_paths_by_hand() -> None:
    """Of ten, each turn trains on eight and judges two: i and i + 5."""
    turns = folds(10)
    assert [turn.judge.tolist() for turn in turns] == [[i, i + 5] for i in range(5)]
    assert {len(turn.train) for turn in turns} == {8}


def test_one_path_trains_on_itself() -> None:
    """A single path has one turn; its caller hands variations to train on."""
    (turn,) = folds(1)
    assert (turn.train.tolist(), turn.judge.tolist()) == ([0], [0])
