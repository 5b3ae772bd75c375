"""Messages of workers: whole records as they were, and nothing else at all."""

import socket
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench.analysis.study.engine.local.messages import (
    GarbledError,
    Inbox,
    Message,
    Reply,
    encode_reply,
)
from lodbench.base.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Record:
    """A result with everything that a result may hold."""

    name: str
    number: int
    value: float | None
    array: FloatArray
    by_name: dict[str, FloatArray]
    several: tuple[float, ...]


def sent(*parts: Any, most_bytes: int = 10**6) -> list[Message]:
    """Return what an engine reads of these parts, sent in pieces."""
    here, there = socket.socketpair()
    found: list[Message] = []
    inbox = Inbox(most_bytes)
    with here, there:
        here.setblocking(False)
        data = b"".join(bytes(part) for part in parts)
        for at in range(0, len(data), 1000):
            there.sendall(data[at : at + 1000])
            found += inbox.read(here)
    return found


def reply(value: object) -> list[Any]:
    """Return the message of a result."""
    return encode_reply(Reply(7, "result", frame=3), value)


def test_a_record_arrives_as_it_was() -> None:
    """Numbers to the last bit, NaN, whole numbers of any size, arrays of any shape and layout."""
    arrays = {"nan": np.array([np.nan, -0.0, 1e300]), "none": np.zeros((0, 3))}
    table = np.arange(12.0).reshape(3, 4).T
    record = Record("é", 10**40, float(np.nextafter(0.1, 1.0)), table, arrays, (1.0, np.inf))
    (message,) = sent(*reply(record))
    assert (message.reply.task, message.reply.frame) == (7, 3)
    found = message.value(Record)
    assert (found.name, found.number, found.value) == (record.name, record.number, record.value)
    assert found.several == record.several
    assert np.array_equal(found.array, table)
    assert found.array.dtype == np.float64
    for name, array in arrays.items():
        assert found.by_name[name].shape == array.shape
        assert found.by_name[name].tobytes() == array.tobytes()


def test_several_messages_arrive_one_by_one() -> None:
    """One that comes in pieces, or together with the next, is as whole as any."""
    parts = [part for value in range(5) for part in reply(float(value))]
    assert [message.value(float) for message in sent(*parts)] == [0.0, 1.0, 2.0, 3.0, 4.0]


@pytest.mark.parametrize("value", ["text", [1.0], None, {"a": 1.0}])
def test_what_is_of_another_type_is_refused(value: object) -> None:
    """The type of the result decides, not what was sent."""
    (message,) = sent(*reply(value))
    with pytest.raises(Exception, match="Expected"):
        message.value(int)


def test_objects_are_not_sent() -> None:
    """Neither an object nor an array of objects is data."""
    for value in (object(), np.array([object()])):
        with pytest.raises((TypeError, ValueError)):
            reply(value)


@pytest.mark.parametrize(
    "about", [("O", [1], 0), ("<f8", [-1], 0), ("<f8", [10**9], 0), ("<f8", [1], -8), ("x", [1], 0)]
)
def test_arrays_lie_within_their_message(about: tuple[str, list[int], int]) -> None:
    """Objects, sizes below 0 and places outside of what was sent are refused."""
    import msgspec

    value = msgspec.msgpack.Ext(1, msgspec.msgpack.encode(about))
    (message,) = sent(*reply(value), most_bytes=100)
    with pytest.raises((GarbledError, TypeError, ValueError)):
        message.value(FloatArray)


def test_a_size_beyond_the_limit_is_refused() -> None:
    """More than a worker may have cannot be a result of it."""
    sent(*reply(np.zeros(1000)), most_bytes=8000)
    with pytest.raises(GarbledError):
        sent(*reply(np.zeros(1000)), most_bytes=7999)


@settings(max_examples=200, deadline=None, database=None)
@given(data=st.binary(min_size=1, max_size=400), at=st.integers(0, 400))
def test_no_bytes_are_worse_than_garbled(data: bytes, at: int) -> None:
    """Whatever stands in place of what was sent, it is read, or refused as no message."""
    whole = b"".join(bytes(part) for part in reply({"a": np.arange(3.0), "b": 1}))
    try:
        for message in sent(whole[:at] + data + whole[at + len(data) :]):
            message.value(dict[str, Any])
    except (GarbledError, ValueError, TypeError):
        pass
