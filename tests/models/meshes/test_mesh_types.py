"""Types from mesh files: axes, units, and refusals by name."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from lodbench import InputError
from lodbench.models.meshes.authored_levels import group_levels
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.mesh_types import MeshUnits, read_types
from lodbench.models.meshes.simplify import ChainOptions


@pytest.fixture
def slab(tmp_path: Path) -> Path:
    """Write a file of a box, 1 by 4 by 2 units in x, y and z."""
    path = tmp_path / "slab.ply"
    trimesh.creation.box((1, 4, 2)).export(path)
    return path


@pytest.mark.parametrize(
    ("units", "size"),
    [
        (MeshUnits(), [0.5, 1.0, 2.0]),
        (MeshUnits(up="z"), [1.0, 4.0, 2.0]),
        (MeshUnits(height_m=8.0), [2.0, 4.0, 8.0]),
        (MeshUnits(unit_m=0.5), [0.5, 1.0, 2.0]),
        (MeshUnits(up="z", unit_m=10.0), [10.0, 40.0, 20.0]),
    ],
)
def test_sizes(units: MeshUnits, size: list[float], slab: Path) -> None:
    """Height or unit sets the scale; the up axis turns the box."""
    (model,) = read_types(group_levels([slab]), units, ChainOptions(), Sampling(10, 10))
    assert np.ptp(model.meshes[0].vertices, axis=0) == pytest.approx(size)
    assert model.meshes[0].vertices[:, 2].min() == 0.0


def test_the_refused_mesh_is_named(slab: Path, tmp_path: Path) -> None:
    """The error carries the path of the mesh that is at fault, after good ones."""
    flat = tmp_path / "flat.obj"
    flat.write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n")
    types = read_types(group_levels([slab, flat]), MeshUnits(), ChainOptions(), Sampling(10, 10))
    assert next(types).name == "slab"
    with pytest.raises(InputError, match=r"flat\.obj: mesh flat: expected a height"):
        next(types)


@pytest.mark.parametrize(
    ("up", "height", "unit"),
    [("x", 2.0, None), ("y", 0.0, None), ("y", np.nan, None), ("y", 2.0, -1.0), ("y", 2.0, 1e9)],
)
def test_nonsense_is_refused(up: str, height: float, unit: float | None) -> None:
    """Axes and lengths that cannot be are input errors."""
    with pytest.raises(InputError, match="expected"):
        MeshUnits(up=up, height_m=height, unit_m=unit)
