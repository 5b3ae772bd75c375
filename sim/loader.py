"""The loader: which nodes of a hierarchy are in memory, read from a disk as events on the clock.

Reads are incremental, as in the HLOD thesis (section 4.3): a node is read in chunks, and between
two chunks the wanted list is looked at again, so that a node of higher priority interrupts a read,
which keeps what it has and goes on later.  What has the lowest priority is evicted to make room.
Roots are in memory from the start and stay.
"""

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import BoolArray, FloatArray, IntArray
from ..base.errors import InputError
from ..base.predictors import LEVEL_PREDICTORS
from ..models.machine.hardware import HardwareProfile
from ..models.scene.scene import Scene
from ..policies.selection import Selection
from ..policies.view import View
from .pipeline.events import EventQueue

CHUNK_BYTES = 65_536
"""Bytes of one incremental read: a third of a millisecond at 200 MB/s."""

_TEXTURE_BYTES = LEVEL_PREDICTORS.index("texture_bytes")
_PRIORITY = 1  # before the CPU: a frame that begins in the nanosecond a chunk arrives has it


class Memory:
    """What the replay asks of memory; this one holds everything from the start.

    Attributes
    ----------
    resident : (N,) bool or None
        Nodes whose data are complete in memory; None if all are.
    memory_bytes, loaded_bytes : int
        Bytes held now, and bytes read from the disk since the start.
    """

    def __init__(self, memory_bytes: int) -> None:
        self.resident: BoolArray | None = None
        self.memory_bytes, self.loaded_bytes = memory_bytes, 0

    def attach(self, events: EventQueue) -> None:
        """Read on this clock."""

    def want(self, time_ns: int, wanted: IntArray | None) -> None:
        """Take a new list of nodes to have in memory, by falling priority; None keeps the last."""

    def stop(self) -> None:
        """Begin no further read."""


def make_memory(
    scene: Scene, hardware: HardwareProfile, bound_bytes: float, *, streaming: bool
) -> Memory:
    """Return the memory of a replay: bounded behind a loader if streaming, else unbounded.

    A node's bytes are those of all levels of its type, in a tree with their textures, which are the
    node's own there; two nodes of one type are read separately.

    Raises `InputError` if the roots do not fit the bound.
    """
    levels = scene.types.levels
    if not streaming:
        return Memory(round(float(level_bytes(scene).sum())))
    type_bytes = np.add.reduceat(level_bytes(scene), levels.start[:-1])
    node_bytes = np.ceil(type_bytes[scene.type_index]).astype(np.int64)
    return Loader(
        node_bytes,
        scene.roots,
        int(bound_bytes),
        bytes_per_s=hardware.disk_bytes_per_s,
        latency_ns=round(hardware.disk_latency_ms * 1e6),
    )


def level_bytes(scene: Scene) -> FloatArray:
    """Return what each level takes in memory, (L,).

    Levels of flat scenes share one texture, which no level of detail takes less of.
    """
    levels = scene.types.levels
    return levels.bytes if scene.flat else levels.bytes + levels.counts[:, _TEXTURE_BYTES]


def find_not_resident(selection: Selection, view: View) -> str | None:
    """Return why a selection breaks its contract by what is not in memory, or None.

    What stands outside the frustum is not drawn and need not be there.
    """
    resident = view.state.residency
    if resident is None:
        return None
    absent = view.state.inside[selection.ids] & ~resident[selection.ids]
    if not absent.any():
        return None
    return f"ids: expected nodes in memory, got node {int(selection.ids[absent.argmax()])}"


class Loader(Memory):
    """Memory that never exceeds a bound, filled by one reader of a disk.

    The longest prefix of the wanted list that fits beside the roots is the target.  Its missing
    nodes are read in order; the rest of memory is kept until room is needed, and then goes from the
    lowest priority up, where a node no longer wanted stands below all that are, the longest
    unwanted last.  A chunk takes its memory, and counts as loaded, when its read begins, so that
    ``loaded = held + evicted`` at any time.  A node evicted while the GPU still draws it is gone
    at once, as if its frame had copied it.

    Attributes
    ----------
    resident : (N,) bool, read-only
    memory_bytes, loaded_bytes, evicted_bytes : int
    interruptions : int
        Reads suspended for a node of higher priority.
    """

    def __init__(
        self,
        node_bytes: NDArray[np.int64],
        roots: IntArray,
        bound_bytes: int,
        *,
        bytes_per_s: float,
        latency_ns: int,
        chunk_bytes: int = CHUNK_BYTES,
    ) -> None:
        n = len(node_bytes)
        self._bytes, self._bound = node_bytes, bound_bytes
        self._disk = (bytes_per_s, latency_ns, chunk_bytes)
        self._pinned = np.zeros(n, dtype=np.bool_)
        self._pinned[roots] = True
        self._held = np.where(self._pinned, node_bytes, 0)
        self._complete = self._held == node_bytes
        super().__init__(int(self._held.sum()))
        self.loaded_bytes = self.memory_bytes
        resident = self._complete.view()
        resident.flags.writeable = False
        self.resident = resident
        self._rank = np.full(n, n, dtype=np.int64)  # 0 is the highest priority
        self._target = np.zeros(n, dtype=np.bool_)
        self._pending: list[int] = []  # missing nodes of the target, the next to read last
        self._victims: list[int] | None = None  # to evict, the first last; None until needed
        self._reading: int = -1
        self._in_flight = self._stopped = False
        self._events = EventQueue()
        self.evicted_bytes = self.interruptions = 0
        if self.memory_bytes > bound_bytes:
            raise InputError(
                f"memory: expected at least the {self.memory_bytes} bytes of the roots, got "
                f"{bound_bytes}; raise the bound or give the scene coarser roots"
            )

    def attach(self, events: EventQueue) -> None:
        """Read on this clock."""
        self._events = events

    def want(self, time_ns: int, wanted: IntArray | None) -> None:
        """Take a new list of nodes to have in memory, by falling priority; None keeps the last."""
        if wanted is None:
            return
        self._rank += len(self._rank)
        self._rank[wanted] = np.arange(len(wanted))
        others = wanted[~self._pinned[wanted]]
        room = self._bound - int(self._bytes[self._pinned].sum())
        target = others[np.cumsum(self._bytes[others]) <= room]
        self._target[:] = self._pinned
        self._target[target] = True
        self._pending = target[~self._complete[target]][::-1].tolist()
        self._victims = None
        if not self._in_flight:
            self._read_on(time_ns)

    def stop(self) -> None:
        """Begin no further read."""
        self._stopped = True

    def _read_on(self, time_ns: int) -> None:
        if self._stopped or not self._pending:
            return
        node = self._pending[-1]
        bytes_per_s, latency_ns, chunk_bytes = self._disk
        seek_ns = 0
        if node != self._reading:
            if self._reading >= 0 and not self._complete[self._reading]:
                self.interruptions += 1
            self._reading, seek_ns = node, latency_ns
        size = min(chunk_bytes, int(self._bytes[node] - self._held[node]))
        self._make_room(size)
        self._held[node] += size
        self.memory_bytes += size
        self.loaded_bytes += size
        self._in_flight = True
        end_ns = time_ns + seek_ns + max(1, round(size / bytes_per_s * 1e9))
        self._events.schedule(end_ns, _PRIORITY, self._chunk_read, node)

    def _chunk_read(self, time_ns: int, node: int) -> None:
        self._in_flight = False
        if self._held[node] == self._bytes[node]:
            self._complete[node] = True
            if self._pending and self._pending[-1] == node:
                self._pending.pop()
            elif node in self._pending:
                self._pending.remove(node)
        self._read_on(time_ns)

    def _make_room(self, size: int) -> None:
        if self.memory_bytes + size <= self._bound:
            return
        if self._victims is None:
            spare = np.flatnonzero((self._held > 0) & ~self._target)
            self._victims = [int(i) for i in spare[np.argsort(self._rank[spare], kind="stable")]]
        victims = self._victims
        while self.memory_bytes + size > self._bound:
            # The target fits the bound, so that there is something else to evict.
            node = victims.pop()
            held = int(self._held[node])
            self.memory_bytes -= held
            self.evicted_bytes += held
            self._held[node] = 0
            self._complete[node] = False
            if node == self._reading:
                self._reading = -1
