"""Messages between an engine and its workers.

A worker is trusted with code: a task is a pickle.  An engine trusts nothing that comes back, since
a policy could have written it: a reply is numbers, text and arrays, checked by length and type, and
reading it runs none of its code.
"""

import math
import socket
import struct
from collections.abc import Iterator
from typing import Any

import msgspec
import numpy as np

_HEADER = struct.Struct("<4sIQ")
_MAGIC = b"LODB"
_ALIGNMENT = 64
_ARRAY = 1  # code of msgpack's extension
_AT_ONCE_BYTES = 2**20
_MOST_HEAD_BYTES = 2**28


class Reply(msgspec.Struct, array_like=True):
    """What became of a task, before its value is decoded.

    Attributes
    ----------
    task : int
    kind : "result", "failed", "not-applicable" or "input", as a task can end
    value : the encoded result; None by default
    reason : of a failure
    frame : the last that was begun, or the one that failed
    path, line : of an `InputError`
    took_s, peak_bytes : see `Outcome`
    """

    task: int
    kind: str
    value: msgspec.Raw = msgspec.Raw(b"\xc0")
    reason: str = ""
    frame: int | None = None
    path: str | None = None
    line: int | None = None
    took_s: float = 0.0
    peak_bytes: int = 0


class GarbledError(Exception):
    """What a worker sent is no reply."""


class _Arrays:
    """Arrays of a value, which follow it as they are: a long frame log is copied nowhere."""

    def __init__(self) -> None:
        self.parts: list[Any] = []
        self.size = 0

    def put(self, given: object) -> object:
        """Take an array out of a value; return what stands in its place."""
        value: Any = given  # an untyped edge: what the checks find it to be
        if isinstance(given, np.generic):
            return value.item()
        if not isinstance(given, np.ndarray):
            raise TypeError(f"expected numbers, text and arrays, got {type(given).__name__}")
        array: Any = np.ascontiguousarray(value)
        about = msgspec.msgpack.encode((array.dtype.str, value.shape, self.size))
        pad = bytes(-array.nbytes % _ALIGNMENT)
        self.parts += [array.reshape(-1).view(np.uint8).data, pad]
        self.size += array.nbytes + len(pad)
        return msgspec.msgpack.Ext(_ARRAY, about)


def encode_reply(reply: Reply, value: object = None) -> list[Any]:
    """Return the parts of a message, to be sent one after the other.

    Raises TypeError if the value is no number, text, array, or record or collection of these.
    """
    arrays = _Arrays()
    encoder = msgspec.msgpack.Encoder(enc_hook=arrays.put)
    try:
        reply.value = msgspec.Raw(encoder.encode(value))
    except OverflowError:  # a seed beyond 64 bits
        arrays = _Arrays()
        plain: Any = msgspec.to_builtins(value, builtin_types=(np.ndarray, np.generic))
        encoder = msgspec.msgpack.Encoder(enc_hook=arrays.put)
        reply.value = msgspec.Raw(encoder.encode(_short(plain)))
    head = msgspec.msgpack.encode(reply)
    return [_HEADER.pack(_MAGIC, len(head), arrays.size), *arrays.parts, head]


def _short(given: object) -> Any:
    """Return a value in which whole numbers of more than 64 bits are text, as the decoder reads."""
    value: Any = given
    if isinstance(given, int) and not -(2**63) <= given < 2**64:
        return str(given)
    if isinstance(given, dict):
        return {key: _short(item) for key, item in value.items()}
    return [_short(item) for item in value] if isinstance(given, (list, tuple)) else value


class Message:
    """A message that has come whole.

    Attributes
    ----------
    reply : Reply
    """

    def __init__(self, data: memoryview, body_bytes: int) -> None:
        self._body = data[:body_bytes]
        self.reply = msgspec.msgpack.decode(data[body_bytes:], type=Reply)

    def value(self, kind: Any) -> Any:
        """Return the result, which is of the type given; raises an exception if it is not."""

        def array(code: int, about: memoryview) -> Any:
            if code != _ARRAY:
                raise GarbledError
            name, shape, offset = msgspec.msgpack.decode(about, type=tuple[str, list[int], int])
            dtype = np.dtype(name)
            if dtype.kind not in "biuf" or min((offset, *shape)) < 0:
                raise GarbledError
            return np.frombuffer(self._body, dtype, math.prod(shape), offset).reshape(shape)

        decoder = msgspec.msgpack.Decoder(kind, ext_hook=array, strict=False)
        return decoder.decode(self.reply.value)


class Inbox:
    """What a worker has sent so far."""

    def __init__(self, most_bytes: int) -> None:
        self._most_bytes = most_bytes
        self._restart()

    def _restart(self) -> None:
        self._data = memoryview(bytearray(_HEADER.size))
        self._at, self._body_bytes = 0, -1

    def read(self, channel: socket.socket) -> Iterator[Message]:
        """Yield messages that are whole, without waiting for more.

        Raises EOFError if there will be no more, and `GarbledError` if it is no message.
        """
        for _ in range(256):  # other workers are waiting too
            wanted = self._data[self._at : self._at + _AT_ONCE_BYTES]
            try:
                count = channel.recv_into(wanted)
            except BlockingIOError:
                return
            except OSError:
                count = 0
            if not count:
                raise EOFError
            self._at += count
            if self._at == len(self._data):
                message = self._whole()
                if message is not None:
                    yield message

    def _whole(self) -> Message | None:
        if self._body_bytes >= 0:
            data, size = self._data, self._body_bytes
            self._restart()
            try:
                return Message(data, size)
            except msgspec.DecodeError as error:
                raise GarbledError from error
        magic, head_bytes, body_bytes = _HEADER.unpack(self._data)
        fits = 0 < head_bytes <= _MOST_HEAD_BYTES and body_bytes <= self._most_bytes
        if magic != _MAGIC or not fits:
            raise GarbledError
        # Not filled: memory that a policy announces and never sends is never used.
        self._data = np.empty(head_bytes + body_bytes, dtype=np.uint8).data
        self._at, self._body_bytes = 0, body_bytes
        return None


def frame_task(task: int, data: bytes) -> bytes:
    """Return the message that hands a worker a pickle; a task of -1 is what it starts with."""
    return struct.pack("<qQ", task, len(data)) + data


def receive_task(channel: socket.socket) -> tuple[int, memoryview] | None:
    """Wait for a message of `frame_task` and return it; None if there will be no more."""
    head = _receive(channel, 16)
    if head is None:
        return None
    task, size = struct.unpack("<qQ", head)
    data = _receive(channel, size)
    return None if data is None else (task, data)


def _receive(channel: socket.socket, size: int) -> memoryview | None:
    data = memoryview(bytearray(size))
    at = 0
    while at < size:
        count = channel.recv_into(data[at:])
        if not count:
            return None
        at += count
    return data
