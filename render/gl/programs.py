"""Shader programs, by whether they blend bones and sample the texture."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from .mesh_buffers import Meshes
from .shaders import FRAGMENT, VERTEX

if TYPE_CHECKING:
    import moderngl

_CHECKER_PX, _CHECKS = 256, 16


@dataclass(frozen=True, slots=True)
class Program:
    """A program, its vertex array, and its uniforms by name; `first_bone` is None without bones."""

    array: "moderngl.VertexArray"
    projection: Any
    color: Any
    first: Any
    first_bone: Any


def make_program(
    context: "moderngl.Context", meshes: Meshes, *, skinned: bool, textured: bool
) -> Program:
    """Compile a program over the meshes' buffers."""
    defines = "".join(
        f"#define {name}\n"
        for name, wanted in (("SKINNED", skinned), ("TEXTURED", textured))
        if wanted
    )
    vertex, fragment = (
        source.replace("#version 430\n", f"#version 430\n{defines}")
        for source in (VERTEX, FRAGMENT)
    )
    program = context.program(vertex_shader=vertex.lstrip(), fragment_shader=fragment.lstrip())
    return Program(
        _array(context, meshes, program, skinned=skinned, textured=textured),
        program["projection"],
        program["color"],
        program["first"],
        program["first_bone"] if skinned else None,
    )


def rebind(
    context: "moderngl.Context", meshes: Meshes, program: Program, *, skinned: bool, textured: bool
) -> Program:
    """Return a program over other buffers than those that it was compiled with."""
    compiled = program.array.program
    array = _array(context, meshes, compiled, skinned=skinned, textured=textured)
    program.array.release()
    return replace(program, array=array)


def _array(
    context: "moderngl.Context",
    meshes: Meshes,
    program: "moderngl.Program",
    *,
    skinned: bool,
    textured: bool,
) -> "moderngl.VertexArray":
    # The compiler drops what nothing reads, and an array may not name it.
    layout: list[Any] = [
        (meshes.vertex, "3f4 3f4 2f4", "in_position", "in_normal", "in_uv")
        if textured
        else (meshes.vertex, "3f4 3f4 8x", "in_position", "in_normal")
    ]
    if skinned:
        layout.append((meshes.skin, "4u1 4f1", "in_bones", "in_weights"))
    return context.vertex_array(program, layout, index_buffer=meshes.index)


def checker(context: "moderngl.Context") -> "moderngl.Texture":
    """Return the texture of all textured parts: scenes store coordinates, but no images."""
    y, x = np.mgrid[0:_CHECKER_PX, 0:_CHECKER_PX] * _CHECKS // _CHECKER_PX
    light = np.where((x + y) % 2 == 0, 255, 190).astype(np.uint8)
    pixels = np.repeat(light[..., None], 4, axis=2)
    texture = context.texture((_CHECKER_PX, _CHECKER_PX), 4, pixels.tobytes())
    texture.build_mipmaps()
    return texture


def palette(count: int) -> list[tuple[float, float, float]]:
    """Return a colour for each of `count` types, of even lightness."""
    turn = 2.0 * np.pi * (0.618034 * np.arange(count) + 0.08)
    rgb = 0.7 + 0.2 * np.cos(turn[:, None] - 2.0 * np.pi * np.arange(3) / 3.0)
    return [(float(r), float(g), float(b)) for r, g, b in rgb]
