"""Batches by hand: their sizes, what is told when, and what a failure leaves out."""

from lodbench.analysis.study.engine.cluster.batches import Batches
from lodbench.analysis.study.engine.task import Failure, Outcome

FAILED = Failure("failed", "expected a Selection, got None", 0)


def told(batches: Batches, index: int, took_s: float = 0.0, *, fails: bool = False) -> list[int]:
    """Settle one task and return the indices that are told."""
    outcome = Outcome(index, None, FAILED if fails else None, took_s)
    return [outcome.index for outcome in batches.settle(outcome)]


def test_short_tasks_travel_together_and_long_ones_alone() -> None:
    """Batches are to take 0.3 s: 30 tasks of 10 ms, but at most 32, and one of 1 s or unknown."""
    owners = ["quick"] * 1000 + ["slow"] * 1000
    batches = Batches(owners, stop=True)
    assert batches.take(2) == [0]
    assert told(batches, 0, 0.01) == [0]
    assert batches.take(2) == list(range(1, 31))
    for index in range(1, 31):
        told(batches, index, 1e-9)
    assert len(batches.take(2)) == 32
    while (batch := batches.take(2))[0] < 1000:
        pass
    assert batch == [1000]
    told(batches, 1000, 1.0)
    assert batches.take(2) == [1001]


def test_the_last_batches_are_small() -> None:
    """Of 16 short tasks left, 2 slots get 4 at a time at most, then fewer, and each task once."""
    batches = Batches(["a"] * 17, stop=False)
    assert batches.take(2) == [0]
    told(batches, 0, 1e-4)
    sizes, handed = list[int](), [0]
    while batch := batches.take(2):
        sizes.append(len(batch))
        handed += batch
    assert handed == list(range(17))
    assert sizes[0] == 4
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[-1] == 1


def test_outcomes_are_told_in_the_order_of_their_owner() -> None:
    """What is finished early waits for what is before it; another owner's outcomes do not."""
    batches = Batches(["a", "b", "a", "b"], stop=True)
    assert told(batches, 2) == []
    assert told(batches, 1) == [1]
    assert told(batches, 0) == [0, 2]
    assert not batches.finished
    assert told(batches, 3) == [3]
    assert batches.finished


def test_the_first_failure_ends_its_owner_whenever_it_arrives() -> None:
    """Failures at 3 and 1 arrive in either order: 0 and 1 are told, 2 and 3 are not."""
    for order in ([3, 2, 1, 0], [0, 1, 2, 3], [1, 3, 0, 2]):
        batches = Batches(["a"] * 5 + ["b"], stop=True)
        assert [batches.take(1) for _ in range(4)] == [[0], [1], [2], [3]]
        seen: list[int] = []
        for index in order:
            seen += told(batches, index, fails=index in {1, 3})
        assert seen == [0, 1]
        assert not batches.wants([2, 3, 4])
        assert (batches.take(1), batches.take(1)) == ([5], [])
        assert told(batches, 5) == [5]
        assert batches.finished


def test_without_stop_everything_is_told_at_once() -> None:
    """Later tasks of an owner that failed are carried out and told."""
    batches = Batches(["a"] * 3, stop=False)
    assert told(batches, 1, fails=True) == [1]
    assert told(batches, 0) == [0]
    assert batches.wants([2])
    assert told(batches, 2) == [2]
    assert batches.finished


def test_what_was_lost_is_handed_out_again_alone() -> None:
    """A batch that died with its worker comes back one by one, but for what became moot."""
    batches = Batches(["a"] * 6, stop=True)
    told(batches, batches.take(1)[0], 1e-3)
    batch = batches.take(1)
    assert batch == [1, 2]
    told(batches, 2, fails=True)
    batches.put_back(batch)
    assert batches.take(1) == [1]
    assert batches.take(1) == []
    assert told(batches, 1) == [1, 2]
    assert batches.finished
