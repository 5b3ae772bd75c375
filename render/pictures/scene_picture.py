"""A frame as a picture: shaded triangles, coloured by level of detail, with a legend."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...base.files.whole_file import whole_file
from ...models.meshes.geometry import Geometry
from ...models.scene.camera import Camera
from .raster import Canvas
from .snapshot import Snapshot
from .triangles import fineness, node_triangles, rows_as_seen

if TYPE_CHECKING:
    from PIL.Image import Image

_SAMPLES = 2  # along each axis of a pixel
_SEEN_PER_PX = 2.0  # triangles: one on the side that is seen, and one behind it
_MOST_TRIANGLES = 3_000_000  # of a small picture, which take some ten seconds
_LIGHT = np.array((-0.45, -0.35, 0.82))  # towards the light, in the scene
# Five points of the viridis colour map (van der Walt and Smith), coarse to fine.
_RAMP = (
    np.array(((68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37))) / 255.0
)
_SKY = np.array(((0.62, 0.72, 0.84), (0.93, 0.95, 0.97)))  # above, at the horizon
_GROUND = np.array(((0.83, 0.83, 0.80), (0.60, 0.61, 0.58)))  # at the horizon, below


def draw_snapshot(shot: Snapshot, geometry: Geometry) -> "Image":
    """Return the frame as the camera sees it, with what it shows written below."""
    fine = fineness(shot)
    picture, count = _draw(shot, geometry, fine)
    _write_legend(picture, shot, fine, count)
    return picture


def draw_small(shot: Snapshot, geometry: Geometry) -> "Image":
    """Return the frame as the camera sees it, without a word in it, in some seconds.

    A node whose triangles are too small to be seen apart is drawn by a coarser mesh, in the colour
    of the level that it is drawn at.  Where even these are too many, all are drawn as without
    geometry (see `node_triangles`).
    """
    row, count = rows_as_seen(shot, geometry, _SEEN_PER_PX) if geometry else (None, 0)
    meshes = geometry if count <= _MOST_TRIANGLES else ()
    return _draw(shot, meshes, fineness(shot), row)[0]


def _draw(
    shot: Snapshot, geometry: Geometry, fine: FloatArray, row: IntArray | None = None
) -> "tuple[Image, int]":
    """Return the picture and how many triangles it was drawn from."""
    from PIL import Image

    camera = shot.camera
    canvas = Canvas(_background(camera))
    color = _colors(fine)
    light = camera.axes @ (_LIGHT / np.linalg.norm(_LIGHT))
    count = 0
    for corner, node in node_triangles(shot, geometry, row):
        count += len(node)
        corner, node = _clip(corner, node, camera.near_m)  # noqa: PLW2901 - what is left of them
        canvas.draw(_project(corner, camera), _shade(corner, color[node], light))
    pixels = (np.clip(canvas.color, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
    size = (camera.width_px, camera.height_px)
    picture: Image.Image = Image.fromarray(pixels).resize(size, Image.Resampling.BOX)
    return picture, count


def write_picture(path: Path, picture: "Image") -> None:
    """Write a picture; the file appears whole or not at all."""
    with whole_file(path) as partial:
        picture.save(partial, format="PNG")


def _background(camera: Camera) -> FloatArray:
    """Return sky and ground, which meet at the horizon."""
    width, height = camera.width_px * _SAMPLES, camera.height_px * _SAMPLES
    y, x = np.mgrid[0:height, 0:width] + 0.5
    right = (x / _SAMPLES - camera.width_px / 2.0) / camera.focal_px
    up = (camera.height_px / 2.0 - y / _SAMPLES) / camera.focal_px
    vertical = right * camera.axes[0, 2] + up * camera.axes[1, 2] + camera.axes[2, 2]
    rise = vertical / np.sqrt(1.0 + right**2 + up**2)
    above = np.clip(rise / 0.5, 0.0, 1.0)[..., None]
    below = np.clip(-rise / 0.6, 0.0, 1.0)[..., None]
    sky = _SKY[1] + above * (_SKY[0] - _SKY[1])
    ground = _GROUND[0] + below * (_GROUND[1] - _GROUND[0])
    ground[rise > 0.0] = sky[rise > 0.0]
    return ground


def _colors(fine: FloatArray) -> FloatArray:
    at = np.linspace(0.0, 1.0, len(_RAMP))
    return np.stack([np.interp(fine, at, _RAMP[:, i]) for i in range(3)], axis=1)


def _clip(corner: FloatArray, node: IntArray, near_m: float) -> tuple[FloatArray, IntArray]:
    """Return what of the triangles lies before the near plane."""
    behind = corner[:, :, 2] < near_m
    count = behind.sum(axis=1)
    parts, nodes = [corner[count == 0]], [node[count == 0]]
    for number in (1, 2):
        rows = np.flatnonzero(count == number)
        odd = behind[rows] if number == 1 else ~behind[rows]
        turn = (odd.argmax(axis=1)[:, None] + np.arange(3)) % 3
        a, b, c = (
            np.take_along_axis(corner[rows], turn[..., None], axis=1)[:, i] for i in range(3)
        )
        m, n = _at_depth(a, b, near_m), _at_depth(a, c, near_m)
        if number == 2:
            parts.append(np.stack((a, m, n), axis=1))
            nodes.append(node[rows])
        else:
            parts += [np.stack((m, b, c), axis=1), np.stack((m, c, n), axis=1)]
            nodes += [node[rows], node[rows]]
    return np.concatenate(parts), np.concatenate(nodes)


def _at_depth(a: FloatArray, b: FloatArray, depth: float) -> FloatArray:
    share = (depth - a[:, 2:]) / (b[:, 2:] - a[:, 2:])
    return a + share * (b - a)


def _project(corner: FloatArray, camera: Camera) -> FloatArray:
    """Return pixel x, pixel y (downwards) and depth, (n, 3, 3)."""
    depth = corner[:, :, 2:]
    plane = corner[:, :, :2] * (camera.focal_px / depth) * (1.0, -1.0)
    middle = (camera.width_px / 2.0, camera.height_px / 2.0)
    return np.concatenate(((plane + middle) * _SAMPLES, depth), axis=2)


def _shade(corner: FloatArray, color: FloatArray, light: FloatArray) -> FloatArray:
    """Return colours under one light from above and an even sky; both sides are lit alike."""
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    length = np.linalg.norm(normal, axis=1)
    facing = np.einsum("ij,ij->i", normal, corner[:, 0]) > 0.0  # its other side is seen
    cosine = np.where(facing, -1.0, 1.0) * (normal @ light) / np.maximum(length, 1e-30)
    brightness = 0.68 + 0.32 * cosine
    return color * brightness[:, None]


def _write_legend(picture: "Image", shot: Snapshot, fine: FloatArray, triangles: int) -> None:
    """Write what is shown, and the colours with how many nodes have each, at the lower edge."""
    from PIL import ImageDraw, ImageFont

    draw: Any = ImageDraw.Draw(picture, "RGBA")
    width, height = picture.size
    unit = max(10, height // 50)
    font: Any = ImageFont.load_default(size=unit)
    top = height - 3 * unit
    draw.rectangle((0, top, width, height), fill=(18, 20, 26, 200))
    text = (
        f"{shot.scene.name}   {shot.label}   frame {shot.frame}   "
        f"{len(shot.ids):,} nodes drawn, {triangles:,} triangles"
    )
    draw.text((unit, top + unit), text, font=font, fill=(240, 240, 240, 255))
    bar = max(1, width // 5)
    left = width - bar - 6 * unit
    steps = 64
    share = np.histogram(fine, bins=steps, range=(0.0, 1.0))[0]
    tall = np.sqrt(share / max(1, int(share.max())))  # so that the few fine ones show too
    for i, color in enumerate((_colors(np.linspace(0.0, 1.0, steps)) * 255).astype(int).tolist()):
        x = left + i * bar / steps
        base = height - 0.7 * unit
        draw.rectangle((x, base - 0.5 * unit, x + bar / steps, base), fill=(*color, 255))
        high = base - 0.6 * unit - 1.2 * unit * float(tall[i])
        draw.rectangle((x, high, x + bar / steps, base - 0.6 * unit), fill=(*color, 255))
    draw.text((left - 5 * unit, height - 1.6 * unit), "coarsest", font=font, fill=(200, 200, 200))
    draw.text((left + bar + unit, height - 1.6 * unit), "finest", font=font, fill=(200, 200, 200))
