"""Pictures of worst moments: what the camera saw when the first of a ranking did most work."""

import io
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress

from ...base.errors import InputError
from ...models.meshes.geometry import Geometry
from ...models.scene.scene import Scene
from ...sim.frame_log import FrameLog
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from ...traces.cameras.shared_screen import split
from ..metrics.measured_frames import MeasuredFrames
from .comparison import Comparison
from .comparison_parts import Conditions, PolicyResult, Span
from .replays import Place, Replays

FIRST = 3
"""Policies in the order of the answer whose worst moments have a picture, beside full detail."""

_FULL = "full"
_WIDTH_PX, _COLORS = 640, 128

Meshes = Callable[[], Geometry]
"""Reads one mesh for each row of a scene's level table, or none where its source has none."""


def pictured(policies: Sequence[PolicyResult]) -> tuple[str, ...]:
    """Return the labels whose worst moments are drawn, of policies in the order of the answer."""
    apart = [policy for policy in policies if policy.status == "ok" and policy.same_as is None]
    first = [policy.label for policy in apart if not policy.oracle][:FIRST]
    full = [policy.label for policy in apart if policy.name == _FULL]
    return tuple(dict.fromkeys((*first, *full)))


def has_one_camera(paths: Iterable[CameraTrace], options: ReplayOptions) -> bool:
    """Whether a picture can show what was seen: of several cameras none shows it all."""
    return options.eyes is None and all(len(split(path)) == 1 for path in paths)


def draw_moments(
    comparison: Comparison,
    replays: Replays,
    places: Iterable[Place],
    scene: Scene,
    meshes: Meshes,
) -> dict[str, bytes]:
    """Return a PNG by label of the frame of most work at each place that has a log with its levels.

    Without meshes, or where their file is gone by now, nodes are drawn as `node_triangles` says.
    """
    logged = [(place, replays[place].log) for place in places if place in replays]
    if not logged:
        return {}
    try:
        geometry = meshes()
    except (InputError, OSError):  # hours of replays are not lost for pictures
        geometry = ()
    if len(geometry) != len(scene.types.levels.error_m):  # nor if the file is another by now
        geometry = ()
    drawn: dict[str, bytes] = {}
    for place, log in logged:
        window_s = comparison.window_s[place.path]
        frame = None if log is None else _worst_frame(log, window_s)
        if log is None or frame is None:
            continue
        with suppress(MemoryError, ValueError):  # a picture costs no result either
            drawn[place.policy] = _draw(log, frame, scene, geometry, comparison.conditions)
    return drawn


def _worst_frame(log: FrameLog, window_s: Span) -> int | None:
    """Return the frame of most work, None where the log keeps no levels of it."""
    frames = MeasuredFrames(log, *window_s)
    frame = frames.first + int(frames.work_ms.argmax())
    return frame if log.levels is not None and frame < len(log.levels) else None


def _draw(
    log: FrameLog, frame: int, scene: Scene, geometry: Geometry, conditions: Conditions
) -> bytes:
    from ...render.pictures.scene_picture import draw_small
    from ...render.pictures.snapshot import recorded_snapshot

    height_px = round(_WIDTH_PX * conditions.height_px / conditions.width_px)
    height_px = min(max(1, height_px), 2 * _WIDTH_PX)
    shot = recorded_snapshot(scene, log, frame, (_WIDTH_PX, height_px), conditions.fovy_deg)
    written = io.BytesIO()
    draw_small(shot, geometry).quantize(_COLORS).save(written, format="PNG", optimize=True)
    return written.getvalue()
