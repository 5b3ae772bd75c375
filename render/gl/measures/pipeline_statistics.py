"""What the stages of the pipeline count, where the driver tells it.

Khronos, "ARB_pipeline_statistics_query", 2014; part of OpenGL 4.6.  Vertex shader invocations are
what is left of the indices after the cache of transformed vertices; primitives that enter clipping
are the triangles drawn, those that leave it the ones inside the frustum, in pieces where it cuts
them.
"""

from collections.abc import Generator
from contextlib import contextmanager
from ctypes import POINTER, byref, c_int, c_uint, c_uint64
from typing import TYPE_CHECKING

from .gl_functions import Loader, gl_function

if TYPE_CHECKING:
    import moderngl

STATISTICS = {
    "vertex_shader_invocations": 0x82F0,
    "clipping_input_primitives": 0x82F6,
    "clipping_output_primitives": 0x82F7,
}
_RESULT = 0x8866
_VERSION = 460
_EXTENSION = "GL_ARB_pipeline_statistics_query"


class PipelineStatistics:
    """Queries of `STATISTICS`, one of each."""

    def __init__(self, load: Loader) -> None:
        self._begin = gl_function(load, "glBeginQuery", None, c_uint, c_uint)
        self._end = gl_function(load, "glEndQuery", None, c_uint)
        self._get = gl_function(
            load, "glGetQueryObjectui64v", None, c_uint, c_uint, POINTER(c_uint64)
        )
        self._queries = (c_uint * len(STATISTICS))()
        gl_function(load, "glGenQueries", None, c_int, POINTER(c_uint))(
            len(STATISTICS), self._queries
        )

    @contextmanager
    def counting(self) -> Generator[None]:
        """Count what is drawn within."""
        for target, query in zip(STATISTICS.values(), self._queries, strict=True):
            self._begin(target, query)
        yield
        for target in STATISTICS.values():
            self._end(target)

    def counted(self) -> tuple[int, ...]:
        """Wait for what was drawn, and return its counts in the order of `STATISTICS`."""
        value, found = c_uint64(), list[int]()
        for query in self._queries:
            self._get(query, _RESULT, byref(value))
            found.append(value.value)
        return tuple(found)


def pipeline_statistics(context: "moderngl.Context", load: Loader) -> PipelineStatistics | None:
    """Return the queries of a context, or None where its driver has none."""
    if context.version_code >= _VERSION or _EXTENSION in context.extensions:
        return PipelineStatistics(load)
    return None
