"""The bundled scene: its contract, and the views that it offers."""

import math
import subprocess
import sys

import numpy as np
import pytest

from lodbench.models.scene.camera import Camera
from lodbench.models.scene.extent import scene_extent
from lodbench.models.scene.scene import Scene
from lodbench.models.scenes.plaza import build_plaza


@pytest.fixture(scope="module")
def plaza() -> Scene:
    """Return the scene."""
    return build_plaza()[0]


def in_view(scene: Scene, x: float, y: float, heading: float) -> int:
    """Return how many bounding spheres meet the frustum of an eye at 1.7 m, 60° wide at 16:9."""
    half = math.pi / 4
    level = math.sin(half), 0.0, 0.0, math.cos(half)  # looks along +y, z up
    turn = (heading - math.pi / 2) / 2
    z, w = math.sin(turn), math.cos(turn)
    q = (w * level[0], z * level[0], z * level[3], w * level[3])
    camera = Camera((x, y, 1.7), q, 1280, 720, math.radians(60))
    right, up, forward = camera.to_camera(np.ascontiguousarray(scene.center_m.T))
    inside = forward > -scene.radius_m
    for across, pixels in ((right, 1280), (up, 720)):
        slope = pixels / 2 / camera.focal_px
        margin = scene.radius_m * math.hypot(1.0, slope)
        inside &= np.abs(across) <= forward * slope + margin
    return int(inside.sum())


def test_contract(plaza: Scene) -> None:
    """3,000 objects of 4 types with several levels, some moving, of different importance."""
    assert len(plaza) == 3_000
    assert plaza.types.names == ("rock", "figure", "house", "tree")
    assert (plaza.types.levels.level_count >= 5).all()
    assert plaza.motion is not None
    assert len(plaza.motion.node) == 500
    assert (plaza.type_index[plaza.motion.node] == 1).all()
    assert len(np.unique(plaza.importance)) == 4
    assert plaza.flat


def test_errors_are_sane(plaza: Scene) -> None:
    """Coarser levels err more, and never by more than the type's radius."""
    levels = plaza.types.levels
    for kind, radius in enumerate(plaza.types.radius_m):
        error = levels.error_m[levels.start[kind] : levels.start[kind + 1]]
        assert error[0] == 0.0
        assert (error[1:] > 0.0).all()
        assert error[-1] < radius / 2


def test_extent_is_as_documented(plaza: Scene) -> None:
    """The ground is 890 m by 320 m about the origin."""
    center, size = scene_extent(plaza)
    assert np.abs(center[:2]).max() < 2.0
    assert size[:2] == pytest.approx([890, 320], abs=3.0)
    assert size[2] < 12.0


def test_views_reach_from_nothing_to_everything(plaza: Scene) -> None:
    """From the west end looking in, nearly all is ahead; looking out, nothing."""
    assert in_view(plaza, -650.0, 0.0, 0.0) == 3_000
    assert in_view(plaza, -445.0, 0.0, math.pi) == 0
    assert 0 < in_view(plaza, 300.0, 0.0, 0.0) < 900


def test_a_walk_to_the_east_meets_rising_density(plaza: Scene) -> None:
    """Triangles within 60 m of the main street's walker rise from the field to the town."""
    finest = plaza.types.levels.counts[plaza.types.levels.start[:-1], 2]
    triangles = finest[plaza.type_index]

    def near(x: float) -> float:
        offset = plaza.center_m[:, :2] - np.array((x, 0.0))
        return float(triangles[np.linalg.norm(offset, axis=1) < 60.0].sum())

    assert near(-445.0) < near(-345.0) < near(-195.0)


def test_main_street_is_free(plaza: Scene) -> None:
    """No house stands within 4 m of the x axis."""
    houses = plaza.type_index == 2
    assert (np.abs(plaza.center_m[houses, 1]) - plaza.radius_m[houses]).min() > 4.0


@pytest.mark.slow
def test_two_processes_build_the_same_scene(plaza: Scene) -> None:
    """Nothing depends on the process: hashes, addresses, clocks."""
    code = (
        "import hashlib; from lodbench.models.scenes.plaza import build_plaza\n"
        "s, g = build_plaza()\n"
        "print(hashlib.sha256(s.center_m.tobytes() + s.types.levels.error_m.tobytes()"
        "+ b''.join(m.faces.tobytes() for m in g)).hexdigest())"
    )
    runs = {
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True
        ).stdout
        for _ in range(2)
    }
    assert len(runs) == 1
