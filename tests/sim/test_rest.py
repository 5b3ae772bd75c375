"""A camera that comes to rest: what does not change costs nothing, in the papers' scenes.

Poses turn and move by amounts that no binary fraction holds, so that an interpolation that rounds
would move the camera by a last bit in every frame.
"""

from dataclasses import replace

import numpy as np
import pytest

from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.machine.residual import Residual
from lodbench.models.scene.extent import scene_extent
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.policies.policy_spec import PolicySpec
from lodbench.policies.protocol import claims_of, why_not_applicable
from lodbench.policies.registry import REGISTERED, parse_policy
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace

QUICK, SLOW = ("crowd-512", "plaza"), ("ogres", "ogres-trees", "atlas", "city")
REST_S, FRAMES_AT_REST = 0.11, 6
UNCHANGED = ("levels_changed", "first_uses", "levels_extracted", "triangles_changed",
             "bytes_uploaded", "levels_borrowed", "toggles", "popping_px")  # fmt: skip


def resting_policies(scene: Scene) -> list[tuple[PolicySpec, int]]:
    """Return the policies that claim to come to rest in a scene, and after how many frames.

    LODManager does so where its feedback is off; gobbetti's own solver takes seconds a frame.
    """
    found: list[tuple[PolicySpec, int]] = []
    for name in (*REGISTERED, "lodmanager:gain=1"):
        spec = parse_policy(name)
        policy = spec.make()
        frames = 1 if name == "lodmanager:gain=1" else claims_of(policy).settles_frames
        slow = name == "gobbetti-custom"
        if frames is not None and not slow and not why_not_applicable(policy.capabilities, scene):
            found.append((spec, frames))
    return found


def stopping_path(scene: Scene) -> CameraTrace:
    """Return a camera at the scene's edge that moves and turns a little, and then stands."""
    center_m, size_m = scene_extent(scene)
    start = center_m + np.array((0.0, -0.37 * size_m[1], 0.1 * size_m[2] + 1.7))
    step = 0.013 * size_m
    # Looking north and 10 degrees down, then turned by another 3 degrees.
    half = np.radians((80.0, 77.0, 77.0, 77.0)) / 2.0
    turns = np.stack((np.sin(half), 0.0 * half, 0.0 * half, np.cos(half)), axis=1)
    positions = np.stack((start, start + step, start + step, start + step))
    times = np.array((0.0, REST_S, 0.7, 60.0))
    return CameraTrace("stopping", times, positions, turns, np.zeros(4, dtype=np.bool_))


@pytest.mark.parametrize("name", [*QUICK, *(pytest.param(n, marks=pytest.mark.slow) for n in SLOW)])
def test_a_camera_at_rest_pays_for_no_change(name: str) -> None:
    """No level changed, extracted or uploaded, and every frame takes the CPU as long to the bit."""
    scene, hardware = load_scene(name), load_hardware("desktop-assumed")
    # A disk so fast that nothing is still being read when the camera stands.
    hardware = replace(
        hardware, gpu_residual=Residual(), cpu_residual=Residual(), disk_bytes_per_s=1e14
    )
    trace, policies = stopping_path(scene), resting_policies(scene)
    assert len(policies) >= 3
    for spec, settles in policies:
        frames = 13 + settles + FRAMES_AT_REST
        options = ReplayOptions(budget_ms=6.0, frames=frames)
        log = replay(spec.make(), scene, trace, hardware, options, name=spec.label)
        still = np.flatnonzero(log["input_ns"] >= REST_S * 1e9)[settles + 1 :]
        assert len(still) >= FRAMES_AT_REST - 1, spec.label
        assert log["drawn"][still].min() > 0, spec.label
        for column in UNCHANGED:
            assert not log[column][still].any(), (spec.label, column, log[column].tolist())
        assert np.ptp(log["cpu_ms"][still]) == 0.0, (spec.label, log["cpu_ms"].tolist())
