"""Cells that hide nodes: by hand, and in the culler and the file."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench import InputError
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.cells import EVERYWHERE, Cells
from lodbench.models.scene.frustum import Culler
from lodbench.models.scene.motion import Centers
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_file import read_scene, write_scene

# Three rooms in a row along x, 10 m each; the first two see each other, the third only itself.
LOW = np.array([[0.0, 0, 0], [10, 0, 0], [20, 0, 0]])
SEES = np.array([[1, 1, 0], [1, 1, 0], [0, 0, 1], [0, 0, 0]], dtype=bool)


def rooms(node_cell: Any = (0, 1, 2, EVERYWHERE), **other: Any) -> Cells:
    """Return the three rooms with a node in each, and one that no wall hides."""
    values: dict[str, Any] = {"low_m": LOW, "high_m": LOW + 10.0, "visible": SEES} | other
    return Cells(np.array(node_cell), **values)


def test_points_belong_to_cells() -> None:
    """Inside, on the wall between two (the first), and outside all."""
    cells = rooms()
    assert cells.cell_at((5.0, 5.0, 5.0)) == 0
    assert cells.cell_at((10.0, 5.0, 5.0)) == 0
    assert cells.cell_at((29.0, 1.0, 9.0)) == 2
    assert cells.cell_at((5.0, 5.0, 11.0)) == 3


def test_walls_hide() -> None:
    """From the first room the third is hidden, from outside all of them."""
    cells = rooms()
    assert cells.seen_from((5.0, 5.0, 5.0)).tolist() == [True, True, False, True]
    assert cells.seen_from((25.0, 5.0, 5.0)).tolist() == [False, False, True, True]
    assert cells.seen_from((-5.0, 5.0, 5.0)).tolist() == [False, False, False, True]
    assert not cells.seen_from((5.0, 5.0, 5.0)).flags.writeable


def test_the_culler_drops_what_walls_hide(make_scene: Callable[..., Scene]) -> None:
    """Looking along x from the first room, through all nodes."""
    scene = make_scene(np.column_stack((np.array([5.0, 15, 25, 35]), np.full((4, 2), 5.0))))
    ahead = (0.5, -0.5, -0.5, 0.5)  # along +x, z up
    camera = Camera((1.0, 5.0, 5.0), ahead, 100, 100, 1.0)
    centers = Centers(scene.center_m, None)
    now = centers.at(0.0)
    open_air = Culler(centers, scene.radius_m, scene.blocks)
    assert open_air.cull(now, camera)[0].tolist() == [0, 1, 2, 3]
    culler = Culler(centers, scene.radius_m, scene.blocks, rooms())
    assert culler.cull(now, camera)[0].tolist() == [0, 1, 3]
    assert culler.inside.tolist() == [True, True, False, True]
    # The frustum holds the same nodes from outside the building, but walls hide all but one.
    assert culler.cull(now, Camera((-1.0, 5.0, 5.0), ahead, 100, 100, 1.0))[0].tolist() == [3]


def test_cells_are_kept_in_scene_files(make_scene: Callable[..., Scene], tmp_path: Path) -> None:
    """A scene with cells comes back with them; one without has none."""
    scene = make_scene(np.zeros((4, 3)), cells=rooms())
    write_scene(tmp_path / "a.lodscene", scene, ())
    again = read_scene(tmp_path / "a.lodscene").cells
    assert again is not None
    assert again.node_cell.tolist() == [0, 1, 2, -1]
    assert again.visible.tolist() == SEES.tolist()
    write_scene(tmp_path / "b.lodscene", make_scene(np.zeros((4, 3))), ())
    assert read_scene(tmp_path / "b.lodscene").cells is None


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"node_cell": [0, 1, 3, 0]}, "node_cell: expected -1 to 2"),
        ({"node_cell": [0, -2, 1, 0]}, "node_cell: expected -1 to 2"),
        ({"high_m": LOW}, "an empty box"),
        ({"low_m": LOW * np.nan}, "finite"),
        ({"visible": SEES[:3]}, "expected shape"),
        ({"visible": ~SEES}, "each cell to see itself"),
        (
            {"low_m": LOW[:0], "high_m": LOW[:0], "visible": np.zeros((1, 0)), "node_cell": []},
            "at least one",
        ),
    ],
)
def test_damaged_cells_are_refused(change: dict[str, Any], message: str) -> None:
    """Each by name."""
    with pytest.raises(InputError, match=message):
        rooms(**change)


def test_a_scene_has_a_cell_for_each_node(make_scene: Callable[..., Scene]) -> None:
    """Three nodes and four cells of nodes do not fit."""
    with pytest.raises(InputError, match="a cell for each of 3 nodes, got 4"):
        make_scene(np.zeros((3, 3)), cells=rooms())
