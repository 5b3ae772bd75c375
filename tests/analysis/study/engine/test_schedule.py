"""Which task is next and which outcomes may be told, on schedules worked by hand."""

from lodbench.analysis.study.engine.schedule import Schedule
from lodbench.analysis.study.engine.task import Failure, Outcome

FAILED = Failure("failed", "broken")


def told(schedule: Schedule, index: int, failure: Failure | None = None) -> list[int]:
    """Return which outcomes are told when this one has come."""
    return [outcome.index for outcome in schedule.finish(Outcome(index, None, failure))]


def test_the_owner_with_most_for_each_process_comes_first() -> None:
    """Of 4 and 3 tasks the first is longer, with a process of its own it has 2 for each."""
    schedule = Schedule(["a"] * 4 + ["b"] * 3, stop=True)
    assert schedule.choose([]) == "a"
    assert schedule.choose(["a"]) == "b"
    assert schedule.choose(["a", "b"]) == "a"
    assert [schedule.take("b") for _ in range(3)] == [4, 5, 6]
    assert schedule.choose(["a", "b", "b"]) == "a"
    assert not schedule.waits("b")


def test_outcomes_of_an_owner_are_told_in_order() -> None:
    """What is finished early waits for what comes before it, of its owner alone."""
    schedule = Schedule(["a", "a", "b", "a"], stop=True)
    assert told(schedule, 3) == []
    assert told(schedule, 2) == [2]
    assert told(schedule, 0) == [0]
    assert told(schedule, 1) == [1, 3]
    assert schedule.finished


def test_the_first_failure_is_that_of_the_lowest_index() -> None:
    """A later failure that comes first drops what is after it, and what was before it counts."""
    schedule = Schedule(["a"] * 5 + ["b"], stop=True)
    for _ in range(4):
        schedule.take("a")
    assert told(schedule, 3, FAILED) == []
    assert not schedule.waits("a")
    assert not schedule.wants(4)
    assert told(schedule, 2) == []
    assert told(schedule, 0) == [0]
    assert told(schedule, 1, FAILED) == [1]
    assert not any(map(schedule.wants, (2, 3, 4)))
    assert told(schedule, 4) == []
    assert not schedule.finished
    assert told(schedule, 5) == [5]
    assert schedule.finished


def test_without_stop_everything_is_told_at_once() -> None:
    """A failure drops nothing."""
    schedule = Schedule(["a"] * 3, stop=False)
    assert told(schedule, 2, FAILED) == [2]
    assert told(schedule, 0) == [0]
    assert schedule.wants(1)
    assert told(schedule, 1) == [1]
    assert schedule.finished


def test_what_was_not_begun_is_given_back_in_order() -> None:
    """Tasks of a process that has gone are next again, unless nobody wants them any more."""
    schedule = Schedule(["a"] * 4, stop=True)
    taken = [schedule.take("a") for _ in range(3)]
    schedule.give_back(taken[1:])
    assert [schedule.take("a") for _ in range(3)] == [1, 2, 3]
    told(schedule, 0, FAILED)
    schedule.give_back([1, 2, 3])
    assert not schedule.waits("a")
