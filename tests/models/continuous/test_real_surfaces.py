"""The totally ordered mesh on real meshes: closed, open, non-manifold, of several parts."""

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from model_tables import (
    collapse_errors,
    extraction_work,
    memory_of,
    overhead_at,
    texture_errors,
    traversal_overhead,
)

from lodbench.models.continuous.knots import KnotOptions, OrderedSurface, build_continuous
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.mesh_file import load_mesh

pytestmark = pytest.mark.realdata

SMALL = ("cow.obj", "CesiumMilkTruck.glb", "homer.obj", "spot.obj", "suzanne.obj", "teapot.obj")
LARGE = ("fandisk.obj", "rocker-arm.obj", "stanford-bunny.obj")
MESHES = [*SMALL, *(pytest.param(name, marks=pytest.mark.slow) for name in LARGE)]
SAMPLING = Sampling(vertices=4_000, surface=4_000)


@cache
def surface(path: Path) -> OrderedSurface:
    """Return a mesh in order; made once for all tests."""
    return OrderedSurface.of(load_mesh(path))


@pytest.mark.parametrize("name", MESHES)
def test_any_count_is_delivered(name: str, data_dir: Path) -> None:
    """From the fewest to all, at most two triangles short; indices valid, none repeated."""
    ordered = surface(data_dir / "meshes" / name).ordered
    least, full = int(ordered.faces_after[-1]), int(ordered.faces_after[0])
    assert (-np.diff(ordered.faces_after) <= 3).all()  # so of any count at most two are missing
    counts = np.unique(np.geomspace(least, full, 150).round().astype(int))
    for count in counts.tolist():
        faces = ordered.extract(count)
        assert count - 2 <= len(faces) <= count
        assert faces.min() >= 0
        assert faces.max() < ordered.vertices_after[ordered.step_of(count)]
        a, b, c = faces.T
        assert ((a != b) & (b != c) & (c != a)).all()


@pytest.mark.parametrize("name", MESHES)
def test_the_fewest_triangles_are_few(name: str, data_dir: Path) -> None:
    """Where manifold rules end the collapse, less than 3 % of the triangles are left."""
    ordered = surface(data_dir / "meshes" / name).ordered
    assert ordered.faces_after[-1] <= 0.03 * ordered.faces_after[0]


@pytest.mark.parametrize("name", MESHES)
def test_overhead_and_memory(name: str, data_dir: Path) -> None:
    """Traversal visits less than 35 % more than it draws; substitutes cost an index a vertex."""
    ordered = surface(data_dir / "meshes" / name).ordered
    assert traversal_overhead(ordered).max() < 0.35
    memory = memory_of(ordered)
    assert memory.substitutes == 4 * int(ordered.vertices_after[0])
    assert memory.substitutes < 0.1 * memory.single
    assert memory.substitutes + memory.counts + memory.restarts < memory.single


@pytest.mark.parametrize("name", MESHES)
def test_knots_err_more_and_more(name: str, data_dir: Path) -> None:
    """The measured error of twelve knots rises from 0 and stays below the radius."""
    sampling = Sampling(vertices=1_000, surface=1_000)
    model = build_continuous(surface(data_dir / "meshes" / name), KnotOptions(), sampling)
    assert len(model.error_m) == 12
    assert model.error_m[0] == 0.0
    assert (np.diff(model.error_m) >= 0.0).all()
    assert 0.0 < model.error_m[-1] < model.radius_m


@pytest.mark.slow
def test_errors_are_near_those_of_fast_simplification(data_dir: Path) -> None:
    """At equal triangles at most twice its distances on every mesh, half of them below 1.5 times.

    Greatest and mean distance; it may move vertices, ours may not.
    """
    ratios: list[tuple[float, float]] = []
    for name in (*SMALL, *LARGE):
        rows = collapse_errors(
            surface(data_dir / "meshes" / name), (0.5, 0.25, 0.1, 0.05, 0.02), SAMPLING
        )
        assert rows
        for row in rows:
            assert row.greatest <= 2.0, (name, row)
            assert row.mean <= 2.0, (name, row)
        ratios += [(row.greatest, row.mean) for row in rows]
    assert (np.median(ratios, axis=0) <= 1.5).all()


@pytest.mark.parametrize(
    "name", [pytest.param("CesiumMilkTruck.glb", marks=pytest.mark.slow), "spot.obj"]
)
def test_texture_is_kept(name: str, data_dir: Path) -> None:
    """At equal triangles the error in texture space is below half of plain collapse's."""
    mesh = surface(data_dir / "meshes" / name).full
    rows = texture_errors(mesh, (0.5, 0.25, 0.1))
    assert len(rows) == 3
    for row in rows:
        assert row.kept < 0.5 * row.plain, row


def test_changes_write_few_indices(data_dir: Path) -> None:
    """Coarsening writes less than an index for a triangle changed, refining less than three."""
    ordered = surface(data_dir / "meshes" / "cow.obj").ordered
    for before, after, most in ((1.0, 0.5, 1.0), (0.1, 0.05, 1.0), (0.5, 1.0, 3.0)):
        work = extraction_work(ordered, before, after)
        assert 0 < work.index_writes < most * work.triangles_changed


def test_the_manual_shows_what_is_measured(data_dir: Path) -> None:
    """Rows of two meshes in the manual are what is measured here, within a tenth."""
    page = (Path(__file__).parents[3] / "docs" / "lod-models.md").read_text(encoding="utf-8")
    for name in ("cow.obj", "spot.obj"):
        ordered = surface(data_dir / "meshes" / name).ordered
        memory = memory_of(ordered)
        shown = [
            [float(n) for n in re.findall(r"[\d.]+(?= %|\b)", row.replace(",", ""))]
            for row in re.findall(rf"^\| {name} (\|.*\|)$", page, re.MULTILINE)
        ]
        shares = (memory.substitutes, memory.counts, memory.restarts, memory.levels)
        first = [100.0 * size / memory.single for size in shares]
        assert shown[0][-4:] == pytest.approx(first, rel=0.1, abs=1.0)
        overhead = [100.0 * value for value in overhead_at(ordered, (0.75, 0.5, 0.25, 0.1, 0.05))]
        assert shown[1][-5:] == pytest.approx(overhead, rel=0.1, abs=1.0)
