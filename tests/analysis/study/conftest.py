"""A small world to compare in."""

from collections.abc import Sequence
from dataclasses import replace

import pytest

from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.comparison_folder import Compared
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.camera_trace import CameraTrace

REPLAY = ReplayOptions(budget_ms=8.0, seed=3)
ONE = CompareSettings(workers=1, draws=0, warmup_s=0.5, seeds=1)


class World:
    """The small world, so that a test names only what it is about."""

    def __init__(self, scene: Scene, trace: CameraTrace, machine: HardwareProfile) -> None:
        self.scene, self.trace, self.machine = scene, trace, machine

    def compare(
        self,
        *policies: str,
        settings: CompareSettings = ONE,
        replay: ReplayOptions = REPLAY,
        machine: HardwareProfile | None = None,
        paths: Sequence[CameraTrace] = (),
    ) -> Compared:
        """Compare policies, on the turn alone unless told."""
        specs = [parse_policy(text) for text in policies]
        on = paths or [self.trace]
        return compare(specs, self.scene, on, machine or self.machine, replay, settings)

    def short_paths(self, count: int) -> list[CameraTrace]:
        """Return so many paths of half a second, each of which turns to the objects later."""
        return [
            replace(self.trace.stretch(0.9 - 0.02 * at, 1.4 - 0.02 * at), name=f"path {at}")
            for at in range(count)
        ]


@pytest.fixture(scope="module")
def world(small_scene: Scene, turn_trace: CameraTrace, machine: HardwareProfile) -> World:
    """Return the small world."""
    return World(small_scene, turn_trace, machine)
