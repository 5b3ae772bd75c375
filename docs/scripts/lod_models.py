"""Measure continuous models on the real meshes and write the tables of `lod-models.md`.

Usage: ``python docs/scripts/lod_models.py FOLDER``, the folder of meshes; some minutes.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

from model_tables import collapse_errors, extraction_work, memory_of, overhead_at, texture_errors
from page_parts import table, write_blocks

from lodbench.models.continuous.knots import OrderedSurface
from lodbench.models.continuous.ordered_mesh import OrderedMesh
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.mesh_file import load_mesh

PAGE = Path(__file__).parents[1] / "lod-models.md"
SHARES = (0.75, 0.5, 0.25, 0.1, 0.05)
COARSE = (0.5, 0.25, 0.1, 0.05, 0.02)
CHANGES = ((1.0, 0.5), (0.5, 0.45), (0.1, 0.05), (0.05, 0.1), (0.45, 0.5), (0.5, 1.0))
SAMPLING = Sampling(vertices=4_000, surface=4_000)
CHANGED = ("cow.obj", "stanford-bunny.obj")
TEXTURED = ("CesiumMilkTruck.glb", "spot.obj")


def percent(share: float) -> str:
    """Return a share as whole percents."""
    return f"{100.0 * share:.0f} %"


def published(ordered: OrderedMesh) -> OrderedMesh:
    """Return the same order with the list of full resolution alone."""
    return OrderedMesh(
        ordered.vertex_source,
        ordered.face_source,
        ordered.target,
        ordered.vertices_after,
        ordered.faces_after,
        ordered.restarts[:1],
    )


def memory_rows(surfaces: dict[str, OrderedSurface]) -> Iterator[tuple[str, ...]]:
    """Yield what each mesh takes, beside the mesh at one resolution."""
    extras = ("substitutes", "counts", "restart lists", "discrete levels")
    yield "mesh", "triangles", "fewest", "KiB", *extras
    for name, surface in surfaces.items():
        ordered = surface.ordered
        memory = memory_of(ordered)
        extra = (memory.substitutes, memory.counts, memory.restarts, memory.levels)
        yield (
            name,
            f"{ordered.faces_after[0]:,}",
            f"{ordered.faces_after[-1]:,}",
            f"{memory.single / 1024:,.0f}",
            *(f"+{percent(size / memory.single)}" for size in extra),
        )


def overhead_rows(surfaces: dict[str, OrderedSurface]) -> Iterator[tuple[str, ...]]:
    """Yield the overhead of the published structure, and of ours."""
    ours = tuple(f"at {percent(share)}, restarts" for share in SHARES)
    yield "mesh", *(f"at {percent(share)}" for share in SHARES), *ours
    for name, surface in surfaces.items():
        both = (published(surface.ordered), surface.ordered)
        yield name, *(percent(value) for mesh in both for value in overhead_at(mesh, SHARES))


def error_rows(surfaces: dict[str, OrderedSurface]) -> Iterator[tuple[str, ...]]:
    """Yield greatest and mean distance over fast-simplification's."""
    yield "mesh", *(f"at {percent(share)}" for share in COARSE)
    for name, surface in surfaces.items():
        rows = collapse_errors(surface, COARSE, SAMPLING)
        cells = [f"{row.greatest:.2f}, {row.mean:.2f}" for row in rows]
        yield name, *cells, *["stopped"] * (len(COARSE) - len(cells))


def texture_rows(surfaces: dict[str, OrderedSurface]) -> Iterator[tuple[str, ...]]:
    """Yield errors in texture space."""
    yield "mesh", "triangles", "kept", "plain"
    for name in TEXTURED:
        for row in texture_errors(surfaces[name].full, COARSE):
            yield name, f"{row.triangles:,}", f"{row.kept:.4f}", f"{row.plain:.4f}"


def work_rows(surfaces: dict[str, OrderedSurface]) -> Iterator[tuple[str, ...]]:
    """Yield operations per triangle changed."""
    yield "mesh", "from", "to", "triangles changed", "indices written", "vertices visited"
    for name in CHANGED:
        for before, after in CHANGES:
            work = extraction_work(surfaces[name].ordered, before, after)
            per = (n / work.triangles_changed for n in (work.index_writes, work.vertices_visited))
            changed = f"{work.triangles_changed:,}"
            yield name, percent(before), percent(after), changed, *(f"{n:.2f}" for n in per)


def main(folder: Path) -> None:
    """Measure every mesh of a folder and bring the page up to date."""
    surfaces: dict[str, OrderedSurface] = {}
    for path in sorted(folder.iterdir(), key=lambda path: path.name.lower()):
        surfaces[path.name] = OrderedSurface.of(load_mesh(path))
    made = {
        "memory": memory_rows,
        "overhead": overhead_rows,
        "errors": error_rows,
        "texture": texture_rows,
        "work": work_rows,
    }
    blocks = {name: table(*rows(surfaces)) for name, rows in made.items()}
    write_blocks(PAGE, "docs/scripts/lod_models.py", blocks)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
