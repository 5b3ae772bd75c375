"""`cluster-cut` held to the rule of meshoptimizer's clusterlod.h, written out here.

No package serves that header: the rule is in a C++ example, and neither npm's nor PyPI's
meshoptimizer has it.  So what a cluster decides is written again from its documentation, one
cluster after another, in single precision as there; and is tried on a scene worked by hand first.
"""

from collections.abc import Callable

import numpy as np
import pytest

from lodbench.models.scene.camera import Camera
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.hierarchies.cluster_cut import ClusterCut
from lodbench.policies.view import View

HEIGHT_PX = 720
FOVY_RAD = 1.0


def projected_px(scene: Scene, node: int, camera: Camera) -> float:
    """Return error / max(distance to centre - radius, near) · cot(fovy / 2) / 2, in pixels."""
    offset = scene.center_m[node].astype(np.float32) - np.array(camera.position_m, dtype=np.float32)
    away = np.sqrt((offset * offset).sum()) - np.float32(scene.radius_m[node])
    error = np.float32(scene.types.levels.error_m[node])
    projection = np.float32(1.0 / np.tan(camera.fovy_rad / 2.0))
    return float(
        error / max(away, np.float32(camera.near_m)) * (projection * np.float32(0.5))
    ) * camera.height_px  # fmt: skip


def drawn(scene: Scene, camera: Camera, tolerance_px: float) -> set[int]:
    """Return the clusters above whom the error is too large, and that are fine or the original."""
    leaves = set(range(len(scene))) - set(scene.parent.tolist())
    return {
        node
        for node in range(len(scene))
        if (
            scene.parent[node] < 0
            or projected_px(scene, int(scene.parent[node]), camera) > tolerance_px
        )
        and (node in leaves or projected_px(scene, node, camera) <= tolerance_px)
    }


@pytest.fixture
def clusters(
    make_scene: Callable[..., Scene], make_levels: Callable[..., LevelTable]
) -> Callable[[int], Scene]:
    """Return a builder of trees in which spheres and errors hold those below, as it asks."""

    def build(seed: int) -> Scene:
        rng = np.random.default_rng(seed)
        parent, center, radius, error = [-1], [np.zeros(3)], [40.0], [4.0]
        for node in range(400):
            if radius[node] < 1.0:
                continue
            for _ in range(rng.integers(2, 5)):
                share = float(rng.uniform(0.4, 0.7))
                step = rng.normal(size=3)
                step *= (1.0 - share) * radius[node] * rng.random() / np.linalg.norm(step)
                parent.append(node)
                center.append(center[node] + step)
                radius.append(share * radius[node])
                error.append(error[node] * float(rng.uniform(0.2, 0.9)))
            if len(parent) > 400:
                break
        leaf = np.setdiff1d(np.arange(len(parent)), parent)
        errors = np.array(error)
        errors[leaf] = 0.0
        n = len(parent)
        counts = np.ones((n, make_levels([(1.0,)]).counts.shape[1]))
        none = np.zeros(n, dtype=np.bool_)
        levels = LevelTable(np.arange(n + 1, dtype=np.int32), counts, errors, np.zeros(n), none)
        return make_scene(
            center, kind=np.arange(n), parent=parent, radius_m=np.array(radius), levels=levels
        )

    return build


def test_the_rule_by_hand(
    make_scene: Callable[..., Scene], make_levels: Callable[..., LevelTable]
) -> None:
    """1 m at 99 m of 720 px and 1 radian is 6.66 px: the root within 7 px, its children below."""
    levels = make_levels([(2.0,), (1.0,)])
    none = np.zeros(2, dtype=np.bool_)
    levels = LevelTable(levels.start, levels.counts, np.array((1.0, 0.0)), np.zeros(2), none)
    scene = make_scene([(0.0, 0.0, 0.0)] * 3, kind=[0, 1, 1], parent=[-1, 0, 0], levels=levels)
    camera = Camera((0.0, 0.0, 100.0), (0.0, 0.0, 0.0, 1.0), 1280, HEIGHT_PX, FOVY_RAD)
    assert projected_px(scene, 0, camera) == pytest.approx(6.656, abs=1e-3)
    assert drawn(scene, camera, 7.0) == {0}
    assert drawn(scene, camera, 6.0) == {1, 2}


@pytest.mark.parametrize("seed", range(5))
def test_the_same_clusters_are_drawn(
    clusters: Callable[[int], Scene], make_view: Callable[..., View], seed: int
) -> None:
    """From 300 m down to within the spheres, of all that is in the frustum."""
    scene = clusters(seed)
    sizes: set[int] = set()
    for away_m in np.geomspace(300.0, 30.0, 12):
        camera = Camera((0.0, 0.0, away_m), (0.0, 0.0, 0.0, 1.0), 1280, HEIGHT_PX, FOVY_RAD)
        policy = ClusterCut(tolerance_px=2.0, gain=0.0)
        policy.reset(scene, 16.0)
        view = make_view(scene, camera)
        roots = scene.roots
        chosen = set(policy.select(view.at(roots[view.state.inside[roots]])).ids.tolist())
        assert chosen == drawn(scene, camera, 2.0) & set(np.flatnonzero(view.state.inside).tolist())
        sizes.add(len(chosen))
    assert len(sizes) > 4
