"""The loader: order, interruption, eviction, its bound and conservation of bytes."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.sim.loader import Loader
from lodbench.sim.pipeline.events import EventQueue

_CHUNK = 100
_BYTES_PER_S = 1e8  # 10 ns a byte, 1,000 ns a chunk
_SEEK_NS = 50


def _loader(sizes: Sequence[int], bound: int) -> tuple[Loader, EventQueue]:
    """Return a loader of nodes of these sizes, node 0 the root, and its clock."""
    loader = Loader(
        np.array(sizes),
        np.array([0]),
        bound,
        bytes_per_s=_BYTES_PER_S,
        latency_ns=_SEEK_NS,
        chunk_bytes=_CHUNK,
    )
    events = EventQueue()
    loader.attach(events)
    return loader, events


def _run(
    loader: Loader, events: EventQueue, lists: dict[int, list[int]]
) -> tuple[dict[int, int], list[tuple[int, list[int]]]]:
    """Hand over wanted lists at times in ns; return when each node was complete, and the states."""
    arrived: dict[int, int] = {}
    states: list[tuple[int, list[int]]] = []

    def hand_over(time_ns: int, _: int) -> None:
        loader.want(time_ns, np.array(lists[time_ns], dtype=np.int32))

    def look(time_ns: int, _: int) -> None:
        assert loader.resident is not None
        states.append((time_ns, np.flatnonzero(loader.resident).tolist()))
        for node in states[-1][1]:
            arrived.setdefault(node, time_ns)

    for time_ns in lists:
        events.schedule(time_ns, 5, hand_over, 0)
    for time_ns in range(0, 20_000, 50):
        events.schedule(time_ns, 9, look, 0)
    events.run()
    return arrived, states


def test_reads_take_a_seek_and_the_bandwidth() -> None:
    """A node of 250 bytes takes one seek of 50 ns and 2,500 ns of reading; the next follows it."""
    loader, events = _loader([10, 250, 100], 1_000)
    arrived, _ = _run(loader, events, {0: [1, 2]})
    assert arrived == {0: 0, 1: 2_550, 2: 3_600}
    assert loader.loaded_bytes == 360
    assert loader.interruptions == 0


def test_higher_priority_interrupts_a_read_that_goes_on_later() -> None:
    """Node 2, wanted first from 1,200 ns on, is read next; node 1 then does not start anew."""
    loader, events = _loader([10, 500, 100], 1_000)
    arrived, _ = _run(loader, events, {0: [1, 2], 1_200: [2, 1]})
    # Chunks of node 1 end at 1,050 and 2,050; node 2 is read until 3,100; three chunks remain.
    assert arrived[2] == 3_100
    assert arrived[1] == 3_100 + _SEEK_NS + 3_000
    assert loader.interruptions == 1
    assert loader.loaded_bytes == 610


def test_lowest_priority_is_evicted_and_never_the_root() -> None:
    """Of three nodes in memory the one that is wanted least makes room, and the root stays."""
    loader, events = _loader([100, 100, 100, 100, 100], 400)
    _, states = _run(loader, events, {0: [1, 2, 3], 5_000: [4, 3, 1, 2]})
    assert states[-1][1] == [0, 1, 3, 4]
    assert loader.evicted_bytes == 100


def test_longest_unwanted_goes_first() -> None:
    """Nodes that have left the list are evicted in the order in which they left it."""
    loader, events = _loader([0, 100, 100, 100, 100], 300)
    _, states = _run(loader, events, {0: [1, 2, 3], 5_000: [2, 3], 6_000: [3], 7_000: [4]})
    assert states[-1][1] == [0, 2, 3, 4]


def test_what_does_not_fit_is_not_read() -> None:
    """The wanted list is served up to the first node that does not fit beside those before it."""
    loader, events = _loader([100, 200, 300, 50], 500)
    _, states = _run(loader, events, {0: [1, 2, 3]})
    assert states[-1][1] == [0, 1]
    assert loader.loaded_bytes == 300


def test_nothing_is_read_after_stop() -> None:
    """The chunk being read when the replay ends is the last."""
    loader, events = _loader([10, 1_000], 2_000)
    loader.want(0, np.array([1]))
    loader.stop()
    events.run()
    assert loader.loaded_bytes == 110
    assert events.now_ns == 1_050


def test_roots_must_fit() -> None:
    """A bound below the roots is refused with the bytes that they need."""
    with pytest.raises(InputError, match="at least the 100 bytes of the roots, got 99"):
        _loader([100, 1], 99)


_LISTS = st.dictionaries(
    st.integers(0, 15_000),
    st.lists(st.integers(0, 7), unique=True),
    max_size=8,
)


@given(
    sizes=st.lists(st.integers(0, 600), min_size=8, max_size=8),
    spare=st.integers(0, 2_000),
    lists=_LISTS,
)
def test_memory_stays_within_its_bound_and_bytes_are_conserved(
    sizes: list[int], spare: int, lists: dict[int, list[int]]
) -> None:
    """At any time: bytes read = bytes held + bytes evicted, and bytes held are within the bound."""
    loader, events = _loader(sizes, sizes[0] + spare)
    checks = 0

    def check(_time_ns: int, _subject: int) -> None:
        nonlocal checks
        assert loader.resident is not None
        held = int(np.array(sizes)[loader.resident].sum())
        assert held <= loader.memory_bytes <= sizes[0] + spare
        assert loader.loaded_bytes == loader.memory_bytes + loader.evicted_bytes
        assert loader.resident[0]
        checks += 1

    for time_ns in range(0, 20_000, 250):
        events.schedule(time_ns, 3, check, 0)
    _run(loader, events, lists)
    assert checks == 80
    if lists:
        wanted = [node for node in lists[max(lists)] if node]
        fits = np.cumsum([sizes[node] for node in wanted]) <= spare
        assert loader.resident is not None
        assert loader.resident[wanted][fits].all()


@given(sizes=st.lists(st.integers(0, 600), min_size=8, max_size=8), lists=_LISTS)
def test_same_lists_give_the_same_reads(sizes: list[int], lists: dict[int, list[int]]) -> None:
    """Two loaders that are told the same are in the same state at every time."""
    runs = [_run(*_loader(sizes, sizes[0] + 900), lists) for _ in range(2)]
    assert runs[0] == runs[1]
