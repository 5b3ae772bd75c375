"""Which objects switch, and when: object by time, coloured by level, for one policy at a time."""

import numpy as np

from ....base.arrays import FloatArray, IntArray
from ....models.scene.scene import Scene
from ....models.scene.tree import relative_depth
from ....sim.frame_log import FrameLog
from ....sim.level_history import HIDDEN, LevelHistory
from ..blocks import Choice, Paragraph
from ..names import short_name
from ..palette import Ink
from ..plots import HIGH, LEVEL_STYLES, WIDE, Axis, Line, Plot, Row
from ..results import Results, section
from ..values import counted
from .along_the_trace import LINK, time_axis

_OBJECTS = 40
_POLICIES = 8
_MOST_STRETCHES = 4_000
"""Stretches of time that one raster draws, about 60 kB: objects with fewer switches go first."""
_ANYBODY = Ink("", "", "")


def _in_short(results: Results) -> str:
    log = results.logs[results.first.label]
    scene, levels = results.scene, log.levels
    if scene is None or levels is None or not len(levels):
        return ""
    count = _switches(levels, scene)
    where = "on this path"
    if len(levels) < len(log):
        where = f"in the first {_end_s(log, levels):.4g} s of this path"
    text = f"Under {results.first.label} {np.count_nonzero(count)} of {len(scene):,} objects switch"
    if not count.any():
        return f"{text} {where}."
    node = int(count.argmax())
    times = counted(int(count[node]), "time")
    return f"{text} {where}; {_name(scene, node)} most often, {times}."


@section("Which objects switch", takeaway=_in_short)
def object_levels(results: Results) -> tuple[Choice | Paragraph, ...]:
    """Each row is an object along the first path, coloured by the level at which it is drawn.

    They are the 40 that switch most under the chosen policy, one of the first 8 of the ranking; the
    number is how often.  Where a row is empty, the object is out of view; of a hierarchy, or
    something coarser or finer is drawn for it.  A row that changes colour at an even beat flickers.
    """
    scene = results.scene
    logs = ((policy.label, results.logs[policy.label]) for policy in results.drawn)
    kept = [(label, log, log.levels) for label, log in logs if log.levels is not None]
    if scene is None or not kept:
        return (Paragraph("The frame logs of this run do not keep levels.", "dim"),)
    x, shades = time_axis(results), _Shades(scene)
    options = [
        (short_name(label), _raster(f"objects-{at}", log, levels, shades, x))
        for at, (label, log, levels) in enumerate(kept[:_POLICIES])
    ]
    return (Choice("objects", "Policy", options),)


class _Shades:
    """Which colour stands for a level of a node."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._coarsest = scene.level_count.astype(np.int64) - 1
        self._by_depth = relative_depth(scene)

    def of(self, node: int, level: IntArray) -> IntArray:
        """Return positions in `LEVEL_STYLES`, coarse to fine.

        Of a node with one level it goes by its depth in the tree.
        """
        last, most = int(self._coarsest[node]), len(LEVEL_STYLES) - 1
        fine = 1.0 - level / last if last else np.full(len(level), self._by_depth[node])
        return np.rint(most * fine).astype(np.int64)

    def words(self, node: int, level: int) -> str:
        """Return what a level of a node is called."""
        last = int(self._coarsest[node])
        return f"level {level} of 0 (finest) to {last}" if last else "drawn"


def _raster(chart: str, log: FrameLog, levels: LevelHistory, shades: _Shades, x: Axis) -> Plot:
    time_s = 1e-9 * log["input_ns"].astype(np.float64)
    count = _switches(levels, shades.scene)
    first = np.argsort(-count, kind="stable")[:_OBJECTS]
    rows: list[Row] = []
    room = _MOST_STRETCHES
    for node in first[count[first] > 0].tolist():
        mine = levels.node == node
        room -= int(np.count_nonzero(mine))
        if room < 0:
            break
        frame, level = levels.frame[mine], levels.level[mine]
        ends = np.append(frame[1:], len(levels) - 1)
        times = x.place(time_s[frame]), x.place(time_s[ends])
        name = _name(shades.scene, node)
        hint = f"{name}: {counted(int(count[node]), 'switch', 'switches')}"
        rows.append(Row(_ANYBODY, f"{name} · {count[node]}", _stretches(node, level, times, shades),
                        hint))  # fmt: skip
    title = (
        f"Levels of the objects that switch most, of {counted(int((count > 0).sum()), 'object')}"
    )
    title += f" that {'switches' if (count > 0).sum() == 1 else 'switch'}"
    if len(levels) < len(log):
        title += f"; the record ends at {_end_s(log, levels):.4g} s, where it is full"
    if not rows:
        title = "No object switches"
    return Plot(chart, title, x, Axis("", 0.0, 0.0), rows=rows, link=LINK, shaded=True)


def _end_s(log: FrameLog, levels: LevelHistory) -> float:
    """Return when the last frame began whose levels are kept."""
    return 1e-9 * float(log["input_ns"][len(levels) - 1])


def _switches(levels: LevelHistory, scene: Scene) -> IntArray:
    """Return how often each node switches, (N,)."""
    return np.bincount(levels.node[levels.switches(scene)], minlength=len(scene))


def _name(scene: Scene, node: int) -> str:
    return f"{short_name(scene.types.names[int(scene.type_index[node])])} {node}"


def _stretches(
    node: int, level: IntArray, times: tuple[FloatArray, FloatArray], shades: _Shades
) -> list[Line]:
    """Return a line for each level at which a node is drawn, of all stretches at that level."""
    left, right = (np.rint(WIDE * at).astype(np.int64) for at in times)
    lines: list[Line] = []
    for one in np.unique(level[level != HIDDEN]).tolist():
        style = LEVEL_STYLES[int(shades.of(node, np.array([one]))[0])]
        path, end = "", 0
        for a, b in zip(left[level == one].tolist(), right[level == one].tolist(), strict=True):
            path += f"{f'm{a - end} 0' if path else f'M{a} {HIGH // 2}'}h{max(b - a, 1)}"
            end = a + max(b - a, 1)
        lines.append(Line(_ANYBODY, path, style, shades.words(node, one)))
    return lines
