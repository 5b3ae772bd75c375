"""The picture that `lodbench scene info --picture` writes."""

from pathlib import Path
from typing import TYPE_CHECKING

from ...base.errors import InputError
from .scene_output import check_output

if TYPE_CHECKING:  # numpy is loaded by the command that needs it
    from ...models.scene.scene_catalog import OpenedScene

_LAST_FRAME = 1_000_000


def check_picture(out: Path, frame: int) -> None:
    """Raise InputError unless a picture can be written there, of a frame that can be."""
    check_output(out, ".png")
    if not 0 <= frame <= _LAST_FRAME:
        raise InputError(f"frame: expected 0 to {_LAST_FRAME}, got {frame}")


def draw_picture(
    opened: "OpenedScene",
    out: Path,
    trace: str,
    policy: str | None,
    frame: int,
    hardware: str,
    budget_ms: float | None,
) -> None:
    """Replay a policy up to a frame, and write the frame as the camera sees it."""
    from ...analysis.study.inputs import load_trace
    from ...models.machine.profile_catalog import load_hardware
    from ...policies.registry import parse_policy
    from ...render.pictures.scene_picture import draw_snapshot, write_picture
    from ...render.pictures.snapshot import take_snapshot
    from ...sim.replay import ReplayOptions

    scene, profile = opened.scene, load_hardware(hardware)
    spec = parse_policy(policy or ("static-screen" if scene.flat else "screen-space-error"))
    options = ReplayOptions(budget_ms=profile.budget_ms(budget_ms))
    shot = take_snapshot(spec, scene, load_trace(trace, scene), profile, options, frame)
    write_picture(out, draw_snapshot(shot, opened.read_geometry()))
