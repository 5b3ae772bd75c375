"""What three objects, or a small tree, pay for changes of level, counted by hand."""

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.protocol import Capabilities, Policy
from lodbench.policies.selection import Selection
from lodbench.policies.view import View
from lodbench.sim.frame_log import FrameLog

Run = Callable[..., FrameLog]
MakePolicy = Callable[..., Policy]
MakeLevels = Callable[..., LevelTable]
MakeHardware = Callable[..., HardwareProfile]
THREE = [(-1.0, 0.0, -10.0), (0.0, 0.0, -10.0), (1.0, 0.0, -10.0)]


def test_three_objects_of_three_levels(
    run: Run, scripted: MakePolicy, make_levels: MakeLevels
) -> None:
    """Levels 0 and 1 are used first in frame 0, level 2 in frame 3; 36 bytes a triangle each."""
    policy = scripted([[0, 0, 1], [0, 1, 1], [0, 1, 1], [2, 0, 1], [2, 0, 1]])
    log = run(policy, 5, positions=THREE, levels=make_levels([(1000, 250, 50)]))
    assert log["levels_changed"].tolist() == [0, 1, 0, 2, 0]
    assert log["first_uses"].tolist() == [2, 0, 0, 1, 0]
    assert log["bytes_uploaded"].tolist() == [36 * 1250, 0, 0, 36 * 50, 0]
    assert not log["levels_extracted"].any()
    assert not log["triangles_changed"].any()


def test_three_continuous_objects(run: Run, scripted: MakePolicy, make_levels: MakeLevels) -> None:
    """A quarter of a collapse is no change; one collapse changes 6 triangles, and sends the set.

    First come three whole sets, of 1,000, 500 and 200 triangles, and the geometry of the type once.
    Then 998 triangles; then 600 from 500, 600 - 500³ / 600² = 252.8, while 0.2004 is 0.2.
    """
    policy = scripted(
        [[1.0, 0.5, 0.2], [0.9995, 0.5, 0.2], [0.998, 0.5, 0.2], [0.998, 0.6, 0.2004]]
    )
    levels = make_levels([(1000, 200)], continuous=True)
    log = run(policy, 5, positions=THREE, levels=levels)
    assert log["levels_extracted"].tolist() == [3, 0, 1, 1, 0]
    assert log["triangles_changed"].tolist() == [1700, 0, 6, 253, 0]
    assert log["levels_changed"].tolist() == [0, 0, 1, 1, 0]
    assert log["first_uses"].tolist() == [1, 0, 0, 0, 0]
    sent = [36 * 1000 + 12 * 1700, 0, 12 * 998, 12 * 600, 0]
    assert log["bytes_uploaded"].tolist() == sent


def test_what_changes_takes_time_on_both_processors(
    run: Run, scripted: MakePolicy, make_levels: MakeLevels, make_hardware: MakeHardware
) -> None:
    """One change of level: 0.5 ms of GPU and 0.25 of CPU; uploads 1 / 64 ms a KiB; all by hand."""
    prices = {"levels_changed": 0.5, "first_uses": 2.0, "bytes_uploaded": 2.0**-16}
    cpu = {"levels_changed": 0.25, "bytes_uploaded": 2.0**-17}
    hardware = make_hardware(prices, base_ms=4.0, cpu=cpu)
    free = make_hardware({}, base_ms=4.0)
    levels = make_levels([(1024, 256)])
    policy = scripted([[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 1, 1]])
    log = run(policy, 4, positions=THREE, levels=levels, hardware=hardware)
    gpu_ms = [4.0 + 2.0 + 36 / 64, 4.0 + 0.5 + 2.0 + 9 / 64, 4.0, 4.0 + 1.5]
    assert log["gpu_ms"].tolist() == gpu_ms
    base_ms = run(policy, 1, positions=THREE, levels=levels, hardware=free)["cpu_ms"][0]
    assert (log["cpu_ms"] - base_ms).tolist() == [36 / 128, 0.25 + 9 / 128, 0.0, 0.75]
    assert log["full_gpu_ms"].tolist() == [4.0] * 4
    unpriced = run(policy, 4, positions=THREE, levels=levels, hardware=free)
    assert unpriced["gpu_ms"].tolist() == [4.0] * 4
    assert unpriced["levels_changed"].tolist() == [0, 1, 0, 3]


class _Fronts:
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


def test_a_tree_pays_for_the_nodes_that_take_the_place_of_others(
    run: Run, make_scene: Callable[..., Scene], make_levels: MakeLevels
) -> None:
    """Root, children, two grandchildren, back: 2, 2, 1 and 1 nodes come; three types are new."""
    levels = make_levels([(10,), (40,), (100,)])
    scene = make_scene(
        [(0.0, 0.0, -10.0)] * 5, kind=[0, 1, 1, 2, 2], levels=levels, parent=[-1, 0, 0, 1, 1]
    )
    log = run(_Fronts([0], [1, 2], [3, 4, 2], [1, 2], [0]), 6, scene=scene)
    assert log["levels_changed"].tolist() == [0, 2, 2, 1, 1, 0]
    assert log["first_uses"].tolist() == [1, 1, 1, 0, 0, 0]
    assert log["bytes_uploaded"].tolist() == [360, 36 * 40, 3600, 0, 0, 0]
