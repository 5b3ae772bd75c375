"""Toggles, reversals, popping and cross-fades of one object, worked out by hand."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.levels import LevelTable
from lodbench.policies.protocol import Policy
from lodbench.policies.selection import Selection
from lodbench.policies.view import View
from lodbench.sim.frame_log import FrameLog

AREA_PX = math.pi * 50.0**2 / 99.0  # of a sphere of 1 m at 10 m, 100 px high at 90 degrees
UNIT_PX = 50.0 / 9.0  # of 1 m at its nearest point, 9 m away
VIEWPORT_PX = 100.0 * 100.0
Run = Callable[..., FrameLog]
MakePolicy = Callable[..., Policy]
MakeHardware = Callable[..., HardwareProfile]
MakeLevels = Callable[..., LevelTable]


def test_toggles_and_popping_by_hand(run: Run, scripted: MakePolicy) -> None:
    """Levels 0, 1, 1, 2 of one object are two toggles, of 0.1 m each over its share of view."""
    log = run(scripted([0, 1, 1, 2]), 5)
    assert log["toggles"].tolist() == [0, 1, 0, 1, 0]
    pop = 0.1 * UNIT_PX * AREA_PX / VIEWPORT_PX
    assert log["popping_px"] == pytest.approx([0, pop, 0, pop, 0])
    assert log["reversals"].sum() == 0


def test_popping_towards_fine_and_coarse_adds_up(run: Run, scripted: MakePolicy) -> None:
    """One object gains 0.2 m of error as another loses them: two pops, which do not cancel."""
    log = run(scripted([[0, 2], [2, 0]]), 2, positions=[(0.0, 0.0, -10.0)] * 2)
    pop = 0.2 * UNIT_PX * AREA_PX / VIEWPORT_PX
    assert log["popping_px"] == pytest.approx([0.0, 2.0 * pop])


@pytest.mark.parametrize(("visible_px", "seen"), [(0.0, 1), (0.55, 1), (0.56, 0)])
def test_a_switch_is_seen_from_the_visible_change_on(
    run: Run, scripted: MakePolicy, visible_px: float, seen: int
) -> None:
    """A step of 0.1 m is 0.556 px and may be seen; from level 2 to 0 it is twice that, and is."""
    log = run(scripted([0, 1, 1, 2, 0]), 5, options={"visible_px": visible_px})
    assert log["visible_pops"].tolist() == [0, seen, 0, seen, 1]
    assert log["toggles"].tolist() == [0, 1, 0, 1, 1]
    assert log.header.visible_px == visible_px


def test_a_change_between_knots_is_seen_but_no_switch(
    run: Run, scripted: MakePolicy, make_levels: MakeLevels
) -> None:
    """A continuous node from 999 to 251 triangles passes no knot, and changes by nearly 0.1 m."""
    levels = make_levels([(1000, 250, 50)], continuous=True)
    script = scripted([0.999, 0.251])
    log = run(script, 2, levels=levels, options={"visible_px": 0.5})
    assert log["toggles"].tolist() == [0, 0]
    assert log["visible_pops"].tolist() == [0, 1]
    log = run(script, 2, levels=levels, options={"visible_px": 0.6})
    assert log["visible_pops"].tolist() == [0, 0]


def test_a_change_while_not_drawn_is_no_toggle(run: Run, scripted: MakePolicy) -> None:
    """An object that was missing for a frame may return at any level; its absence is counted."""

    def absent(view: View, selection: Selection) -> Selection:
        return Selection(view.ids[:0], np.zeros(0)) if view.frame == 1 else selection

    log = run(scripted([0, 0, 2], absent), 3)
    assert log["toggles"].tolist() == [0, 0, 0]
    assert log["missing"].tolist() == [0, 1, 0]
    assert log["drawn"].tolist() == [1, 0, 1]
    assert log["benefit"][1] == 0.0
    assert log["degradation"][1] == pytest.approx(AREA_PX)
    assert log["full_benefit"][1] == pytest.approx(AREA_PX * 0.9995)


@pytest.mark.parametrize(("frame_ms", "expected"), [(250.0, 1), (250.0 + 1e-6, 0)])
def test_a_switch_undone_within_half_a_second_is_a_reversal(
    run: Run, scripted: MakePolicy, make_hardware: MakeHardware, frame_ms: float, expected: int
) -> None:
    """0, 1, 1, 0: two frames of 250 ms after the first switch it is undone, just in time."""
    hardware = make_hardware({}, base_ms=1e-6, cpu_base_ms=frame_ms - 1e-6, frames_in_flight=1)
    log = run(scripted([0, 1, 1, 0]), 5, hardware=hardware)
    steps = np.diff(log["input_ns"])
    assert set(steps.tolist()) == {round(frame_ms * 1e6)}
    assert log["toggles"].tolist() == [0, 1, 0, 1, 0]
    assert log["reversals"].tolist() == [0, 0, 0, expected, 0]


def test_going_on_in_the_same_direction_is_no_reversal(run: Run, scripted: MakePolicy) -> None:
    """0, 1, 2, 0 has three switches, none of which returns to the level just left."""
    log = run(scripted([0, 1, 2, 0]), 4)
    assert (log["toggles"].sum(), log["reversals"].sum()) == (3, 0)
    log = run(scripted([0, 2, 0, 2]), 4)
    assert (log["toggles"].sum(), log["reversals"].sum()) == (3, 2)


def test_a_cross_fade_draws_both_levels_for_its_time(
    run: Run, scripted: MakePolicy, make_hardware: MakeHardware
) -> None:
    """25 ms of cross-fade at 10 ms a frame: the old level is drawn in three frames."""
    hardware = make_hardware({}, base_ms=1e-6, cpu_base_ms=10.0, frames_in_flight=2)
    log = run(scripted([0, 1]), 6, hardware=hardware, options={"crossfade_ms": 25.0})
    assert np.diff(log["input_ns"]).tolist() == [10_000_000] * 5
    assert log["fading"].tolist() == [0, 1, 1, 1, 0, 0]
    assert log["triangles"].tolist() == [1000, 1250, 1250, 1250, 250, 250]
    assert log["draw_calls"].tolist() == [1, 2, 2, 2, 1, 1]
    assert log["shaded_samples"] == pytest.approx(AREA_PX * np.array([1, 2, 2, 2, 1, 1]), rel=1e-12)
    assert log["drawn"].tolist() == [1] * 6
    assert log["benefit"][1] == pytest.approx(AREA_PX * (1 - 0.5 / 250))


def test_a_cross_fade_ends_exactly_on_time(
    run: Run, scripted: MakePolicy, make_hardware: MakeHardware
) -> None:
    """20 ms of cross-fade at 10 ms a frame: the frame 20 ms after the switch draws one level."""
    hardware = make_hardware({}, base_ms=1e-6, cpu_base_ms=10.0)
    log = run(scripted([0, 1]), 5, hardware=hardware, options={"crossfade_ms": 20.0})
    assert log["fading"].tolist() == [0, 1, 1, 0, 0]


def test_what_fades_is_drawn_again_where_it_is(
    run: Run, scripted: MakePolicy, make_hardware: MakeHardware
) -> None:
    """Of a near and a far object the far one fades: its pixels count twice, the near one's once."""
    hardware = make_hardware({}, base_ms=1e-6, cpu_base_ms=10.0)
    log = run(
        scripted([[0, 0], [0, 1]]), 3, positions=[(0.0, 0.0, -10.0), (0.0, 0.0, -20.0)],
        hardware=hardware, options={"crossfade_ms": 10.0},
    )  # fmt: skip
    far_px = math.pi * 50.0**2 / 399.0
    assert log["fading"].tolist() == [0, 1, 0]
    assert log["triangles"].tolist() == [2000, 2250, 1250]
    expected = [AREA_PX + far_px, AREA_PX + 2.0 * far_px, AREA_PX + far_px]
    assert log["shaded_samples"] == pytest.approx(expected, rel=1e-12)


def test_a_continuous_node_fades_out_at_its_old_knot(
    run: Run, scripted: MakePolicy, make_hardware: MakeHardware, make_levels: MakeLevels
) -> None:
    """From 1,000 triangles to 100, which lie between two knots: 1,100 in the frame of the fade."""
    hardware = make_hardware({}, base_ms=1e-6, cpu_base_ms=10.0)
    levels = make_levels([(1000, 250, 50)], continuous=True)
    log = run(
        scripted([1.0, 0.1]), 3, hardware=hardware, levels=levels, options={"crossfade_ms": 10.0}
    )
    assert log["triangles"] == pytest.approx([1000.0, 1100.0, 100.0])
