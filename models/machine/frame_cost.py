"""What a frame costs: the only place where one is priced.

The simulator charges by it, policies predict by it, and checks and bounds compare with it, each
from what it knows: a whole frame, or each object at each of its levels.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from ...base.arrays import FloatArray, IntArray, sum_rows
from ...base.predictors import GPU_PREDICTORS, LEVEL_PREDICTORS
from ..scene.levels import LevelTable
from .cost import CostModel
from .cost_terms.catalog import FRAME_TERMS, VIEW_TERMS
from .cost_terms.term import (
    NO_CHANGES,
    Footprint,
    Footprints,
    FrameShape,
    LevelChanges,
    ViewTerm,
)
from .picture_units import InPicture
from .price import Load, Price

_SHADED_SAMPLES = GPU_PREDICTORS.index("shaded_samples")
_LEVEL_COLUMN = {name: at for at, name in enumerate(LEVEL_PREDICTORS)}


class _Term(NamedTuple):
    """A view's term, its price, and the columns of the level table that it reads."""

    name: str
    term: ViewTerm
    unit_ms: float
    columns: tuple[FloatArray, ...]


class _Draws(NamedTuple):
    """What one camera draws: rows and fractions of its objects, and where these are."""

    row: IntArray
    fraction: FloatArray | None
    seen: Footprint


class FrameCost:
    """Prices of frames that draw levels of one table, by one cost model.

    Rows are those of the level table.  With fractions, (m,), a row stands for what lies so far on
    the way to the next one.  Where cameras draw one after another, an object costs as often as it
    is drawn, and what it costs depends on the view even where no term of the view has a price.

    Attributes
    ----------
    model : CostModel
    levels : LevelTable
    level_ms, geometry_ms : (L,) float64
        What each level costs whatever the view, and the geometry side of its roofline.
    pixel_ms : float
        Pixel side of the roofline, per pixel of projected area.
    linear_in_detail : bool
        Whether no term of the view depends on the level.
    level_by_level : bool
        Whether what a level adds to a frame is the same wherever it is in the picture, and
        whatever else is in it.
    """

    def __init__(self, model: CostModel, levels: LevelTable) -> None:
        self.model, self.levels = model, levels
        width = len(LEVEL_PREDICTORS)
        self.level_ms = levels.counts @ model.linear_ms[:width]
        self.geometry_ms = levels.counts @ model.roofline_ms[:width]
        self.pixel_ms = float(model.roofline_ms[_SHADED_SAMPLES])
        self._has_roofline = model.has_roofline
        self._first = levels.start[:-1].astype(np.int64)
        self._per_level = np.vstack((levels.counts.T, self.level_ms))
        self._per_finest = self._per_level[:, self._first[levels.type_of_level]]
        terms = [
            _Term(name, term, model.unit_ms(name), tuple(map(self._column, term.reads)))
            for name, term in VIEW_TERMS.items()
        ]
        self._charged = [term for term in terms if term.unit_ms]
        # Of a knee that costs nothing, too: a draw's frames are counted as the profile's are.
        kneed = {knee.predictor for knee in model.knees}
        counted = [t for t in terms if t.unit_ms or t.term.logged_free or t.name in kneed]
        self._of_levels = [term for term in counted if term.columns]
        self._of_no_level = [term for term in counted if not term.columns]
        self._uncounted = dict.fromkeys(VIEW_TERMS.keys() - {t.name for t in counted}, np.nan)
        self._frame_terms = [
            (name, term, model.unit_ms(name)) for name, term in FRAME_TERMS.items()
        ]
        self._summed = _by_unit(model)
        # Apart, as what is new in a frame is no part of what its objects cost.
        self._of_changes = [
            (name, unit_ms)
            for name, term, unit_ms in self._frame_terms
            if term.of_changes and unit_ms
        ]
        # Prices of one view have the same sums of what no level decides.
        self._last_seen: Footprint | None = None
        self._last_totals: dict[str, float] = {}
        self._last_shape = FrameShape(math.nan, 0)
        self._last_units: dict[str, float] = {}
        once = model.passes == 1
        self.linear_in_detail = once and not any(term.columns for term in self._charged)
        self.level_by_level = self.linear_in_detail and not self._has_roofline and not model.knees

    def _column(self, predictor: str) -> FloatArray:
        return np.ascontiguousarray(self.levels.counts[:, LEVEL_PREDICTORS.index(predictor)])

    def frame(
        self,
        row: IntArray,
        seen: Footprints,
        viewport_px: float,
        *,
        fraction: FloatArray | None = None,
        pixel_share: float = 1.0,
        load: Load | None = None,
        changes: LevelChanges = NO_CHANGES,
    ) -> Price:
        """Return the price of a frame that draws these rows.

        Parameters
        ----------
        row, fraction
            (m,) each.
        seen
            Where the m objects are in the window, or in each camera's part of it.
        viewport_px
            Pixels of the window, all cameras' parts together.
        pixel_share
            Pixels of the picture as it is rendered over those of the window.
        load
            What `load` returns for these rows, where it is known.
        changes
            What is new in the frame.
        """
        draws = self._draws(row, fraction, seen, pixel_share)
        load = load or _total([self.load(each.row, each.fraction) for each in draws])
        shape = FrameShape(pixel_share * viewport_px, load.types, changes, len(row))
        if shape != self._last_shape:
            self._last_shape = shape
            self._last_units = {name: term.count(shape) for name, term, _ in self._frame_terms}
        counts = self._totals(draws) | self._last_units
        for term in self._of_levels:
            units = [float(np.add.reduce(self._units(term, *each))) for each in draws]
            counts[term.name] = sum(units)
        ms, terms_ms = self.model.base_ms + load.level_ms, list[float]()
        for terms in self._summed:
            unit_ms = 0.0
            for name, each_ms in terms:
                unit_ms += each_ms * counts[name]
            terms_ms.append(unit_ms)
            ms += unit_ms
        if self._has_roofline:
            for each in draws:
                geometry = self._at(self.geometry_ms, each.row, each.fraction)
                ms += float(np.maximum(geometry, self.pixel_ms * each.seen.area_px).sum())
        for name, each_ms in self._of_changes:
            ms += each_ms * counts[name]
        for knee in self.model.knees:
            at = _LEVEL_COLUMN.get(knee.predictor)
            ms += knee.frame_ms(counts[knee.predictor] if at is None else load.counts[at])
        return Price(ms, load, counts, terms_ms)

    def finest_ms(self, price: Price) -> float:
        """Return the GPU time of a priced frame had it drawn the same objects at full detail.

        Only where the model is `level_by_level`.  Nothing of it is new.
        """
        # What else they cost is where they are, and of how many types.
        level_ms = sum_rows(self._per_finest, price.load.times_drawn)[-1]
        return sum(price.terms_ms, self.model.base_ms + level_ms)

    def load(self, row: IntArray, fraction: FloatArray | None = None) -> Load:
        """Return what a frame, or one camera of it, that draws these rows draws of each level."""
        # Level by level, as many objects share one.
        times_drawn = self._times_drawn(row, fraction)
        types = int(np.count_nonzero(np.add.reduceat(times_drawn, self._first)))
        *counts, level_ms = sum_rows(self._per_level, times_drawn)
        return Load(times_drawn, counts, level_ms, types)

    def counts(self, price: Price) -> dict[str, float]:
        """Return the units of a priced frame by GPU predictor."""
        return dict(zip(GPU_PREDICTORS, price.units, strict=True))

    def fixed_ms(self, viewport_px: float, types: int, objects: int = 1) -> float:
        """Return what a frame of so many distinct types and objects costs before its first one."""
        shape = FrameShape(viewport_px, types, objects=objects)
        ms = self.model.base_ms
        for _, term, unit_ms in self._frame_terms:
            ms += unit_ms * term.count(shape)
        return ms

    def anyway_ms(self, seen: Footprint) -> float:
        """Return what all objects cost by the view's terms, where no level decides these.

        Only where the model is `linear_in_detail`.
        """
        units = ((term.unit_ms, term.term.count((), seen)) for term in self._charged)
        return sum([unit_ms * float(np.add.reduce(count)) for unit_ms, count in units])

    def types_drawn(self, kind: IntArray, seen: Footprints) -> int:
        """Return how many types objects have, (m,), counted anew by each camera that draws."""
        if self.model.passes == 1:
            return int(np.count_nonzero(np.bincount(kind)))
        kinds = (np.bincount(kind[drawn]) for drawn, _ in seen.passes)
        return sum([int(np.count_nonzero(count)) for count in kinds])

    def draws_of(self, seen: Footprints) -> FloatArray | float:
        """Return how often each object is drawn, (m,); 1 where nothing is drawn twice."""
        if self.model.passes == 1:
            return 1.0
        return np.add.reduce([drawn for drawn, _ in seen.passes], dtype=np.float64)

    def objects_ms(
        self,
        row: IntArray,
        seen: Footprints,
        *,
        fraction: FloatArray | None = None,
        pixel_share: float = 1.0,
    ) -> FloatArray:
        """Return the marginal cost of objects: (m,), or (m, L) for L rows of each object.

        Knees are left out: what an object costs beyond one depends on all others of the frame.
        """
        beside = row.ndim == 2
        if self.model.passes == 1:
            return self._pass_ms(row, fraction, InPicture(seen, pixel_share, beside=beside))
        ms = np.zeros(row.shape)
        for drawn, part in seen.passes:
            picture = InPicture(part, pixel_share, beside=beside)
            charged = drawn[:, None] if beside else drawn
            ms += np.where(charged, self._pass_ms(row, fraction, picture), 0.0)
        return ms

    def _pass_ms(
        self, row: IntArray, fraction: FloatArray | None, picture: InPicture
    ) -> FloatArray:
        ms = self._at(self.level_ms, row, fraction)
        for term in self._charged:
            ms = ms + term.unit_ms * self._units(term, row, fraction, picture)
        if self._has_roofline:
            geometry = self._at(self.geometry_ms, row, fraction)
            ms = ms + np.maximum(geometry, self.pixel_ms * picture.area_px)
        return ms

    def view_line_above(
        self, kind: IntArray, seen: Footprints, lowest: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return start and slope over resolution, (m,), of lines above what the view's terms cost.

        Of m objects of types `kind`, from their lowest resolutions to 1 (`ViewTerm.line_above`).
        """
        start, slope = np.zeros((2, len(kind)))
        for _, term, unit_ms, columns in self._charged:
            full = [column[self._first[kind]] for column in columns]
            if self.model.passes == 1:
                above, rise = term.line_above(full, seen, lowest)
                start, slope = start + unit_ms * above, slope + unit_ms * rise
                continue
            for drawn, part in seen.passes:
                above, rise = term.line_above(full, part, lowest)
                start, slope = start + drawn * unit_ms * above, slope + drawn * unit_ms * rise
        return start, slope

    def _draws(
        self, row: IntArray, fraction: FloatArray | None, seen: Footprints, pixel_share: float
    ) -> list[_Draws]:
        """Return what each camera draws that draws by itself."""
        if self.model.passes == 1:
            picture = seen if pixel_share == 1.0 else InPicture(seen, pixel_share)
            return [_Draws(row, fraction, picture)]
        draws = list[_Draws]()
        for drawn, part in seen.passes:
            at = drawn.nonzero()[0]
            some = None if fraction is None else fraction.take(at)
            draws.append(_Draws(row.take(at), some, InPicture(part, pixel_share, at=at)))
        return draws

    def _totals(self, draws: list[_Draws]) -> dict[str, float]:
        """Return the units of the terms that no level decides, over all objects."""
        if draws[0].seen is not self._last_seen:
            counts = self._uncounted.copy()
            for term in self._of_no_level:
                units = [float(np.add.reduce(term.term.count((), each.seen))) for each in draws]
                counts[term.name] = sum(units)
            self._last_seen, self._last_totals = draws[0].seen, counts
        return self._last_totals

    def _units(
        self, term: _Term, row: IntArray, fraction: FloatArray | None, seen: Footprint
    ) -> FloatArray:
        return term.term.count([self._at(c, row, fraction) for c in term.columns], seen)

    def _at(self, column: FloatArray, row: IntArray, fraction: FloatArray | None) -> FloatArray:
        if fraction is None:
            return column.take(row)
        return self.levels.interpolate(column, row, fraction)

    def _times_drawn(self, row: IntArray, fraction: FloatArray | None) -> FloatArray:
        count = len(self.level_ms)
        if fraction is None:
            return np.bincount(row, minlength=count).astype(np.float64)
        # numpy's stubs say that bincount returns integers with weights too.
        low: Any = np.bincount(row, 1.0 - fraction, count)
        high: Any = np.bincount(np.minimum(row + 1, count - 1), fraction, count)
        return low + high


def _total(loads: list[Load]) -> Load:
    """Return what several cameras draw together; types are set anew by each."""
    total = loads[0]
    for load in loads[1:]:
        total = Load(
            total.times_drawn + load.times_drawn,
            [one + other for one, other in zip(total.counts, load.counts, strict=True)],
            total.level_ms + load.level_ms,
            total.types + load.types,
        )
    return total


def _by_unit(model: CostModel) -> list[list[tuple[str, float]]]:
    """Return names and prices of the terms that cost something, those of one unit together.

    Terms that no level decides come first, and a unit stands where its first term does.
    Another order of additions would change the last bits of results, and who wins where two tie.
    """
    groups: dict[str, list[tuple[str, float]]] = {}
    of_no_level = {name: term for name, term in VIEW_TERMS.items() if not term.reads}
    of_frame = {name: term for name, term in FRAME_TERMS.items() if not term.of_changes}
    for name, term in (of_no_level | of_frame | VIEW_TERMS).items():
        if model.unit_ms(name):
            groups.setdefault(term.unit, []).append((name, model.unit_ms(name)))
    return list(groups.values())
