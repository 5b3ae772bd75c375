"""The event queue: order in time, and of events at the same time."""

from itertools import islice

from hypothesis import given
from hypothesis import strategies as st

from lodbench.sim.pipeline.events import EventQueue


def test_simultaneous_events_run_by_priority_then_by_order_of_scheduling() -> None:
    """At one time the smallest priority runs first, and equals in the order they came."""
    queue, ran = EventQueue(), list[int]()
    for subject, (time_ns, priority) in enumerate([(5, 2), (5, 0), (3, 9), (5, 0), (5, 1)]):
        queue.schedule(time_ns, priority, lambda _, subject: ran.append(subject), subject)
    assert len(queue) == 5
    queue.run()
    assert ran == [2, 1, 3, 4, 0]
    assert len(queue) == 0


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 2)), min_size=1, max_size=60))
def test_the_clock_never_runs_backward(steps: list[tuple[int, int]]) -> None:
    """Handlers that schedule more events see times that only grow, and none is lost."""
    queue, seen = EventQueue(), list[int]()
    left = iter(steps)

    def handler(time_ns: int, _subject: int) -> None:
        assert queue.now_ns == time_ns
        seen.append(time_ns)
        for delay, priority in islice(left, 1):
            queue.schedule(time_ns + delay, priority, handler, 0)

    for start in (0, 3):
        queue.schedule(start, 0, handler, 0)
    queue.run()
    assert seen == sorted(seen)
    assert len(seen) == 2 + len(steps)
