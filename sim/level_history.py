"""At which level each node was drawn over a replay, as changes from frame to frame.

What is drawn where is not in the columns of a frame log, which are of whole frames.  It is kept of
the replays that people look at, by an observer that costs nothing where nobody asks.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import FloatArray, IntArray
from ..base.errors import InputError
from ..models.scene.camera import Camera
from ..models.scene.scene import Scene
from .accounting.switches import Drawn

HIDDEN = -1
"""The level of a node that is not drawn."""

MOST_CHANGES = 1_000_000
"""Changes that one history holds, 6 MB: frames behind them are left out, and counted."""


@dataclass(frozen=True, slots=True, eq=False)
class LevelHistory:
    """Levels of N nodes in the first n frames of a replay; before the first all are `HIDDEN`.

    A level counts from 0, the finest.  That of a continuous node is the knot which its resolution
    has passed, as toggles are counted (`accounting.switches`); of two levels that cross-fade it is
    the new one.

    Attributes
    ----------
    start : (n + 1,) int64
        Frame k has the changes ``start[k]`` to ``start[k + 1]``; their nodes ascend.
    node : (c,) int32
    level : (c,) int16
        The level at which the node is drawn from then on, or `HIDDEN`.
    turn_xyzw : (n, 4) float64
        Orientation of the camera in each frame, as `Camera` has it.
    """

    start: NDArray[np.int64]
    node: NDArray[np.int32]
    level: NDArray[np.int16]
    turn_xyzw: FloatArray

    def __post_init__(self) -> None:
        frames, changes = len(self.start) - 1, len(self.node)
        rises = frames >= 0 and self.start[0] == 0 and bool((np.diff(self.start) >= 0).all())
        if not rises or self.start[-1] != changes or len(self.level) != changes:
            raise InputError("levels: expected as many nodes as levels and starts that rise, got "
                             f"{changes} nodes, {len(self.level)} levels")  # fmt: skip
        if self.turn_xyzw.shape != (frames, 4) or not np.isfinite(self.turn_xyzw).all():
            got = self.turn_xyzw.shape
            raise InputError(f"levels turn_xyzw: expected ({frames}, 4) finite values, got {got}")
        if changes > MOST_CHANGES or (changes and (self.node.min() < 0 or self.level.min() < -1)):
            raise InputError(f"levels: expected at most {MOST_CHANGES:,} changes of nodes from 0 "
                             f"to levels from {HIDDEN}, got others")  # fmt: skip
        for array in (self.start, self.node, self.level, self.turn_xyzw):
            array.flags.writeable = False

    def __len__(self) -> int:
        """Return the number of frames that are kept."""
        return len(self.start) - 1

    @property
    def frame(self) -> NDArray[np.int64]:
        """The frame of each change, (c,)."""
        return np.repeat(np.arange(len(self)), np.diff(self.start))

    def at(self, frame: int, nodes: int) -> NDArray[np.int16]:
        """Return the level of each of so many nodes in a frame that is kept, (nodes,)."""
        past = int(self.start[frame + 1])
        level = np.full(nodes, HIDDEN, dtype=np.int16)
        level[self.node[:past]] = self.level[:past]  # of several changes of a node, the last
        return level

    def before(self) -> NDArray[np.int16]:
        """Return the level of each change's node just before it, (c,)."""
        order = np.argsort(self.node, kind="stable")  # of each node, by frame
        level, again = self.level[order], self.node[order][1:] == self.node[order][:-1]
        earlier = np.full(len(level), HIDDEN, dtype=np.int16)
        earlier[1:][again] = level[:-1][again]
        found = np.empty_like(earlier)
        found[order] = earlier
        return found

    def switches(self, scene: Scene) -> NDArray[np.bool_]:
        """Return which changes are switches of level, (c,): coming into view is none.

        A node switches that is drawn at another level than in the frame before.  One of a tree also
        does where it takes the place of its parent or children, or they its own; and where it comes
        or goes below a parent that stays drawn (3D Tiles' ADD).
        """
        before, frame = self.before(), self.frame
        found = (before != HIDDEN) & (self.level != HIDDEN)
        if scene.flat or not len(frame):
            return found
        parent, nodes = scene.parent[self.node].astype(np.int64), len(scene)
        comes, goes = before == HIDDEN, self.level == HIDDEN
        own, above = frame * nodes + self.node, frame * nodes + parent
        child = parent >= 0
        for these, those in ((comes, goes), (goes, comes)):
            found |= these & child & np.isin(above, own[those])
            found |= these & np.isin(own, above[those & child])
        return found | (child & (comes | goes) & scene.additive[parent])

    def require_nodes(self, scene: Scene) -> None:
        """Raise `InputError` unless its nodes and levels are those of a scene."""
        if not len(self.node):
            return
        known = self.node < len(scene)
        if not known.all() or (self.level >= scene.level_count[self.node]).any():
            raise InputError(
                f"levels: expected nodes and levels of {scene.name}, {len(scene)} nodes, got "
                "others; run `lodbench compare` again"
            )


class LevelRecorder:
    """Takes down what each frame of a replay draws."""

    def __init__(self, scene: Scene) -> None:
        self._finest_row = scene.finest_row
        self._level = np.full(len(scene), HIDDEN, dtype=np.int16)
        self._ids: IntArray | None = None
        self._row: IntArray | None = None
        self._start, self._turns = [0], bytearray()
        self._nodes, self._levels = bytearray(), bytearray()
        self._full = False

    def record(self, drawn: Drawn, camera: Camera) -> None:
        """Keep what changed since the frame before, as long as there is room."""
        if self._full:
            return
        changes = self._start[-1]
        if drawn.at is not self._ids or drawn.row is not self._row:
            self._ids, self._row = drawn.at, drawn.row
            level = np.full(len(self._level), HIDDEN, dtype=np.int16)
            level[drawn.at] = drawn.row - self._finest_row[drawn.at]
            changed = np.flatnonzero(level != self._level)
            changes += len(changed)
            if changes > MOST_CHANGES:
                self._full = True
                return
            self._level = level
            self._nodes += changed.astype(np.int32).tobytes()
            self._levels += level[changed].tobytes()
        self._start.append(changes)
        self._turns += np.array(camera.orientation_xyzw, dtype=np.float64).tobytes()

    def history(self) -> LevelHistory:
        """Return what was recorded so far."""
        return LevelHistory(
            np.array(self._start, dtype=np.int64),
            np.frombuffer(bytes(self._nodes), dtype=np.int32),
            np.frombuffer(bytes(self._levels), dtype=np.int16),
            np.frombuffer(bytes(self._turns), dtype=np.float64).reshape(-1, 4),
        )
