"""The page of a viewer: scene, meshes and replays of policies in a file that loads nothing."""

import json
import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...models.meshes.geometry import Geometry
from ...models.scene.scene import Scene
from ...models.scene.tree import relative_depth
from ...sim.frame_log import FrameLog
from ...sim.level_history import HIDDEN, LevelHistory
from ...sim.sight import picture_size
from ..metrics.measured_frames import MeasuredFrames
from ..report.names import short_name
from ..report.page_template import page_template
from ..report.summary import describe_run, shown_policies, words_of
from ..study.comparison_folder import Compared
from ..study.comparison_parts import Conditions
from .packed_arrays import pack_arrays
from .view_meshes import ViewMeshes, choose_meshes

POLICIES = 4
"""Policies that a page holds unless some are named: the first of the ranking."""

_HERE = Path(__file__).parent
_ADVICE = "run `lodbench compare --out` again"


def render_view(
    compared: Compared, geometry: Geometry = (), labels: Sequence[str] = (), note: str = ""
) -> str:
    """Return the HTML of a viewer; the same comparison gives the same bytes.

    Parameters
    ----------
    geometry
        One mesh for each row of the scene's level table; without it nodes are spheres.
    labels
        Of the policies to show, in this order; without them the first of the ranking.
    note
        What to say of the meshes.

    Raises
    ------
    InputError
        If the comparison keeps no levels, or has no such policy.
    """
    scene, kept = require_levels(compared, labels)
    for _, _, levels in kept:
        levels.require_nodes(scene)
    finest = scene.finest_row
    rows = [
        finest[levels.node[there]] + levels.level[there]
        for _, _, levels in kept
        for there in [levels.level != HIDDEN]
    ]
    meshes = choose_meshes(scene, geometry, np.concatenate(rows))
    arrays = _scene_arrays(scene) | {"mesh_of_row": meshes.mesh_of_row} | meshes.arrays
    for at, (_, log, levels) in enumerate(kept):
        arrays |= {f"p{at}/{name}": each for name, each in _replay(scene, log, levels).items()}
    data, places = pack_arrays(arrays)
    comparison = compared.comparison
    width_px, height_px = _picture_px(comparison.conditions)
    head = {
        "arrays": places,
        "boxes": meshes.boxes,
        "types": [short_name(name) for name in scene.types.names],
        "policies": [short_name(label) for label, _, _ in kept],
        "budget_ms": comparison.budget_ms,
        "refresh_hz": comparison.conditions.refresh_hz,
        "fovy_deg": comparison.conditions.fovy_deg,
        "aspect": width_px / height_px,
    }
    title = words_of(comparison, f"{comparison.scene} along {comparison.paths[0]}")
    return page_template("view.html", _HERE / "templates").render(
        title=title,
        subtitle=words_of(comparison, describe_run(comparison)),
        note=" ".join(
            filter(None, (note, _whose(comparison.conditions), _cut(meshes), _ends(kept)))
        ),
        head=json.dumps(head).replace("<", "\\u003c"),
        data=data,
        three=_three(),
        three_license=(_HERE / "three" / "LICENSE").read_text(encoding="utf-8"),
    )


_Kept = tuple[str, FrameLog, LevelHistory]


def require_levels(compared: Compared, labels: Sequence[str]) -> tuple[Scene, list[_Kept]]:
    """Return the scene and what is kept of policies: those named, or the first of the ranking.

    Raises `InputError` as `render_view`.
    """
    known = {p.label: compared.logs[p.label] for p in shown_policies(compared.comparison)}
    for label in labels:
        if label not in known:
            names = ", ".join(map(short_name, known)) or "none"
            raise InputError(f"policy: expected one of {names}, got {short_name(label)}")
    wanted = labels or list(known)
    kept = [(label, known[label], levels) for label in wanted
            if (levels := known[label].levels) is not None]  # fmt: skip
    if compared.scene is None or not kept:
        raise InputError(f"expected frame logs that keep levels, got none; {_ADVICE}")
    return compared.scene, kept if labels else kept[:POLICIES]


def _scene_arrays(scene: Scene) -> dict[str, NDArray[Any]]:
    """Return nodes and level table as a viewer needs them, in metres."""
    arrays: dict[str, NDArray[Any]] = {
        "type": scene.type_index,
        "position_m": scene.position_m.astype(np.float32),
        "turn_xyzw": scene.orientation_xyzw.astype(np.float32),
        "scale": scene.scale.astype(np.float32),
        "center_m": scene.center_m.astype(np.float32),
        "radius_m": scene.radius_m.astype(np.float32),
        "first_row": scene.types.levels.start[:-1].astype(np.int32),
        "levels": scene.types.levels.level_count.astype(np.int32),
        "depth": relative_depth(scene).astype(np.float32),
    }
    if scene.motion is not None:
        motion = scene.motion
        arrays |= {
            "moving": motion.node,
            "circle": np.column_stack((motion.radius_m, motion.rate_rad_s, motion.phase_rad))
            .astype(np.float32),
        }  # fmt: skip
    return arrays


def _replay(scene: Scene, log: FrameLog, levels: LevelHistory) -> dict[str, NDArray[Any]]:
    """Return the frames of a replay whose levels are kept, and what changes in each."""
    frames = len(levels)
    place = np.column_stack([log[name][:frames] for name in ("x_m", "y_m", "z_m")])
    return {
        "time_s": (1e-9 * log["input_ns"][:frames]).astype(np.float32),
        "work_ms": MeasuredFrames(log).work_ms[:frames].astype(np.float32),
        "camera_m": place.astype(np.float32),
        "camera_turn": levels.turn_xyzw.astype(np.float32),
        "start": levels.start.astype(np.int32),
        "node": levels.node,
        "level": levels.level,
        "switch": levels.switches(scene).astype(np.uint8),
    }


def _picture_px(conditions: Conditions) -> tuple[int, int]:
    screen_px = (conditions.width_px, conditions.height_px)
    return picture_size(screen_px, conditions.players, conditions.eyes)


def _whose(conditions: Conditions) -> str:
    """Return whose picture is shown, where there are several."""
    if conditions.eyes is not None:
        return "The picture is that of the head, between its two eyes."
    if conditions.players > 1:
        return (
            f"The picture is that of the first of {conditions.players} players; what the others "
            "see is drawn too, and coloured from above."
        )
    return ""


def _cut(meshes: ViewMeshes) -> str:
    """Return what of the meshes is not shown."""
    if not meshes.wanted:
        return "Objects are spheres of six tenths of their bounding spheres."
    if meshes.own == meshes.wanted:
        return ""
    return (
        f"Of {meshes.wanted} levels that are drawn, {meshes.own} are shown by their own mesh; the "
        "others, the largest, by a coarser one or a sphere, since a page has room for 8 MB."
    )


def _ends(kept: Sequence[_Kept]) -> str:
    full = [short_name(label) for label, log, levels in kept if len(levels) < len(log)]
    return f"The record of {', '.join(full)} ends early, where it is full." if full else ""


@cache
def _three() -> str:
    """Return three.js as an expression: the object of all that the module exports."""
    text = (_HERE / "three" / "three.module.min.js").read_text(encoding="utf-8")
    found = re.search(r"export\{([^{}]*)\};?\s*$", text)
    if found is None:
        raise ValueError("expected a module that ends with what it exports")
    pairs = (each.split(" as ") for each in found.group(1).split(","))
    exports = ",".join(f"{pair[-1].strip()}:{pair[0].strip()}" for pair in pairs)
    return f"(()=>{{{text[: found.start()]}\nreturn{{{exports}}}}})()"
