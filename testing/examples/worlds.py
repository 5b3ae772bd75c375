"""Strategies of examples: the worlds that the properties are tried in."""

import numpy as np
from hypothesis import strategies as st

from ...models.machine.frame_cost import FrameCost
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...policies.protocol import Capabilities
from ...traces.cameras.camera_trace import CameraTrace
from ...traces.cameras.orientation import look_along
from .example import Example
from .strategies import hardware_profiles, scenes, traces

_EYE_M = 1.65
_STEP_S = 5e-5  # after the first frame has begun, before the second


def moving(capabilities: Capabilities, _rest: int) -> st.SearchStrategy[Example]:
    """Return examples of 1 to 10 frames with a camera that moves."""
    return _examples(capabilities, traces(), st.integers(1, 10))


def resting(
    capabilities: Capabilities, rest: int, more: tuple[int, int] = (2, 6)
) -> st.SearchStrategy[Example]:
    """Return examples in which nothing moves, of some frames more than it takes to rest."""
    frames = st.integers(rest + more[0], rest + more[1])
    return _examples(capabilities, st.just(_camera((0.0,))), frames)


def stepping(capabilities: Capabilities, rest: int) -> st.SearchStrategy[Example]:
    """Return examples whose camera looks away in the first frame, then at the scene."""
    paths = st.just(_camera((np.pi, 0.0)))
    return _examples(capabilities, paths, st.integers(rest + 3, rest + 6))


def _camera(heading_rad: tuple[float, ...]) -> CameraTrace:
    """Return a camera at the origin that is cut from one heading to the next."""
    n = len(heading_rad)
    return CameraTrace(
        "example",
        np.linspace(0.0, _STEP_S, n) if n > 1 else np.zeros(1),
        np.tile((0.0, 0.0, _EYE_M), (n, 1)),
        look_along(heading_rad, np.zeros(n)),
        np.arange(n) > 0,
    )


def _scenes(capabilities: Capabilities) -> st.SearchStrategy[Scene]:
    """Return the scenes that a policy can drive, the simplest kind first."""
    kinds: list[st.SearchStrategy[Scene]] = []
    if capabilities.levels:
        kinds.append(scenes())
    if capabilities.continuous and not capabilities.levels:
        kinds.append(scenes(continuous=True))
    if capabilities.hierarchy:
        kinds.append(scenes(objects=3, hierarchy=True))
    return st.one_of(kinds)


@st.composite
def _examples(
    draw: st.DrawFn,
    capabilities: Capabilities,
    paths: st.SearchStrategy[CameraTrace],
    frames: st.SearchStrategy[int],
) -> Example:
    machine: HardwareProfile = draw(hardware_profiles(noise=False))
    scene: Scene = draw(_scenes(capabilities))
    # Never a sum of costs, so that the order of additions decides nothing.
    share = (draw(st.integers(0, 20)) + 1.0 / 7.0) / 16.0
    budget_ms = machine.gpu.base_ms + share * _full_ms(scene, machine)
    return Example(scene, draw(paths), machine, budget_ms, draw(frames))


def _full_ms(scene: Scene, machine: HardwareProfile) -> float:
    """Return the time of all nodes at their finest, wherever they are."""
    levels = scene.types.levels
    level_ms = FrameCost(machine.gpu, levels).level_ms
    return float(level_ms[levels.start[:-1]][scene.type_index].sum())
