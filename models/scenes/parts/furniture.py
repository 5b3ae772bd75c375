"""Furniture of an office building, from rough boxes and surfaces of revolution."""

from collections.abc import Sequence

import numpy as np

from ...meshes.shapes import lump, move_part, revolved, rough_box
from ...meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface

CHAIR, DESK, SHELF, COMPUTER, LAMP, PLANT, CABINET = range(7)
"""Places in what `make_furniture` returns."""


def make_furniture(rng: np.random.Generator) -> list[SurfaceMesh]:
    """Return the distinct pieces, in metres, standing on the floor."""
    pieces = [
        ("chair", _chair(rng)),
        ("desk", _desk(rng)),
        ("shelf", _shelf(rng)),
        ("computer", _computer(rng)),
        ("lamp", _lamp()),
        ("plant", _plant(rng)),
        ("cabinet", _cabinet(rng)),
    ]
    return [clean_surface(name, parts).standing(y_up=False) for name, parts in pieces]


def _legs(rng: np.random.Generator, x: float, y: float, height: float) -> list[MeshPart]:
    return [
        move_part(rough_box(rng, 2), (sx * x, sy * y, height / 2.0), (0.05, 0.05, height))
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]


def _chair(rng: np.random.Generator) -> list[MeshPart]:
    seat = move_part(rough_box(rng, 5), (0.0, 0.0, 0.45), (0.45, 0.45, 0.06))
    back = move_part(rough_box(rng, 5), (0.0, 0.21, 0.75), (0.42, 0.05, 0.5))
    return [seat, back, *_legs(rng, 0.19, 0.19, 0.43)]


def _desk(rng: np.random.Generator) -> list[MeshPart]:
    top = move_part(rough_box(rng, 7), (0.0, 0.0, 0.74), (1.6, 0.8, 0.04))
    drawers = move_part(rough_box(rng, 5), (0.5, 0.0, 0.4), (0.45, 0.7, 0.6))
    return [top, drawers, *_legs(rng, 0.75, 0.35, 0.72)]


def _shelf(rng: np.random.Generator) -> list[MeshPart]:
    boards = [
        move_part(rough_box(rng, 3), (0.0, 0.0, z), (0.9, 0.3, 0.03)) for z in np.linspace(0, 2, 6)
    ]
    sides = [move_part(rough_box(rng, 3), (x, 0.0, 1.0), (0.03, 0.3, 2.0)) for x in (-0.45, 0.45)]
    return [*boards, *sides, *_books(rng)]


def _books(rng: np.random.Generator) -> Sequence[MeshPart]:
    books: list[MeshPart] = []
    for z in np.linspace(0.02, 1.62, 5):
        for x in np.linspace(-0.4, 0.4, 16):
            height = rng.uniform(0.2, 0.32)
            size = (rng.uniform(0.02, 0.045), rng.uniform(0.14, 0.22), height)
            books.append(move_part(rough_box(rng, 1), (x, 0.0, z + height / 2.0), size))
    return books


def _computer(rng: np.random.Generator) -> list[MeshPart]:
    screen = move_part(rough_box(rng, 4), (0.0, 0.0, 0.32), (0.4, 0.36, 0.34))
    foot = move_part(rough_box(rng, 2), (0.0, 0.0, 0.05), (0.4, 0.4, 0.1))
    keys = move_part(rough_box(rng, 4), (0.0, -0.4, 0.02), (0.45, 0.16, 0.03))
    return [screen, foot, keys]


def _lamp() -> list[MeshPart]:
    pole = revolved([(0.0, 0.16), (0.03, 0.16), (0.04, 0.02), (1.5, 0.02)], 12)
    return [pole, revolved([(1.45, 0.22), (1.6, 0.18), (1.75, 0.1)], 16)]


def _plant(rng: np.random.Generator) -> list[MeshPart]:
    pot = revolved([(0.0, 0.12), (0.3, 0.18), (0.32, 0.16)], 16)
    leaves = [
        move_part(lump(rng, 1, 0.3), tuple(rng.normal((0.0, 0.0, 0.75), 0.15).tolist()), 0.18)
        for _ in range(12)
    ]
    return [pot, *leaves]


def _cabinet(rng: np.random.Generator) -> list[MeshPart]:
    return [move_part(rough_box(rng, 6), (0.0, 0.0, 0.65), (0.5, 0.6, 1.3))]
