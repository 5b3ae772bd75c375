"""Counts of the pipeline: of a square and a cube, those that can be worked by hand."""

from typing import Any

import pytest

from lodbench.render.gl.measures.pipeline_statistics import STATISTICS, pipeline_statistics


class Context:
    """In place of a context: of a version, with extensions."""

    def __init__(self, version_code: int, *extensions: str) -> None:
        self.version_code, self.extensions = version_code, set(extensions)


def test_a_driver_without_them() -> None:
    """Nothing is asked of a driver of OpenGL 4.5 that does not name the extension."""
    asked: list[str] = []
    context: Any = Context(450, "GL_ARB_other")
    assert pipeline_statistics(context, lambda name: asked.append(name) or 0) is None
    assert asked == []


def test_counts_by_hand(target: Any, drawing: Any, cube: Any, quad: Any) -> None:
    """Twelve triangles of a cube and two of a square enter; what is behind the eye does not leave.

    Each vertex is shaded at least once, and at most once for each index.
    """
    if pipeline_statistics(target.context, target.load) is None:
        pytest.skip("this driver has no pipeline statistics")
    made = drawing([(0.0, 0.0, -6.0), (0.0, 0.0, 6.0)], [[cube()], [quad()]], kind=[0, 1])
    renderer = made.renderer()
    assert renderer.statistics == tuple(STATISTICS)
    frame = renderer.prepare(made.picture())
    shaded, entered, left = renderer.draw(frame, counting=True).statistics
    assert 24 + 4 <= shaded <= 36 + 6
    assert entered == 12 + 2
    assert left == 12
    assert renderer.draw(frame).statistics == ()
    assert renderer.draw(frame, counting=True).statistics == (shaded, entered, left)
