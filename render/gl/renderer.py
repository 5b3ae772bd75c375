"""Draws frames of a scene, and measures each."""

import time
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...models.meshes.geometry import Geometry
from ...models.scene.scene import Scene
from .context import Target
from .draw_list import Counts, Frame, Picture, count_frame, prepare_frame
from .measures.pipeline_statistics import STATISTICS, pipeline_statistics
from .mesh_buffers import Meshes
from .programs import Program, checker, make_program, palette, rebind

if TYPE_CHECKING:
    import moderngl

_SKY = (0.78, 0.85, 0.92, 1.0)
_LEAST_BYTES = 1 << 16
_MOST_SIZES = 8


@dataclass(frozen=True, slots=True)
class Timing:
    """One drawing of a frame.

    Attributes
    ----------
    cpu_ms : to hand everything to OpenGL
    gpu_ms : of the timer query, whatever that is worth
    frame_ms : until everything was drawn
    shaded_samples : samples that passed the depth test
    statistics : in the order of `Renderer.statistics`, where they were asked for
    """

    cpu_ms: float
    gpu_ms: float
    frame_ms: float
    shaded_samples: int
    statistics: tuple[int, ...] = ()


class Renderer:
    """A scene on a device.

    Raises `InputError` if the scene has no meshes, or they do not fit the device.

    Parameters
    ----------
    instancing
        Draw all instances of a level by one call a part, instead of each object by its own.
    clock
        Nanoseconds by which drawings are timed: `time.thread_time_ns` counts what the caller's
        thread works, and so is no measure of a device that works elsewhere.

    Attributes
    ----------
    context : moderngl.Context
    statistics : tuple of str
        What the driver counts of a drawing beside samples.
    """

    def __init__(
        self,
        target: Target,
        scene: Scene,
        geometry: Geometry,
        *,
        instancing: bool,
        clock: Callable[[], int] = time.perf_counter_ns,
    ) -> None:
        context = target.context
        self._clock = clock
        self._statistics = pipeline_statistics(context, target.load)
        self.statistics = () if self._statistics is None else tuple(STATISTICS)
        self._target, self.context = target, context
        self._scene, self._instancing = scene, instancing
        self._meshes = Meshes(context, scene, geometry)
        self._colors = palette(len(scene.types.names))
        self._programs: dict[tuple[bool, bool], Program] = {}
        self._texture = checker(context)
        self._query = context.query(samples=True, time=True)
        self._instances = context.buffer(reserve=_LEAST_BYTES, dynamic=True)
        self._bones = context.buffer(reserve=_LEAST_BYTES, dynamic=True)
        self._uploads = context.buffer(reserve=_LEAST_BYTES)
        self._framebuffers: dict[tuple[int, int], moderngl.Framebuffer] = {}

    def prepare(self, picture: Picture) -> Frame:
        """Return the frame of a picture, its meshes uploaded; what this takes is timed nowhere."""
        self._loaded(grown=self._meshes.load(np.unique(picture.row).tolist()))
        frame = prepare_frame(self._scene, self._meshes, picture, instancing=self._instancing)
        self._instances = self._roomy(self._instances, len(frame.instances))
        self._bones = self._roomy(self._bones, len(frame.palette))
        self._uploads = self._roomy(self._uploads, frame.upload_bytes)
        for batch in frame.batches:
            for part in self._meshes.parts[batch.row]:
                self._program(skinned=self._meshes.skinned[batch.row], textured=part.textured)
        self.framebuffer(frame.size_px)
        return frame

    def load_all(self) -> None:
        """Upload the meshes of all levels and compile all programs, so that no frame has to."""
        self._loaded(grown=self._meshes.load_all())
        for row, parts in self._meshes.parts.items():
            for part in parts:
                self._program(skinned=self._meshes.skinned[row], textured=part.textured)

    def _loaded(self, *, grown: bool) -> None:
        if grown:
            for (skinned, textured), program in self._programs.items():
                self._programs[skinned, textured] = rebind(
                    self.context, self._meshes, program, skinned=skinned, textured=textured
                )

    def count(self, frame: Frame) -> Counts:
        """Return what drawing the frame comes to."""
        return count_frame(self._meshes, frame)

    def draw(self, frame: Frame, *, counting: bool = False) -> Timing:
        """Draw a frame and wait until it is done.

        With `counting` the driver counts its `statistics`, which takes a few percent of the time.
        """
        picture, clock = self.framebuffer(frame.size_px), self._clock
        statistics = self._statistics if counting else None
        start = clock()
        with self._query, nullcontext() if statistics is None else statistics.counting():
            self.submit(frame, picture)
        submitted = clock()
        self.context.finish()
        end = clock()
        gpu_ms, samples = self._query.elapsed * 1e-6, self._query.samples
        counted = () if statistics is None else statistics.counted()
        self._target.show(picture)
        cpu_ms, frame_ms = (submitted - start) * 1e-6, (end - start) * 1e-6
        return Timing(cpu_ms, gpu_ms, frame_ms, samples, counted)

    def picture(self, picture: Picture) -> NDArray[np.uint8]:
        """Draw a picture and return its pixels at full size, (height, width, 3), top row first."""
        from PIL import Image

        frame = self.prepare(picture)
        self.draw(frame)
        width, height = frame.size_px
        data = self.framebuffer(frame.size_px).read(components=3, alignment=1)
        pixels = np.frombuffer(data, dtype=np.uint8).reshape(height, width, 3)[::-1]
        full = (picture.camera.width_px, picture.camera.height_px)
        if full == frame.size_px:
            return pixels
        return np.asarray(Image.fromarray(pixels).resize(full, Image.Resampling.BILINEAR))

    def submit(self, frame: Frame, picture: "moderngl.Framebuffer") -> None:
        """Hand a frame that is to be drawn on a picture to OpenGL, and wait for nothing."""
        context, meshes = self.context, self._meshes
        picture.use()
        context.enable_only(context.DEPTH_TEST)
        picture.clear(*_SKY, depth=1.0)
        self._instances.write(frame.instances)
        self._instances.bind_to_storage_buffer(0)
        if frame.palette:
            self._bones.write(frame.palette)
            self._bones.bind_to_storage_buffer(1)
        if frame.upload_bytes:
            self._uploads.write(bytes(frame.upload_bytes))
        self._texture.use(0)
        for program in self._programs.values():
            program.projection.write(frame.projection)
        before, program = None, None
        for batch in frame.batches:
            skinned = meshes.skinned[batch.row]
            for part in meshes.parts[batch.row]:
                state = (batch.kind, skinned, part.textured)
                if program is None or state != before:
                    before = state
                    program = self._program(skinned=skinned, textured=part.textured)
                    program.color.value = self._colors[batch.kind]
                program.first.value = batch.first
                if skinned:
                    program.first_bone.value = batch.first_bone
                program.array.render(vertices=part.indices, first=part.first, instances=batch.count)

    def _program(self, *, skinned: bool, textured: bool) -> Program:
        key = (skinned, textured)
        if key not in self._programs:
            self._programs[key] = make_program(
                self.context, self._meshes, skinned=skinned, textured=textured
            )
        return self._programs[key]

    def _roomy(self, buffer: "moderngl.Buffer", size: int) -> "moderngl.Buffer":
        """Return a buffer that holds `size` bytes: this one, or one twice as large as needed."""
        if size <= buffer.size:
            return buffer
        buffer.release()
        return self.context.buffer(reserve=2 * size, dynamic=True)

    def framebuffer(self, size_px: tuple[int, int]) -> "moderngl.Framebuffer":
        """Return the picture of a size; those not drawn for longest make room for new sizes."""
        framebuffer = self._framebuffers.pop(size_px, None)
        if framebuffer is None:
            if len(self._framebuffers) == _MOST_SIZES:
                self._framebuffers.pop(next(iter(self._framebuffers))).release()
            color = self.context.renderbuffer(size_px, 4)
            framebuffer = self.context.framebuffer(
                [color], self.context.depth_renderbuffer(size_px)
            )
        self._framebuffers[size_px] = framebuffer
        return framebuffer
