"""What is replayed, by name, by file, or as it is; traces are placed into their scene."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any, Literal, TypeAlias, get_args

from ...base.errors import InputError, text_of
from ...base.nearest_names import unknown_name
from ...models.machine.hardware import HardwareProfile
from ...models.machine.profile_catalog import load_hardware
from ...models.meshes.geometry import Geometry
from ...models.scene.rig import Eyes
from ...models.scene.scene import Scene
from ...models.scene.scene_catalog import load_scene, open_scene
from ...traces.cameras.camera_trace import CameraTrace
from ...traces.cameras.generators.generate import KINDS
from ...traces.cameras.generators.tour import EYE_M
from ...traces.cameras.place import Placement, fit_placement
from ...traces.cameras.place import place as place_trace
from ...traces.cameras.read_trace import read_trace, split_spec
from .stages import find_stage

BUNDLED_TRACE = "tour"
GENERATED_S = 30.0
"""Most length of a trace that is named by its kind of movement."""

Placing = Literal["shrink", "fit", "center", "none"]
"""How the trace of a file is put into a scene.

``shrink`` moves it to the middle and scales it down if it is larger than the scene, but never up,
since a scale multiplies speeds too; ``fit`` scales it to fill the scene; ``center`` only moves it;
``none`` leaves it alone.
"""


SceneLike: TypeAlias = str | PathLike[str] | Scene
TraceLike: TypeAlias = str | PathLike[str] | CameraTrace
HardwareLike: TypeAlias = str | PathLike[str] | HardwareProfile
EyesLike: TypeAlias = float | Eyes | None
"""Two eyes, or how many metres they are apart; None for one camera."""


Seconds: TypeAlias = tuple[float, float | None]
"""Start and end of a stretch of a path, None for the path's end; see `CameraTrace.stretch`."""

WHOLE: Seconds = (0.0, None)


def parse_seconds(text: object) -> Seconds:
    """Return the stretch that ``A:B``, ``A:`` or ``:B`` names.

    Raises `InputError` if it is none of these.
    """
    start, colon, end = str(text).partition(":")
    try:
        if colon:
            return float(start or 0.0), float(end) if end.strip() else None
    except ValueError:
        pass
    raise InputError(
        f"seconds: expected A:B, A: or :B in seconds of the path, got {text!r}; such as 5:20"
    )


def as_scene(scene: SceneLike) -> Scene:
    """Return a scene, loaded if it is named; raises InputError as `load_scene` does."""
    return load_scene(scene)


def read_meshes(scene: SceneLike) -> Geometry:
    """Return the meshes of a scene's levels, none of one that was made of arrays.

    Raises InputError as `open_scene` does.
    """
    if isinstance(scene, Scene):
        return ()
    return open_scene(text_of(scene, "scene", Scene)).read_geometry()


def as_trace(trace: TraceLike, scene: SceneLike, place: str = "shrink") -> CameraTrace:
    """Return a trace, loaded and placed if it is named; raises InputError as `load_trace` does."""
    return load_trace(trace, scene, place)


def as_hardware(hardware: HardwareLike) -> HardwareProfile:
    """Return a profile, loaded if it is named; raises InputError as `load_hardware` does."""
    return load_hardware(hardware)


def as_eyes(eyes: EyesLike) -> Eyes | None:
    """Return the eyes that a distance stands for; raises InputError as `Eyes` does."""
    return eyes if eyes is None or isinstance(eyes, Eyes) else Eyes(apart_m=eyes)


def load_trace(name_or_path: TraceLike, scene: SceneLike, place: str = "shrink") -> CameraTrace:
    """Return the bundled trace, a generated one by its kind, or that of a file, placed in a scene.

    A trace is returned as it is.  `place` is one of `Placing`.  Bundled scenes have ways and speeds
    of their own, see `stages`.

    Raises `InputError` if a name is unknown, or the file cannot be read or placed.
    """
    return load_trace_by(read_trace, name_or_path, scene, place)


def made_length_s(kind: str) -> float:
    """Return how long a trace is that is named by its kind of movement."""
    return min(GENERATED_S, KINDS[kind].length_s)


def load_trace_by(
    read: Callable[[str], CameraTrace], name_or_path: TraceLike, scene: SceneLike, place: str
) -> CameraTrace:
    """Return a trace as `load_trace` does, where `read` may know the files that it has read."""
    if place not in get_args(Placing):
        raise InputError(f"place: expected {', '.join(get_args(Placing))}, got {place}; name one")
    if isinstance(name_or_path, CameraTrace):
        return name_or_path
    spec = text_of(name_or_path, "trace", CameraTrace)
    stage = find_stage(as_scene(scene))
    if spec == BUNDLED_TRACE:
        return stage.tour()
    if spec in KINDS:
        return stage.move(spec, made_length_s(spec))
    if not _names_a_file(spec):
        names = [BUNDLED_TRACE, *KINDS]
        raise InputError(f"trace: {unknown_name(spec, names, instead='a file')}")
    trace = read(spec)
    if place == "none":
        return trace
    ground = stage.ground_m
    placement = fit_placement(trace, center_m=ground, extent_m=stage.plan_m, eye_height_m=EYE_M)
    if place == "center" or (place == "shrink" and placement.scale > 1.0):
        low, high = trace.position_m.min(axis=0), trace.position_m.max(axis=0)
        x, y = ground[:2] - 0.5 * (low + high)[:2]
        z = ground[2] + EYE_M - float(low[2])
        placement = Placement(offset_m=(float(x), float(y), z))
    placed = place_trace(trace, placement)
    if placement.scale == 1.0:
        return placed
    return replace(placed, name=f"{trace.name} at scale {placement.scale:.3g}")


def adjust_machine(
    profile: HardwareProfile,
    display: str | None,
    refresh_hz: float | None,
    frames_in_flight: int | None,
    pacing: str | None = None,
    latency_limit: int | None = None,
) -> HardwareProfile:
    """Return a profile with what is wanted otherwise; None leaves it as it is.

    Raises `InputError` if the display or the pipeline cannot be so.
    """
    wanted: dict[str, Any] = {
        "mode": display,
        "refresh_hz": refresh_hz,
        "pacing": pacing,
        "latency_limit": latency_limit,
    }
    changes = {key: value for key, value in wanted.items() if value is not None}
    if refresh_hz is not None and refresh_hz > 0.0:  # a slower display's range goes with it
        changes["vrr_min_hz"] = min(profile.display.vrr_min_hz, refresh_hz)
    in_flight = profile.frames_in_flight if frames_in_flight is None else frames_in_flight
    screen = replace(profile.display, **changes)
    return replace(profile, display=screen, frames_in_flight=in_flight)


def _names_a_file(spec: str) -> bool:
    path, _ = split_spec(spec)
    with suppress(OSError):  # a name may be too long for one of a file
        if path.exists():
            return True
    return path.suffix != "" or len(Path(spec).parts) > 1
