"""Meshes that nothing was calibrated on, as a user might bring them: files for `scene build`."""

from pathlib import Path

import numpy as np
import trimesh

ACROSS, ALONG = 96, 160
"""Cells of a surface: some 30,000 triangles, of which many are smaller than a pixel."""


def write_meshes(folder: Path) -> list[Path]:
    """Write three dense meshes, the same ones each time; return their files."""
    u, v = np.meshgrid(
        np.linspace(0.0, 2.0 * np.pi, ACROSS, endpoint=False),
        np.linspace(0.0, 2.0 * np.pi, ALONG, endpoint=False),
        indexing="ij",
    )
    thick = 0.35 + 0.06 * np.sin(9.0 * u + 5.0 * v) + 0.03 * np.cos(17.0 * v)
    winding = 0.7 * np.sin(2.0 * v)
    shapes = {
        "ring": (1.0 + thick * np.cos(u), thick * np.sin(u), v),
        "knot": (
            1.0 + 0.45 * np.cos(3.0 * v) + 0.2 * np.cos(u),
            winding + 0.2 * np.sin(u),
            2.0 * v,
        ),
        "shell": (0.15 + 0.9 * np.abs(np.cos(u)) * (1.2 + 0.1 * np.sin(12.0 * v)), np.sin(u), v),
    }
    files: list[Path] = []
    for name, (radius, height, angle) in shapes.items():
        points = np.stack((radius * np.cos(angle), radius * np.sin(angle), height), axis=-1)
        mesh = trimesh.Trimesh(points.reshape(-1, 3), _faces(), process=False)
        files.append(folder / f"{name}.ply")
        mesh.export(files[-1])
    return files


def _faces() -> np.ndarray:
    """Return the triangles of a grid that is closed both ways, (n, 3)."""
    at = np.arange(ACROSS * ALONG).reshape(ACROSS, ALONG)
    right, up = np.roll(at, -1, axis=0), np.roll(at, -1, axis=1)
    far = np.roll(right, -1, axis=1)
    return np.concatenate(
        [np.stack(corner, axis=-1).reshape(-1, 3) for corner in ((at, right, far), (at, far, up))]
    )
