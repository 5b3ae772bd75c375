"""One frame, ready to be drawn: which levels where, sorted, with all that is uploaded for it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray
from ...models.scene.camera import Camera
from ...models.scene.scene import Scene
from .instances import bone_palette, farthest_m, placements, projection
from .mesh_buffers import Meshes
from .shaders import BONES

_GOLDEN = 0.618034  # neighbours by number come to lie far apart


@dataclass(frozen=True, slots=True)
class Picture:
    """What one frame is to show.

    Attributes
    ----------
    centers_m : (3, N) float64
        Centres of all nodes.
    ids : (m,) int32
        Nodes drawn.
    row : (m,) int64
        Row of the level table that each is drawn at.
    distance_m : (m,) float64
        From the eye; of one level the near ones are drawn first.
    size_px : width and height
    mixed :
        Whether objects are drawn one by one in an order that mixes types, not sorted by them.
    upload_bytes :
        What else goes to the device, as a level's geometry does when it is first drawn.
    """

    camera: Camera
    centers_m: FloatArray
    ids: IntArray
    row: NDArray[np.int64]
    distance_m: FloatArray
    time_s: float
    size_px: tuple[int, int]
    mixed: bool = False
    upload_bytes: int = 0


@dataclass(frozen=True, slots=True)
class Batch:
    """Instances of one level drawn by one call a part, and where they stand in the buffers."""

    row: int
    kind: int
    first: int
    count: int
    first_bone: int


@dataclass(frozen=True, slots=True)
class Frame:
    """A picture ready to be drawn: bytes of the buffers, and batches in the order of drawing."""

    size_px: tuple[int, int]
    projection: bytes
    instances: bytes
    palette: bytes
    upload_bytes: int
    batches: tuple[Batch, ...]

    @property
    def instance_bytes(self) -> int:
        """Bytes that go to the device for this frame."""
        return len(self.projection) + len(self.instances) + len(self.palette)


@dataclass(frozen=True, slots=True)
class Counts:
    """What a frame draws, by the renderer's own count.

    Attributes
    ----------
    state_changes : times that another type's program, colour and texture are set
    """

    draw_calls: int
    vertices: int
    triangles: int
    skinned_vertices: int
    textured_triangles: int
    state_changes: int
    framebuffer_pixels: int
    instance_bytes: int
    bytes_uploaded: int


def prepare_frame(scene: Scene, meshes: Meshes, picture: Picture, *, instancing: bool) -> Frame:
    """Sort what is drawn by type, level and distance, or mix it, and place it.

    With `instancing` a batch holds all instances of a level, without it or mixed one object.
    """
    if picture.mixed:
        order = np.argsort((picture.ids * _GOLDEN) % 1.0, kind="stable")
    else:
        order = np.lexsort((picture.distance_m, picture.row))
    ids, row = picture.ids[order], picture.row[order]
    skinned = np.array(meshes.skinned, dtype=np.bool_)[row]
    bone = 3 * BONES * (np.cumsum(skinned) - skinned)
    by_level = instancing and not picture.mixed
    first = np.flatnonzero(np.diff(row, prepend=-1)) if by_level else np.arange(len(row))
    count = np.diff(first, append=len(row))
    columns = (row[first], scene.type_index[ids[first]], first, count, bone[first])
    far_m = farthest_m(scene, picture.camera, picture.centers_m)
    return Frame(
        picture.size_px,
        projection(picture.camera, far_m).tobytes(),
        placements(scene, ids, picture.centers_m, picture.camera).tobytes(),
        bone_palette(ids[skinned], picture.time_s).tobytes(),
        picture.upload_bytes,
        tuple(map(Batch, *(column.tolist() for column in columns))),
    )


def count_frame(meshes: Meshes, frame: Frame) -> Counts:
    """Return what drawing a frame comes to."""
    calls = vertices = triangles = skinned = textured = changes = 0
    before = -1
    for batch in frame.batches:
        parts, size = meshes.parts[batch.row], meshes.vertices[batch.row] * batch.count
        calls += len(parts)
        vertices += size
        skinned += size if meshes.skinned[batch.row] else 0
        triangles += batch.count * sum(part.indices for part in parts) // 3
        textured += batch.count * sum(part.indices for part in parts if part.textured) // 3
        changes += batch.kind != before
        before = batch.kind
    pixels = frame.size_px[0] * frame.size_px[1]
    return Counts(
        calls,
        vertices,
        triangles,
        skinned,
        textured,
        changes,
        pixels,
        frame.instance_bytes,
        frame.upload_bytes,
    )
