"""Draws frames of a scene, and measures each."""

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...models.meshes.geometry import Geometry
from ...models.scene.scene import Scene
from .context import Target
from .draw_list import Counts, Frame, Picture, count_frame, prepare_frame
from .mesh_buffers import upload
from .programs import Program, checker, make_program, palette

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
    """

    cpu_ms: float
    gpu_ms: float
    frame_ms: float
    shaded_samples: int


class Renderer:
    """A scene on a device.

    Raises `InputError` if the scene has no meshes, or they do not fit the device.

    Parameters
    ----------
    instancing
        Draw all instances of a level by one call a part, instead of each object by its own.

    Attributes
    ----------
    context : moderngl.Context
    """

    def __init__(
        self, target: Target, scene: Scene, geometry: Geometry, *, instancing: bool
    ) -> None:
        context = target.context
        self._target, self.context = target, context
        self._scene, self._instancing = scene, instancing
        self._meshes = upload(context, scene, geometry)
        self._colors = palette(len(scene.types.names))
        self._programs: dict[tuple[bool, bool], Program] = {}
        self._texture = checker(context)
        self._query = context.query(samples=True, time=True)
        self._instances = context.buffer(reserve=_LEAST_BYTES, dynamic=True)
        self._bones = context.buffer(reserve=_LEAST_BYTES, dynamic=True)
        self._framebuffers: dict[tuple[int, int], moderngl.Framebuffer] = {}

    def prepare(self, picture: Picture) -> Frame:
        """Return the frame of a picture; what this takes is timed nowhere."""
        frame = prepare_frame(self._scene, self._meshes, picture, instancing=self._instancing)
        self._instances = self._roomy(self._instances, len(frame.instances))
        self._bones = self._roomy(self._bones, len(frame.palette))
        for batch in frame.batches:
            for part in self._meshes.parts[batch.row]:
                self._program(skinned=self._meshes.skinned[batch.row], textured=part.textured)
        self.framebuffer(frame.size_px)
        return frame

    def count(self, frame: Frame) -> Counts:
        """Return what drawing the frame comes to."""
        return count_frame(self._meshes, frame)

    def draw(self, frame: Frame) -> Timing:
        """Draw a frame and wait until it is done."""
        picture = self.framebuffer(frame.size_px)
        start = time.perf_counter_ns()
        with self._query:
            self.submit(frame, picture)
        submitted = time.perf_counter_ns()
        self.context.finish()
        end = time.perf_counter_ns()
        gpu_ms, samples = self._query.elapsed * 1e-6, self._query.samples
        self._target.show(picture)
        return Timing((submitted - start) * 1e-6, gpu_ms, (end - start) * 1e-6, samples)

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
