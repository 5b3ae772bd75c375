"""Camera traces by name or by file, placed into the scene that they are replayed in."""

from dataclasses import replace
from pathlib import Path
from typing import Literal, get_args

from ...base.errors import InputError
from ...base.nearest_names import unknown_name
from ...models.scene.scene import Scene
from ...traces.cameras.camera_trace import CameraTrace
from ...traces.cameras.generators.generate import KINDS
from ...traces.cameras.generators.tour import EYE_M
from ...traces.cameras.place import Placement, fit_placement, place
from ...traces.cameras.read_trace import read_trace, split_spec
from .stages import find_stage

BUNDLED_TRACE = "tour"
GENERATED_S = 30.0
"""Length of a trace that is named by its kind of movement."""

Placing = Literal["shrink", "fit", "center", "none"]
"""How the trace of a file is put into a scene.

``shrink`` moves it to the middle and scales it down if it is larger than the scene, but never up,
since a scale multiplies speeds too; ``fit`` scales it to fill the scene; ``center`` only moves it;
``none`` leaves it alone.
"""


def load_trace(spec: str, scene: Scene, placing: str = "shrink") -> CameraTrace:
    """Return the bundled trace, a generated one by its kind, or that of a file, placed in a scene.

    Bundled scenes have ways and speeds of their own, see `stages`.

    Raises `InputError` if the name is unknown, or the file cannot be read or placed.
    """
    if placing not in get_args(Placing):
        raise InputError(f"place: expected {', '.join(get_args(Placing))}, got {placing}; name one")
    stage = find_stage(scene)
    if spec == BUNDLED_TRACE:
        return stage.tour()
    if spec in KINDS:
        return stage.move(spec, GENERATED_S)
    if not _names_a_file(spec):
        names = [BUNDLED_TRACE, *KINDS]
        raise InputError(f"trace: {unknown_name(spec, names, instead='a file')}")
    trace = read_trace(spec)
    if placing == "none":
        return trace
    ground = stage.ground_m
    placement = fit_placement(trace, center_m=ground, extent_m=stage.plan_m, eye_height_m=EYE_M)
    if placing == "center" or (placing == "shrink" and placement.scale > 1.0):
        low, high = trace.position_m.min(axis=0), trace.position_m.max(axis=0)
        x, y = ground[:2] - 0.5 * (low + high)[:2]
        z = ground[2] + EYE_M - float(low[2])
        placement = Placement(offset_m=(float(x), float(y), z))
    placed = place(trace, placement)
    if placement.scale == 1.0:
        return placed
    return replace(placed, name=f"{trace.name} at scale {placement.scale:.3g}")


def _names_a_file(spec: str) -> bool:
    path, _ = split_spec(spec)
    return path.exists() or path.suffix != "" or len(Path(spec).parts) > 1
