"""The frame log: what a replay did, one row a frame, as a struct of arrays.

`TIMES` are int64 nanoseconds of the simulated clock, -1 where a frame never got there (a frame that
mailbox replaced has ``display_ns`` -1).  `COUNTS` are float64.  Both tuples are the schema, in
column order, of the Parquet files that `write_frame_log` makes; behind them logs of trees have a
column of the nodes drawn at each depth, ``drawn_depth_0`` (roots) and so on.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from operator import itemgetter
from struct import Struct
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import FloatArray
from ..base.errors import InputError
from ..base.html_table import html_table
from ..base.predictors import CPU_PREDICTORS, GPU_PREDICTORS
from .level_history import LevelHistory

if TYPE_CHECKING:
    import pyarrow as pa

TIMES = (
    "input_ns",  # the camera was sampled and CPU work began
    "cpu_end_ns",  # submitted to the driver's queue
    "gpu_start_ns",
    "gpu_end_ns",
    "display_ns",
)

UNLOGGED = (
    *("framebuffer_pixels", "objects_culled"),  # the same in every frame at full size
    # Told by others: all that is drawn, its triangles, the logarithm of its number, and triangles
    # less textured ones.
    *("reformed_objects", "reformed_triangles", "reduction_steps", "untextured_triangles"),
)
"""Predictors without a column, which would cost nine bytes a frame each."""

COUNTS = (
    # Of everything drawn, cross-fades included; NaN where the cost model does not charge what takes
    # time to count.
    *(name for name in GPU_PREDICTORS if name not in UNLOGGED),
    "visible",  # objects, or leaves of a tree, in the frustum
    "drawn",  # nodes drawn
    "missing",  # of those visible, how many have nothing drawn for them
    "fading",  # nodes drawn twice because a switch cross-fades
    "full_gpu_ms",  # noise-free GPU time had every candidate been drawn at full detail
    "model_gpu_ms",  # noise-free GPU time of what was drawn
    "predicted_gpu_ms",  # what the policy predicted; NaN if it predicts nothing
    "cpu_ms",  # with noise
    "gpu_ms",  # with noise
    "select_ms",  # part of cpu_ms (noise-free) that the policy's work cost
    *(name for name in CPU_PREDICTORS if name not in (*UNLOGGED, *GPU_PREDICTORS)),
    "toggles",
    "visible_pops",  # switches that change the projected error by `visible_px` or more
    "reversals",
    "popping_px",
    "sse_px_p95",
    "sse_px_max",
    "visible_error_area_px",  # mean over nodes, by area, of their error beyond `visible_px`
    "benefit",
    "full_benefit",
    "benefit_bound",  # most benefit that any selection of this cost can have; NaN if not computed
    "degradation",
    "full_degradation",
    "memory_bytes",  # held when the frame began
    "loaded_bytes",  # read by the loader since the frame before; in the first, what it starts with
    "x_m",
    "y_m",
    "z_m",
)

DEPTH = "drawn_depth_"
"""Begins the names of the columns of nodes drawn by depth."""


@dataclass(frozen=True, slots=True)
class LogHeader:
    """What was replayed.

    Attributes
    ----------
    policy, scene, trace, hardware : names
    budget_ms : float
    seed : int
    display_mode, refresh_hz : screen of the replay
    memory_bound_bytes : loader's or device's memory
    oracle : whether the policy saw the future
    visible_px : least error, and change of error, that is seen
    """

    policy: str
    scene: str
    trace: str
    hardware: str
    budget_ms: float
    seed: int
    display_mode: str
    refresh_hz: float
    memory_bound_bytes: float
    oracle: bool = False
    visible_px: float = 1.0


def _spread(values: NDArray[Any]) -> tuple[float | None, ...]:
    known = values[~np.isnan(values)]
    if not len(known):
        return None, None, None
    return float(known.min()), float(np.median(known)), float(known.max())


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FrameLog:
    """Frames of one replay.

    Attributes
    ----------
    header : LogHeader
    times_ns : (n, len(TIMES)) int64
    counts : (n, len(COUNTS)) float64
    drawn_by_depth : (n, D) int64
        Nodes drawn at each depth of a hierarchy, the roots' first; no columns where there is none.
    levels : LevelHistory or None
        At which level each node was drawn, of the frames from the first; where it was asked for.
    """

    header: LogHeader
    times_ns: NDArray[np.int64]
    counts: FloatArray
    drawn_by_depth: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    levels: LevelHistory | None = None

    def __post_init__(self) -> None:
        n = len(self.times_ns)
        if self.times_ns.shape != (n, len(TIMES)) or self.counts.shape != (n, len(COUNTS)):
            raise InputError(
                f"frame log: expected {len(TIMES)} times and {len(COUNTS)} counts a frame, got "
                f"shapes {self.times_ns.shape} and {self.counts.shape}"
            )
        if self.levels is not None and len(self.levels) > n:
            got = len(self.levels)
            raise InputError(f"frame log: expected levels of at most {n} frames, got {got}")
        by_depth = self.drawn_by_depth.reshape(n, -1 if n else 0)
        object.__setattr__(self, "drawn_by_depth", by_depth)
        by_depth.flags.writeable = False
        self.times_ns.flags.writeable = False
        self.counts.flags.writeable = False

    def __len__(self) -> int:
        """Return the number of frames."""
        return len(self.times_ns)

    def __getitem__(self, column: str) -> NDArray[Any]:
        """Return a column by its name in `columns`, (n,)."""
        if column in _TIME_INDEX:
            return self.times_ns[:, _TIME_INDEX[column]]
        if column.startswith(DEPTH):
            return self.drawn_by_depth[:, int(column.removeprefix(DEPTH))]
        return self.counts[:, _COUNT_INDEX[column]]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns."""
        depths = self.drawn_by_depth.shape[1]
        return TIMES + COUNTS + tuple(f"{DEPTH}{depth}" for depth in range(depths))

    def to_table(self) -> "pa.Table":
        """Return the frames as an Arrow table, one row a frame."""
        import pyarrow as pa

        return pa.table({name: self[name] for name in self.columns})

    def __repr__(self) -> str:
        header = self.header
        return (
            f"<FrameLog of {header.policy} in {header.scene} on {header.trace}, "
            f"{header.hardware}: {len(self)} frames>"
        )

    def _repr_html_(self) -> str:
        rows = [(name, *_spread(self[name])) for name in self.columns]
        return html_table(repr(self)[1:-1], ("column", "least", "median", "most"), rows)


_TIME_INDEX = {name: i for i, name in enumerate(TIMES)}
_COUNT_INDEX = {name: i for i, name in enumerate(COUNTS)}


class CountRows:
    """Rows of `COUNTS` that grow frame by frame, each given in an order that is named once.

    Parameters
    ----------
    names
        What `append` is given, in its order: all of `COUNTS` and `UNLOGGED`.

    Raises
    ------
    KeyError
        If a name is missing or there is none such.
    """

    __slots__ = ("_in_order", "_pack", "_values", "_width")

    def __init__(self, names: Sequence[str]) -> None:
        if wrong := sorted({*COUNTS, *UNLOGGED}.symmetric_difference(names)):
            raise KeyError(*wrong)
        self._values, self._width = bytearray(), len(names)
        self._pack = Struct(f"={len(COUNTS)}d").pack
        # By position and in C: a loop over names would cost more than the frame.
        pick: Any = itemgetter(*map(names.index, COUNTS))
        self._in_order: Callable[[Sequence[float]], tuple[float, ...]] = pick

    def append(self, row: tuple[float, ...]) -> None:
        """Add a frame: its values in the order of the names; ValueError if they are not as many."""
        if len(row) != self._width:
            raise ValueError(f"expected {self._width} values a frame, got {len(row)}")
        self._values += self._pack(*self._in_order(row))

    def table(self) -> FloatArray:
        """Return the rows so far, (n, len(COUNTS))."""
        return np.frombuffer(self._values, dtype=np.float64).reshape(-1, len(COUNTS))
