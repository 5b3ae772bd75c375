"""A camera path from above, with the objects of its scene."""

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from ...base.arrays import FloatArray
from ...base.files.whole_file import whole_file
from ...models.scene.scene import Scene
from ...traces.cameras.camera_trace import CameraTrace
from ...traces.cameras.orientation import view_direction

SIZE_PX, _EDGE_PX = 900, 40
_GAZES = 24
_GAZE_PX = 22.0
_OBJECT, _PATH, _GAZE, _START, _END = "#c9ced6", "#0072B2", "#D55E00", "#009E73", "#000000"


def draw_path(trace: CameraTrace, scene: Scene | None, path: Path) -> None:
    """Write a PNG of a path seen from above, north up: where it starts, ends, and looks.

    Parameters
    ----------
    scene
        Whose objects are drawn as discs of their bounding spheres; None for the path alone.
    """
    plan = trace.position_m[:, :2]
    shown = plan if scene is None else np.vstack((plan, scene.center_m[:, :2]))
    low, high = shown.min(axis=0), shown.max(axis=0)
    scale = (SIZE_PX - 2 * _EDGE_PX) / max(float((high - low).max()), 1e-6)
    middle = 0.5 * (low + high)

    def to_px(points: FloatArray) -> FloatArray:
        return SIZE_PX / 2.0 + (points - middle) * (scale, -scale)

    image = Image.new("RGB", (SIZE_PX, SIZE_PX), "white")
    draw = ImageDraw.Draw(image)
    if scene is not None:
        radii = np.maximum(1.0, scene.radius_m * scale)
        for (x, y), r in zip(to_px(scene.center_m[:, :2]).tolist(), radii.tolist(), strict=True):
            draw.ellipse((x - r, y - r, x + r, y + r), fill=_OBJECT)
    line = to_px(plan)
    for part in np.split(line, np.flatnonzero(trace.cut)):  # no line across a teleport
        if len(part) > 1:
            draw.line([tuple(point) for point in part.tolist()], fill=_PATH, width=3)
    ahead = view_direction(trace.orientation_xyzw)[:, :2] * (1.0, -1.0)
    for at in np.linspace(0, len(line) - 1, min(_GAZES, len(line))).astype(int):
        tip = line[at] + _GAZE_PX * ahead[at]
        draw.line([tuple(line[at].tolist()), tuple(tip.tolist())], fill=_GAZE, width=2)
    for (x, y), colour in ((line[0].tolist(), _START), (line[-1].tolist(), _END)):
        draw.ellipse((x - 6, y - 6, x + 6, y + 6), fill=colour)
    width_m = float((high - low).max())
    draw.text(
        (_EDGE_PX / 2, SIZE_PX - 24),
        f"{width_m:.3g} m across; starts green, ends black, looks along orange",
        fill="#333333",
    )
    with whole_file(path) as partial:
        image.save(partial, format="PNG")
