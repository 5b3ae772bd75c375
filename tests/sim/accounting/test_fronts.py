"""Switches, quality and failures in a hierarchy of seven nodes, worked out by hand."""

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
import pytest

from lodbench.base.errors import PolicyError
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.motion import Motion
from lodbench.models.scene.scene import Scene
from lodbench.policies.protocol import Capabilities
from lodbench.policies.selection import Selection
from lodbench.policies.view import View
from lodbench.sim.frame_log import FrameLog

# Node 0 has children 1 and 2; 1 has 3 and 4; 2 has 5 and 6.  All lie 10 m ahead.
PARENT = [-1, 0, 0, 1, 1, 2, 2]
Run = Callable[..., FrameLog]
MakeHardware = Callable[..., HardwareProfile]


class Fronts:
    """Draws given fronts, one a frame, the last for ever."""

    capabilities: ClassVar[Capabilities] = Capabilities(hierarchy=True)

    def __init__(self, *fronts: list[int]) -> None:
        self.fronts = fronts

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Prepare nothing."""

    def select(self, view: View) -> Selection:
        """Return the front of the frame."""
        ids = np.array(self.fronts[min(view.frame, len(self.fronts) - 1)], dtype=np.int32)
        return Selection(ids, np.zeros(len(ids)))


@pytest.fixture(scope="module")
def tree(make_scene: Callable[..., Scene], make_levels: Callable[..., LevelTable]) -> Scene:
    """Return the seven nodes: 10, 40 and 100 triangles and errors 0.4, 0.1 and 0 m by depth."""
    levels = make_levels([(10,), (40,), (100,)], error_m=[(0.4,), (0.1,), (0.0,)])
    places = [(0.0, 0.0, -10.0)] * 7
    return make_scene(places, kind=[0, 1, 1, 2, 2, 2, 2], levels=levels, parent=PARENT)


def test_refining_a_node_is_one_toggle(run: Run, tree: Scene) -> None:
    """Root, its children, all leaves, children again: 1, 2, 2 toggles, and reversals at once."""
    log = run(Fronts([0], [1, 2], [3, 4, 5, 6], [1, 2]), 5, scene=tree)
    assert log["toggles"].tolist() == [0, 1, 2, 2, 0]
    assert log["reversals"].tolist() == [0, 0, 0, 2, 0]
    assert log["triangles"].tolist() == [10, 80, 400, 80, 80]
    assert log["drawn"].tolist() == [1, 2, 4, 2, 2]
    assert log["visible"].tolist() == [4] * 5
    assert not log["missing"].any()


def test_popping_sums_over_the_finer_nodes(run: Run, tree: Scene) -> None:
    """Root to children: two nodes appear, each with 0.3 m less error over its share of view."""
    log = run(Fronts([0], [1, 2]), 2, scene=tree)
    area_px, px_per_m = np.pi * 2500.0 / 99.0, 50.0 / 9.0
    assert log["popping_px"] == pytest.approx([0.0, 2 * 0.3 * px_per_m * area_px / 1e4])
    assert log["sse_px_max"] == pytest.approx([0.4 * px_per_m, 0.1 * px_per_m])


def test_a_node_that_gives_way_is_one_visible_pop(run: Run, tree: Scene) -> None:
    """0.3 m of error less are 1.67 px, 0.1 m 0.56 px: from 1 px on only the first is seen."""
    log = run(Fronts([0], [1, 2], [3, 4, 5, 6], [0]), 4, scene=tree)
    assert log["toggles"].tolist() == [0, 1, 2, 1]
    assert log["visible_pops"].tolist() == [0, 1, 0, 1]
    log = run(Fronts([0], [1, 2], [3, 4, 5, 6]), 3, scene=tree, options={"visible_px": 0.5})
    assert log["visible_pops"].tolist() == [0, 1, 2]


def test_quality_is_scored_over_the_leaves(run: Run, tree: Scene) -> None:
    """Leaves under the root share its 10 triangles: 2.5 each; mixed fronts mix; none is missing."""
    log = run(Fronts([0], [1, 5, 6], [3, 4], [3, 4, 5, 6]), 4, scene=tree)
    area = np.pi * 2500.0 / 99.0
    full = 4 * area * (1 - 0.5 / 100)
    assert log["full_benefit"] == pytest.approx([full] * 4)
    expected = [4 * (1 - 0.5 / 2.5), 2 * (1 - 0.5 / 20) + 2 * 0.995, 2 * 0.995, 4 * 0.995]
    assert log["benefit"] == pytest.approx(area * np.array(expected))
    assert log["missing"].tolist() == [0, 0, 2, 0]
    assert log["full_degradation"] == pytest.approx([4 * area / 100] * 4)
    degraded = [4 / 2.5, 2 / 20 + 2 / 100, 2 / 100 + 2, 4 / 100]
    assert log["degradation"] == pytest.approx(area * np.array(degraded))
    assert log["benefit"][3] == log["full_benefit"][3]
    assert log["model_gpu_ms"][3] == pytest.approx(log["full_gpu_ms"][3])


def test_a_node_drawn_beside_its_children_is_seen_whole(
    run: Run, make_scene: Callable[..., Scene], make_levels: Callable[..., LevelTable]
) -> None:
    """An additive root of 10 triangles and its child of 40 are two units, each with its own."""
    levels = make_levels([(10,), (40,)], error_m=[(0.4,), (0.0,)])
    places = [(0.0, 0.0, -10.0)] * 2
    additive = [True, False]
    scene = make_scene(places, kind=[0, 1], levels=levels, parent=[-1, 0], additive=additive)
    log = run(Fronts([0, 1]), scene=scene)
    area = np.pi * 2500.0 / 99.0
    assert (log["visible"][0], log["missing"][0]) == (2, 0)
    assert log["benefit"][0] == pytest.approx(area * ((1 - 0.5 / 10) + (1 - 0.5 / 40)))
    assert log["full_benefit"][0] == log["benefit"][0]


def test_coming_into_view_is_no_switch(
    run: Run,
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., LevelTable],
    make_hardware: MakeHardware,
) -> None:
    """A node that takes its parent's place in the frame in which it comes into view is none."""
    levels = make_levels([(10,), (40,)], error_m=[(0.4,), (0.0,)])
    # Node 1 is out of view while it circles, and back after 2 s.
    motion = Motion(np.array([1]), np.array([40.0]), np.array([np.pi]), np.array([0.0]))
    scene = make_scene(
        [(0.0, 0.0, -10.0)] * 2, kind=[0, 1], radius_m=[100.0, 1.0], levels=levels,
        parent=[-1, 0], motion=motion,
    )  # fmt: skip
    hardware = make_hardware({}, base_ms=1e-6, cpu_base_ms=500.0)
    log = run(Fronts([0], [0], [0], [0], [1]), 5, scene=scene, hardware=hardware)
    assert log["visible"].tolist() == [1, 0, 0, 0, 1]
    assert log["triangles"].tolist() == [10, 10, 10, 10, 40]
    assert log["toggles"].tolist() == [0, 0, 0, 0, 0]


def test_nodes_outside_the_frustum_are_culled_not_drawn(
    run: Run, make_scene: Callable[..., Scene], make_levels: Callable[..., LevelTable]
) -> None:
    """A front may name nodes out of view; they cost nothing, and are no switch when they leave."""
    levels = make_levels([(10,), (40,)], error_m=[(0.4,), (0.0,)])
    places = [(0.0, 0.0, -10.0), (0.0, 0.0, -10.0), (0.0, 0.0, 50.0)]
    scene = make_scene(
        places, kind=[0, 1, 1], radius_m=[100.0, 1.0], levels=levels, parent=[-1, 0, 0]
    )
    log = run(Fronts([0], [1, 2]), 3, scene=scene)
    assert log["drawn"].tolist() == [1, 1, 1]
    assert log["visible"].tolist() == [1, 1, 1]
    assert log["triangles"].tolist() == [10, 40, 40]


def test_a_front_that_draws_a_place_twice_fails(run: Run, tree: Scene) -> None:
    """A node below another that replaces it breaks the contract."""
    with pytest.raises(PolicyError, match=r"frame 0: ids: expected a front, got node 3 below"):
        run(Fronts([1, 2, 3]), scene=tree)


@pytest.mark.parametrize(("seconds", "expected"), [(0.5, 1), (0.5 + 2e-9, 0)])
def test_reversals_of_fronts_end_after_half_a_second(
    run: Run, tree: Scene, make_hardware: MakeHardware, seconds: float, expected: int
) -> None:
    """Refined in one frame and coarsened one frame of half a second later: just a reversal."""
    machine: Any = make_hardware({}, base_ms=1e-6, cpu_base_ms=seconds * 1e3)
    log = run(Fronts([0], [1, 2], [0]), 3, scene=tree, hardware=machine)
    assert log["toggles"].tolist() == [0, 1, 1]
    assert log["reversals"].tolist() == [0, 0, expected]
