"""What each frame of a replay draws, costs and shows: counted, timed, and logged by name."""

import math

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import FloatArray
from ..base.errors import PolicyError
from ..base.predictors import GPU_PREDICTORS
from ..models.machine.cost import CostModel
from ..models.machine.cost_terms.term import LevelChanges
from ..models.machine.frame_cost import FrameCost
from ..models.scene.scene import Scene
from ..models.scene.tree import Tree
from ..policies.selection import Selection
from ..policies.view import View
from .accounting.accounting import Accounting, Tally
from .accounting.benefit_bound import BenefitBound
from .accounting.extraction import Extraction, IndexSets
from .accounting.first_uses import FirstUses
from .accounting.fronts import Fronts
from .accounting.holes import Holes, only, with_missing
from .accounting.picture_quality import FlatQuality, TreeQuality
from .accounting.screen_errors import ScreenErrors
from .accounting.switches import Drawn
from .frame_log import CountRows
from .level_history import LevelRecorder
from .loader import Memory
from .machine.simulated_machine import Machine, Submitted
from .replay_options import ReplayOptions
from .sight import Sight

_NS_PER_MS = 1e6

_PREDICTORS: tuple[str, ...] = (
    *GPU_PREDICTORS,
    "objects_visited",
    "comparisons",
    "iterations",
    "levels_extracted",
    "triangles_changed",
    "levels_borrowed",
    "objects_culled",
)

_ROW = (
    *_PREDICTORS,
    "fading",
    "model_gpu_ms",
    "predicted_gpu_ms",
    "cpu_ms",
    "gpu_ms",
    "select_ms",
    "toggles",
    "reversals",
    "popping_px",
    "visible_pops",
    "memory_bytes",
    "loaded_bytes",
    "visible",
    "drawn",
    "missing",
    "full_gpu_ms",
    "sse_px_p95",
    "sse_px_max",
    "visible_error_area_px",
    "benefit",
    "full_benefit",
    "benefit_bound",
    "degradation",
    "full_degradation",
    "x_m",
    "y_m",
    "z_m",
)  # what `FrameRecorder.record` writes of a frame, in its order


class FrameRecorder:
    """Keeps the accounts of one replay, under the cost model that is true there.

    Attributes
    ----------
    last_detail : (N,) float64
        Detail at which each node was last drawn; NaN if never.
    """

    def __init__(
        self,
        scene: Scene,
        tree: Tree | None,
        truth: CostModel,
        options: ReplayOptions,
        sight: Sight,
        machine: Machine,
        memory: Memory,
        *,
        policy: str,
        future: bool,
        levels: LevelRecorder | None,
    ) -> None:
        costs = FrameCost(truth, scene.types.levels)
        self._accounting = Accounting(
            scene,
            costs,
            round(options.crossfade_ms * _NS_PER_MS),
            sight.first,
            options.visible_px,
            sight.cameras,
        )
        self._fronts = (
            None if tree is None else Fronts(tree, self._accounting.viewport_px, options.visible_px)
        )
        self._quality = FlatQuality(scene) if tree is None else TreeQuality(tree)
        self._errors = ScreenErrors(options.visible_px)
        self._bound = BenefitBound(scene, costs, 1 if future else options.bound_every)
        self._index_sets, self._first_uses = IndexSets(scene), FirstUses(scene.types.levels)
        self._holes = Holes(scene)
        self._machine, self._memory, self._policy = machine, memory, policy
        self._players = sight.players
        self._loaded_bytes = 0
        self._depth = None if tree is None else tree.depth
        self._depths = 0 if tree is None else int(tree.depth.max()) + 1
        self._by_depth = bytearray()  # of int64, a row a frame
        self._rows, self._levels = CountRows(_ROW), levels
        self.last_detail = self._accounting.switches.detail

    def record(
        self,
        view: View,
        selection: Selection,
        *,
        repeats: bool,
        changed: NDArray[np.intp] | None,
    ) -> tuple[int, int]:
        """Record a frame that draws a valid selection; return nanoseconds of CPU and GPU.

        `repeats` says that it is the same nodes at the same details as in the frame before, and
        `changed` where details are not those last drawn, if that is known (`SelectionCheck`).

        Raises
        ------
        PolicyError
            If a node borrows from a holder whose index set has another resolution.
        """
        accounting = self._accounting
        if self._fronts is not None:
            selection = only(selection, view.state.inside[selection.ids])
        if self._holes.any:
            # Of other nodes than the policy's, of which nobody knows where they changed.
            selection, repeats, changed = self._holes.cut(selection), False, None
        drawn = accounting.drawn(selection, view, repeats=repeats)
        switches = accounting.switches.record(view.frame, view.time_ns, drawn, changed)
        if self._fronts is not None:
            switches += self._fronts.record(view.time_ns, drawn.ids, view)
            self._count_depths(drawn)
        if self._levels is not None:
            self._levels.record(drawn, view.camera)
        extraction = self._extract(view, selection, drawn)
        first = self._first_uses.record(drawn.row.take(accounting.switches.changed))
        changes = LevelChanges(
            switches.levels_changed, first.levels, first.bytes + extraction.bytes
        )
        tally = accounting.tally(view.time_ns, drawn, selection.render_scale, changes)
        counts = (*tally.price.units, *_cpu_counts(view, selection, extraction, self._players))
        named = dict(zip(_PREDICTORS, counts, strict=True))
        gpu_ms = tally.price.gpu_ms
        times = self._machine.run(Submitted(view, selection, drawn, named, gpu_ms))
        self._rows.append(
            (
                *counts,
                tally.fading,
                gpu_ms,
                selection.predicted_ms,
                times.cpu_ms,
                times.gpu_ms,
                times.select_ms,
                switches.toggles,
                switches.reversals,
                switches.popping_px,
                switches.visible_pops,
                self._memory.memory_bytes,
                self._newly_loaded(),
                *self._shown(view, selection.render_scale, drawn, tally),
                *view.camera.position_m,
            )
        )
        cpu_ns, gpu_ns = round(times.cpu_ms * _NS_PER_MS), round(times.gpu_ms * _NS_PER_MS)
        return max(1, cpu_ns), max(1, gpu_ns)

    def counts(self) -> FloatArray:
        """Return what was recorded of the frames so far (`FrameLog.counts`)."""
        return self._rows.table()

    def drawn_by_depth(self) -> NDArray[np.int64]:
        """Return nodes drawn of the frames so far (`FrameLog.drawn_by_depth`)."""
        return np.frombuffer(self._by_depth, dtype=np.int64)

    def _count_depths(self, drawn: Drawn) -> None:
        if self._depth is not None:
            drawn_at = self._depth.take(drawn.at)
            self._by_depth += np.bincount(drawn_at, minlength=self._depths).tobytes()

    def _extract(self, view: View, selection: Selection, drawn: Drawn) -> Extraction:
        changed = self._accounting.switches.changed
        try:
            return self._index_sets.record(selection, drawn, changed)
        except ValueError as error:
            raise PolicyError(self._policy, view.frame, str(error)) from error

    def _shown(
        self, view: View, render_scale: float, drawn: Drawn, tally: Tally
    ) -> tuple[float, ...]:
        """Return what the picture is worth beside that of every candidate at full detail."""
        share = render_scale * render_scale
        units = self._quality.units(view)
        quality, judged = self._quality.score(drawn, units), drawn
        if quality.missing:
            judged = with_missing(drawn, units, self._quality.find_missing(drawn, units))
        return (
            len(units.ids),
            len(drawn.ids),
            quality.missing,
            self._accounting.full_gpu_ms(units, drawn, tally, share),
            *self._errors.of(judged),
            share * quality.benefit,
            quality.full_benefit,
            # The bound is that of pictures rendered at full size.
            self._bound.of(view, tally.gpu_ms) if share == 1.0 else math.nan,
            quality.degradation / share,
            quality.full_degradation,
        )

    def _newly_loaded(self) -> float:
        """Return the bytes that the loader read since the frame before."""
        before, self._loaded_bytes = self._loaded_bytes, self._memory.loaded_bytes
        return self._loaded_bytes - before


def _cpu_counts(
    view: View, selection: Selection, extraction: Extraction, players: int
) -> tuple[float, ...]:
    """Return what a frame asks of the CPU beside its draw calls and changes of level."""
    work = selection.work
    return (
        work.objects_visited,
        work.comparisons,
        work.iterations,
        extraction.levels,
        extraction.triangles_changed,
        extraction.borrowed,
        # Two eyes are culled by one frustum around both, each player by his own.
        players * len(view.scene),
    )
