"""The market square: other meshes than plaza's, apart from each other on open ground."""

import re

import numpy as np
import pytest

from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.meshes.geometry import Geometry
from lodbench.models.scene.scene import Scene
from lodbench.models.scenes.market import build_market
from lodbench.models.scenes.scene_registry import SCENES


@pytest.fixture(scope="module")
def market() -> tuple[Scene, Geometry]:
    """Build it."""
    return build_market()


def test_as_it_is_told(market: tuple[Scene, Geometry]) -> None:
    """1,500 pieces of seven kinds, of as many triangles as `list scenes` says."""
    scene, _ = market
    assert (scene.name, len(scene), scene.flat) == ("market", 1_500, True)
    assert len(scene.types.names) == 7
    assert set(np.bincount(scene.type_index).tolist()) == {214, 215}
    assert scene.cells is None
    levels = scene.types.levels
    assert not levels.continuous.any()
    finest = levels.counts[levels.start[:-1], LEVEL_PREDICTORS.index("triangles")]
    named = [int(n.replace(",", "")) for n in re.findall(r"[\d,]*\d", SCENES.find("market").about)]
    assert named == [1_500, finest.min(), finest.max()]


def test_levels_have_meshes(market: tuple[Scene, Geometry]) -> None:
    """One for each row of the level table, of as many triangles and vertices as that counts."""
    scene, geometry = market
    levels = scene.types.levels
    assert (levels.level_count >= 2).all()
    sizes = [(len(mesh.vertices), len(mesh.faces)) for mesh in geometry]
    assert sizes == [tuple(row) for row in levels.counts[:, 1:3].astype(int).tolist()]
    assert (levels.error_m[levels.start[:-1]] == 0.0).all()


def test_pieces_stand_apart_on_the_ground(market: tuple[Scene, Geometry]) -> None:
    """Within the square of 240 m, no two in one place, each standing at z = 0."""
    scene, geometry = market
    reach = np.abs(scene.center_m[:, :2]) + scene.radius_m[:, None]
    assert reach.max() <= 120.0 + 1e-9
    gap = np.linalg.norm(scene.center_m[:, None, :2] - scene.center_m[None, :, :2], axis=2)
    np.fill_diagonal(gap, np.inf)
    assert (gap - scene.radius_m[:, None] - scene.radius_m[None]).min() > -1e-6
    assert (scene.position_m[:, 2] == 0.0).all()
    finest: list[int] = scene.types.levels.start[:-1].tolist()
    lowest = [float(geometry[row].vertices[:, 2].min()) for row in finest]
    assert lowest == pytest.approx([0.0] * 7, abs=1e-3)


def test_every_build_is_the_same(market: tuple[Scene, Geometry]) -> None:
    """What was recorded in it can be recorded again."""
    scene, geometry = build_market()
    assert np.array_equal(scene.center_m, market[0].center_m)
    for mesh, before in zip(geometry, market[1], strict=True):
        assert np.array_equal(mesh.faces, before.faces)
        assert np.array_equal(mesh.vertices, before.vertices)
