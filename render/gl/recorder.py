"""Replay a trace on a real renderer, the policy in closed loop, and keep what was measured."""

import os
import platform
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import IntArray
from ...base.errors import InputError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...policies.protocol import Policy, why_not_applicable
from ...policies.shared.observer import watch
from ...sim.frame_log import FrameLog
from ...sim.machine.simulated_machine import Machine
from ...sim.replay import ReplayOptions, replay
from ...traces.cameras.camera_trace import CameraTrace
from .context import Device
from .opengl_machine import GlMachine

_FROM_LOG = {
    "projected_px": "shaded_samples",  # the simulator's count of them
    "levels_changed": "levels_changed",
    "objects_visited": "objects_visited",
    "comparisons": "comparisons",
    "iterations": "iterations",
    "x_m": "x_m",
    "y_m": "y_m",
    "z_m": "z_m",
}


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """A replay that was drawn.

    Attributes
    ----------
    frames : FrameLog
        As of a simulated replay, ``gpu_ms`` being the measured time of the whole frame.
    columns : dict of str to (n,) float64
        The render log: what the renderer counted and measured.
    doubt : str or None
        Why the timer query was not believed.
    """

    frames: FrameLog
    columns: dict[str, NDArray[np.float64]]
    doubt: str | None


def recorded_hardware(hardware: HardwareProfile, size_px: tuple[int, int]) -> HardwareProfile:
    """Return the profile as frames are recorded: one in flight, no screen, this size.

    Raises `InputError` if the size is not positive.
    """
    width, height = size_px
    screen = replace(hardware.display, mode="immediate", width_px=width, height_px=height)
    return replace(hardware, display=screen, frames_in_flight=1)


def check_policy(policy: Policy, scene: Scene, name: str) -> None:
    """Raise InputError, with the reason, unless a policy can be recorded in a scene."""
    reason = why_not_applicable(policy.capabilities, scene)
    if policy.capabilities.future:
        reason = "it sees the future, which a real machine does not show"
    if policy.capabilities.loader:
        reason = "it streams, and a recording has all meshes in memory"
    if reason is not None:
        raise InputError(f"{name}: expected a policy that can be recorded; {reason}")


def record(
    policy: Policy,
    scene: Scene,
    trace: CameraTrace,
    hardware: HardwareProfile,
    options: ReplayOptions,
    machine: Machine,
    measuring: GlMachine,
    *,
    name: str,
) -> Recording:
    """Replay `trace` on `machine`, in which `measuring` draws and measures, under `policy`.

    The policy sees the same `View` as in a simulated replay, and the measured times of the frames
    before.  Its own time is measured apart and is no part of the frame: what Python takes is not
    what an engine would.

    Parameters
    ----------
    hardware
        As of `recorded_hardware`; its cost model is what predictive policies go by.

    Raises
    ------
    InputError
        If the policy does not apply to the scene, or is an oracle.
    PolicyError
        If the policy breaks its contract.
    """
    check_policy(policy, scene, name)
    watched = watch(policy)
    log = replay(watched, scene, trace, hardware, options, name=name, machine=machine)
    columns = logged_columns(log) | measuring.rows() | {"policy_ms": np.array(watched.select_ms)}
    return Recording(log, columns, measuring.doubt)


def logged_columns(
    log: FrameLog, frames: slice | IntArray = slice(None)
) -> dict[str, NDArray[np.float64]]:
    """Return what a render log takes from the frame log, of all of its frames or some."""
    columns = {name: np.asarray(log[source])[frames] for name, source in _FROM_LOG.items()}
    return {"trace_s": log["input_ns"][frames] * 1e-9} | columns


def header_of(device: Device, about: dict[str, str], doubt: str | None) -> dict[str, str]:
    """Return what a render log says about itself: the device first, then `about`, then the date."""
    header = {"renderer": device.renderer, "driver": device.driver, "processor": _processor()}
    header |= about
    header["date"] = datetime.now(UTC).date().isoformat()
    if doubt is not None:
        header["gpu_ms"] = f"left out, {doubt}"
    return header


def _processor() -> str:
    """Return the processor's name and the number of its cores that the system has."""
    name = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.is_file():
        lines = info.read_text(encoding="utf-8", errors="replace").splitlines()
        processors = [
            line.partition(":")[2].strip() for line in lines if line.startswith("model name")
        ]
        name = processors[0] if processors else name
    return f"{name}, {os.cpu_count()} cores"
