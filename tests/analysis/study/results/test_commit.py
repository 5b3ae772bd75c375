"""Group commit: nothing waits for long, many are written at once, and errors reach the caller."""

import threading
import time
from collections.abc import Sequence

import pytest

from lodbench.analysis.study.results.commit import GROUP, GroupCommit

PATIENCE_S = 30.0


def wait_until_done(commit: GroupCommit[int], count: int) -> None:
    """Return when so many are written, with no call that would hurry them."""
    until = time.monotonic() + PATIENCE_S
    while commit.done < count:
        assert time.monotonic() < until
        time.sleep(0.005)


def test_what_is_added_is_written_without_another_word() -> None:
    """One item, and nobody who flushes."""
    written: list[int] = []
    commit = GroupCommit[int](written.extend)
    commit.add(1)
    wait_until_done(commit, 1)
    assert written == [1]
    commit.close()


def test_a_full_group_waits_for_nobody() -> None:
    """What comes while a group is being written makes the next one."""
    groups: list[list[int]] = []
    held = threading.Event()

    def write(items: Sequence[int]) -> None:
        groups.append(list(items))
        held.wait(PATIENCE_S)

    commit = GroupCommit[int](write)
    for item in range(GROUP):
        commit.add(item)
    while not groups:
        time.sleep(0.001)
    for item in range(GROUP, GROUP + 10):
        commit.add(item)
    assert commit.done == 0
    held.set()
    commit.flush()
    assert commit.done == GROUP + 10
    assert groups[-1] == list(range(GROUP, GROUP + 10))
    commit.close()


def test_flush_and_close_leave_nothing() -> None:
    """All that was added is written when they return, in its order."""
    written: list[int] = []
    commit = GroupCommit[int](written.extend)
    for item in range(5):
        commit.add(item)
    commit.flush()
    assert written == [0, 1, 2, 3, 4]
    commit.add(5)
    commit.close()
    assert written == [0, 1, 2, 3, 4, 5]


def test_an_error_is_raised_where_items_are_added() -> None:
    """It stays: what comes later is not written as if nothing had happened."""

    def refuse(_: Sequence[int]) -> None:
        raise OSError(28, "No space left on device")

    commit = GroupCommit[int](refuse)
    commit.add(1)
    for call in (commit.flush, commit.flush, commit.close):
        with pytest.raises(OSError, match="No space"):
            call()
    with pytest.raises(OSError, match="No space"):
        commit.add(2)
    assert commit.done == 0
