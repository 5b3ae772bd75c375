"""Prices of frames and of objects, worked by hand; terms of the view, by simulation and bounds."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from lodbench.base.arrays import FloatArray
from lodbench.base.predictors import CHANGE_PREDICTORS, GPU_PREDICTORS, LEVEL_PREDICTORS
from lodbench.models.machine import cost_terms
from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.cost_terms.catalog import FRAME_TERMS, VIEW_TERMS
from lodbench.models.machine.cost_terms.term import LevelChanges, Pass
from lodbench.models.machine.frame_cost import FrameCost
from lodbench.models.machine.knee import Knee
from lodbench.models.machine.picture_units import view_units
from lodbench.models.scene.levels import LevelTable, count_rows

MakeLevels = Callable[..., LevelTable]
RASTERIZED = VIEW_TERMS["rasterized_triangles"]


class Seen(NamedTuple):
    """A footprint."""

    area_px: FloatArray
    covered_px: FloatArray
    inside_share: FloatArray

    @property
    def passes(self) -> tuple[Pass, ...]:
        """One camera draws all."""
        return (Pass(np.ones(len(self.area_px), dtype=np.bool_), self),)


def seen(area_px: list[float], covered_px: list[float] | None = None) -> Seen:
    """Return objects that are wholly in the picture."""
    area = np.array(area_px)
    return Seen(area, area if covered_px is None else np.array(covered_px), np.ones(len(area)))


def test_every_predictor_is_a_count_of_levels_or_a_term() -> None:
    """A GPU predictor without a price would be charged nothing, a file without a name never."""
    terms = {*VIEW_TERMS, *FRAME_TERMS}
    assert terms == {*GPU_PREDICTORS} - {*LEVEL_PREDICTORS}
    files = {path.stem for folder in cost_terms.__path__ for path in Path(folder).glob("*.py")}
    assert files - {"__init__", "term", "catalog"} == terms


def test_objects_by_hand(make_levels: MakeLevels) -> None:
    """Linear and pixel costs add up; of geometry and pixels in the roofline the larger counts."""
    model = CostModel.of(
        9.0,
        {"triangles": 1e-3, "draw_calls": 0.5, "shaded_samples": 1e-4, "state_changes": 7.0},
        {"triangles": 2e-3, "shaded_samples": 1e-2},
    )
    costs = FrameCost(model, make_levels([(1000, 100)]))
    assert costs.level_ms == pytest.approx([1.5, 0.6])
    assert costs.geometry_ms == pytest.approx([2.0, 0.2])
    each = [1.5 + 0.005 + 2.0, 0.6 + 0.005 + 0.5]
    assert costs.objects_ms(np.array([0, 1]), seen([50.0, 50.0])) == pytest.approx(each)
    table = costs.objects_ms(np.array([[0, 1], [0, 1]]), seen([50.0, 500.0]))
    assert table == pytest.approx(np.array((each, (1.5 + 0.05 + 5.0, 0.6 + 0.05 + 5.0))))


def test_what_no_level_decides_by_hand(make_levels: MakeLevels) -> None:
    """Areas of 50 and 150 px at 1e-4 ms each; levels, the base and changes of state are no part."""
    unit_ms = {"triangles": 1e-3, "draw_calls": 0.5, "shaded_samples": 1e-4, "state_changes": 7.0}
    costs = FrameCost(CostModel.of(9.0, unit_ms), make_levels([(1000, 100)]))
    assert costs.linear_in_detail
    assert costs.anyway_ms(seen([50.0, 150.0])) == pytest.approx(0.02)
    assert costs.anyway_ms(seen([])) == 0.0


def test_what_lies_between_knots_costs_what_lies_between(make_levels: MakeLevels) -> None:
    """A quarter of the way from 1,000 triangles to 200, an object has 800 of them."""
    costs = FrameCost(CostModel.of(0.0, {"triangles": 1.0}), make_levels([(1000, 200)]))
    row, fraction = np.array([0]), np.array([0.25])
    assert costs.objects_ms(row, seen([1.0]), fraction=fraction) == pytest.approx([800.0])
    assert costs.frame(row, seen([1.0]), 1.0, fraction=fraction).gpu_ms == pytest.approx(800.0)


def test_a_smaller_picture_has_fewer_pixels(make_levels: MakeLevels) -> None:
    """At a quarter of the pixels, area and covered samples are a quarter; triangles all there.

    Of 100 triangles 400 samples reach 100 (1 - e^-4), and 100 samples 100 (1 - e^-1).
    """
    view, row = seen([80.0], [400.0]), np.array([0])
    for name, full, quarter in (
        ("shaded_samples", 80.0, 20.0),
        ("rasterized_triangles", -100.0 * math.expm1(-4.0), -100.0 * math.expm1(-1.0)),
    ):
        levels = make_levels([(100,)])
        costs = FrameCost(CostModel.of(0.0, {name: 1.0}), levels)
        for share, units in ((1.0, full), (0.25, quarter)):
            assert costs.objects_ms(row, view, pixel_share=share) == pytest.approx([units])
            assert costs.frame(row, view, 1e6, pixel_share=share).gpu_ms == pytest.approx(units)
            assert view_units(name, levels, row, view, share) == pytest.approx(units)
    roofline = CostModel.of(0.0, {}, {"triangles": 0.3, "shaded_samples": 1.0})
    costs = FrameCost(roofline, make_levels([(100,)]))
    assert costs.objects_ms(row, view) == pytest.approx([80.0])
    assert costs.objects_ms(row, view, pixel_share=0.25) == pytest.approx([30.0])
    assert costs.frame(row, view, 1e6, pixel_share=0.25).gpu_ms == pytest.approx(30.0)
    buffers = FrameCost(CostModel.of(1.0, {"framebuffer_pixels": 1e-3}), make_levels([(100,)]))
    assert buffers.frame(row, view, 4000.0, pixel_share=0.25).gpu_ms == pytest.approx(2.0)


def test_a_frame_by_hand(make_levels: MakeLevels) -> None:
    """2 ms, 1 ms a triangle, 1/8 ms a pixel, and 32 ms a type, of which two of three are drawn."""
    model = CostModel.of(
        2.0, {"triangles": 1.0, "shaded_samples": 0.125, "framebuffer_pixels": 0.125,
              "state_changes": 32.0}
    )  # fmt: skip
    costs = FrameCost(model, make_levels([(40, 20), (7,), (9, 3)]))
    price = costs.frame(np.array([1, 4, 1]), seen([8.0, 16.0, 24.0]), 800.0)
    assert price.gpu_ms == 2.0 + (20 + 3 + 20) + 48 / 8 + 800 / 8 + 64
    assert costs.fixed_ms(800.0, 2) == 2.0 + 100.0 + 64.0
    counts = costs.counts(price)
    assert set(counts) == set(GPU_PREDICTORS)
    assert (counts["triangles"], counts["draw_calls"], counts["state_changes"]) == (43, 3, 2)
    assert (counts["shaded_samples"], counts["framebuffer_pixels"]) == (48.0, 800.0)
    assert math.isnan(counts["rasterized_triangles"])


def test_what_is_new_in_a_frame_by_hand(make_levels: MakeLevels) -> None:
    """Three changes of 2 ms, one first use of 16 and 100 bytes of 1/8, beside 20 triangles of 1.

    At full detail 40 triangles are drawn, and nothing of that is new; without prices all is free.
    """
    unit_ms = {"triangles": 1.0, "levels_changed": 2.0, "first_uses": 16.0, "bytes_uploaded": 0.125}
    costs = FrameCost(CostModel.of(5.0, unit_ms), make_levels([(40, 20)]))
    row, view, changes = np.array([1]), seen([8.0]), LevelChanges(3, 1, 100.0)
    price = costs.frame(row, view, 800.0, changes=changes)
    assert price.gpu_ms == 5.0 + 20 + 3 * 2 + 16 + 12.5
    assert costs.frame(row, view, 800.0).gpu_ms == 25.0
    assert costs.finest_ms(price) == 45.0
    counts = costs.counts(price)
    assert [counts[name] for name in CHANGE_PREDICTORS] == [3, 1, 100.0]
    free = FrameCost(CostModel.of(5.0, {"triangles": 1.0}), make_levels([(40, 20)]))
    assert free.frame(row, view, 800.0, changes=changes).gpu_ms == 25.0


def test_a_frame_at_full_detail_by_hand(make_levels: MakeLevels) -> None:
    """From what was drawn: twice 40 triangles and once 9, at the same places and of two types."""
    model = CostModel.of(
        2.0, {"triangles": 1.0, "shaded_samples": 0.125, "state_changes": 32.0}
    )  # fmt: skip
    costs = FrameCost(model, make_levels([(40, 20), (7,), (9, 3)]))
    view = seen([8.0, 16.0, 24.0])
    price = costs.frame(np.array([1, 4, 1]), view, 800.0)
    assert costs.finest_ms(price) == 2.0 + (40 + 9 + 40) + 48 / 8 + 64
    assert costs.finest_ms(price) == costs.frame(np.array([0, 3, 0]), view, 800.0).gpu_ms
    assert costs.level_by_level
    for of_the_view in (
        CostModel.of(0.0, {"rasterized_triangles": 1.0}),
        CostModel.of(0.0, {}, {"triangles": 1.0, "shaded_samples": 1.0}),
    ):
        assert not FrameCost(of_the_view, make_levels([(40, 20)])).level_by_level


def test_a_frame_is_what_is_fixed_and_its_objects(make_levels: MakeLevels) -> None:
    """Whole frames and marginal costs are two ways to one price, with every term charged."""
    rng = np.random.default_rng(2)
    names = [name for name in GPU_PREDICTORS if name not in ("splats", "texture_bytes")]
    model = CostModel.of(
        3.0, dict(zip(names, rng.uniform(0.1, 1.0, len(names)), strict=True)),
        {"triangles": 0.2, "shaded_samples": 0.5},
    )  # fmt: skip
    costs = FrameCost(model, make_levels([(90, 40, 10), (70, 20)], continuous=True))
    row, fraction = np.array([0, 1, 3, 0]), np.array([0.5, 0.0, 0.75, 1.0])
    area = rng.uniform(10.0, 200.0, 4)
    view = Seen(area, 0.4 * area, np.array([1.0, 0.5, 0.1, 1.0]))
    price = costs.frame(row, view, 1000.0, fraction=fraction, pixel_share=0.5)
    objects_ms = costs.objects_ms(row, view, fraction=fraction, pixel_share=0.5)
    assert price.gpu_ms == pytest.approx(costs.fixed_ms(500.0, 2, 4) + objects_ms.sum(), rel=1e-12)


def test_a_knee_by_hand(make_levels: MakeLevels) -> None:
    """Beyond 30 triangles each costs 2 ms more: 43 are 26 ms dearer, 23 none, as are none more."""
    linear = {"triangles": 1.0, "shaded_samples": 0.125}
    plain = FrameCost(CostModel.of(2.0, linear), make_levels([(40, 20), (9, 3)]))
    kneed = CostModel.of(2.0, linear, knees=[Knee("triangles", 30.0, 2.0)])
    costs = FrameCost(kneed, make_levels([(40, 20), (9, 3)]))
    for row, extra in (([1, 3, 1], 26.0), ([1, 3], 0.0), ([0], 20.0), ([1], 0.0)):
        view = seen([8.0] * len(row))
        before, after = (c.frame(np.array(row), view, 800.0) for c in (plain, costs))
        assert after.gpu_ms == before.gpu_ms + extra
        # What objects cost one by one is without the knee, which is of all of them together.
        each_ms = costs.objects_ms(np.array(row), view)
        assert each_ms.tolist() == plain.objects_ms(np.array(row), view).tolist()
    assert plain.level_by_level
    assert costs.linear_in_detail
    assert not costs.level_by_level


def test_a_knee_of_what_the_view_and_the_frame_count(make_levels: MakeLevels) -> None:
    """Samples of a term that costs nothing by itself are counted for a knee, as uploads are.

    40 covered pixels on 1e9 triangles reach 40; 100 bytes are 60 beyond 40, at 0.5 ms each.
    """
    model = CostModel.of(
        0.0, {}, knees=[Knee("rasterized_triangles", 15.0, 1.0), Knee("bytes_uploaded", 40.0, 0.5)]
    )
    costs = FrameCost(model, make_levels([(1e9,)]))
    row, view = np.array([0]), seen([50.0], [40.0])
    assert costs.frame(row, view, 800.0).gpu_ms == pytest.approx(25.0)
    uploaded = costs.frame(row, view, 800.0, changes=LevelChanges(0, 0, 100.0))
    assert uploaded.gpu_ms == pytest.approx(25.0 + 30.0)


def test_the_price_of_a_frame_is_the_sum_of_its_parts(make_levels: MakeLevels) -> None:
    """Base, each term, each object's roofline and each knee, added up one by one in plain Python.

    Of twenty frames of every predictor, with fractions, new levels and pictures of other sizes.
    """
    rng = np.random.default_rng(4)
    priced = rng.uniform(0.1, 1.0, len(GPU_PREDICTORS)).tolist()
    unit_ms: dict[str, float] = dict(zip(GPU_PREDICTORS, priced, strict=True))
    roofline = {"triangles": 0.2, "vertices": 0.1, "shaded_samples": 0.5}
    counts = [(90, 40, 10), (70, 20), (300, 30)]
    levels = make_levels(counts, continuous=True)
    for _ in range(20):
        knees = [
            Knee(name, float(rng.uniform(0.0, 400.0)), float(rng.uniform(0.0, 2.0)))
            for name in rng.choice(GPU_PREDICTORS, 4, replace=False).tolist()
        ]
        costs = FrameCost(CostModel.of(3.0, unit_ms, roofline, knees), levels)
        row, fraction = np.array([0, 1, 3, 5, 0]), rng.uniform(0.0, 1.0, 5)
        area = rng.uniform(10.0, 200.0, 5)
        view, share = Seen(area, 0.4 * area, rng.uniform(0.1, 1.0, 5)), float(rng.uniform(0.2, 1.0))
        changes = LevelChanges(int(rng.integers(9)), 2, float(rng.uniform(0.0, 500.0)))
        price = costs.frame(
            row, view, 1000.0, fraction=fraction, pixel_share=share, changes=changes
        )
        total: dict[str, float] = dict.fromkeys(GPU_PREDICTORS, 0.0)
        roofline_ms = 0.0
        for at, part, px, covered, inside in zip(
            row.tolist(), fraction.tolist(), area.tolist(), view.covered_px.tolist(),
            view.inside_share.tolist(), strict=True,
        ):  # fmt: skip
            near, far = levels.counts[at], levels.counts[min(at + 1, len(levels.counts) - 1)]
            of = dict(zip(LEVEL_PREDICTORS, (1.0 - part) * near + part * far, strict=True))
            for name, units in of.items():
                total[name] += units
            shown = of["triangles"] * inside
            total["shaded_samples"] += share * px
            total["triangles_in_view"] += shown
            total["rasterized_triangles"] += shown * -math.expm1(-share * covered / shown)
            total["reformed_objects"] += 1.0
            total["reformed_triangles"] += of["triangles"]
            total["untextured_triangles"] += of["triangles"] - of["textured_triangles"]
            geometry_ms = 0.2 * of["triangles"] + 0.1 * of["vertices"]
            roofline_ms += max(geometry_ms, 0.5 * share * px)
        total["framebuffer_pixels"] = share * 1000.0
        total["state_changes"] = 3.0
        total["reduction_steps"] = math.log2(5)
        total |= dict(zip(CHANGE_PREDICTORS, changes, strict=True))
        ms = 3.0 + sum(unit_ms[name] * total[name] for name in GPU_PREDICTORS) + roofline_ms
        for knee in knees:
            if total[knee.predictor] > knee.at:
                ms += knee.ms * (total[knee.predictor] - knee.at)
        assert costs.counts(price) == pytest.approx(total, rel=1e-12)
        assert price.gpu_ms == pytest.approx(ms, rel=1e-12)


def test_rasterized_triangles_by_simulation() -> None:
    """Samples thrown at triangles at random reach as many of them as the formula says."""
    rng = np.random.default_rng(1)
    triangles, samples = 200, 150
    hit = [len(np.unique(rng.integers(triangles, size=samples))) for _ in range(4000)]
    expected = RASTERIZED.count([np.array([float(triangles)])], seen([float(samples)]))
    assert expected[0] == pytest.approx(np.mean(hit), rel=0.003)


def test_rasterized_triangles_have_their_limits() -> None:
    """Far away each sample reaches its own triangle; near by all in the picture are."""
    triangles = np.array([1e6, 10.0, 0.0, 10.0])
    covered, inside = np.array([100.0, 1e6, 100.0, 1e6]), np.array([1.0, 1.0, 1.0, 0.25])
    units = RASTERIZED.count([triangles], Seen(covered, covered, inside))
    assert units == pytest.approx([100.0, 10.0, 0.0, 2.5], rel=1e-4)


def test_triangles_in_view_are_those_of_what_is_inside(make_levels: MakeLevels) -> None:
    """Of 100 triangles all, a quarter and none are let through: 125 in all, at 2 ms each."""
    levels, row = make_levels([(100, 40)]), np.array([0, 0, 0])
    view = Seen(np.full(3, 50.0), np.full(3, 20.0), np.array([1.0, 0.25, 0.0]))
    costs = FrameCost(CostModel.of(0.0, {"triangles_in_view": 2.0}), levels)
    assert costs.objects_ms(row, view).tolist() == [200.0, 50.0, 0.0]
    price = costs.frame(row, view, 1e6, pixel_share=0.25)  # a smaller picture has as many
    assert price.gpu_ms == 250.0
    assert costs.counts(price)["triangles_in_view"] == 125.0


def test_textured_triangles_may_be_the_cheaper_ones() -> None:
    """Of 100 triangles with 80 textured and 50 with 20, at 1 and 4 ms: 80 + 80 and 20 + 120."""
    counts = count_rows(2, triangles=[100.0, 50.0], textured_triangles=[80.0, 20.0])
    levels = LevelTable(np.array([0, 2]), counts, np.zeros(2), np.zeros(2), np.zeros(1, bool))
    model = CostModel.of(0.0, {"textured_triangles": 1.0, "untextured_triangles": 4.0})
    costs = FrameCost(model, levels)
    row, view = np.array([0, 1]), seen([1.0, 1.0])
    assert costs.objects_ms(row, view) == pytest.approx([160.0, 140.0])
    assert costs.frame(row, view, 1e6).gpu_ms == pytest.approx(300.0)


@pytest.mark.parametrize("name", VIEW_TERMS)
def test_no_term_of_the_view_rises_above_its_line(name: str) -> None:
    """From the lowest resolution to 1, the line that policies plan with is nowhere below."""
    rng = np.random.default_rng(3)
    n, term = 200, VIEW_TERMS[name]
    full = [rng.uniform(1.0, 10_000.0, n) for _ in term.reads]
    area = np.exp(rng.uniform(-3.0, 12.0, n))
    view, lowest = Seen(area, 0.4 * area, rng.uniform(0.0, 1.0, n)), rng.uniform(1e-3, 0.9, n)
    start, slope = term.line_above(full, view, lowest)
    for share in np.linspace(0.0, 1.0, 21):
        resolution = lowest + share * (1.0 - lowest)
        units = term.count([resolution * column for column in full], view)
        assert (start + slope * resolution >= units * (1.0 - 1e-9) - 1e-9).all()
