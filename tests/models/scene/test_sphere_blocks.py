"""Blocks of neighbouring spheres: who is in them, and what is around them."""

import numpy as np

from lodbench.models.scene.sphere_blocks import SphereBlocks


def test_blocks_hold_neighbours() -> None:
    """Of 40,000 spheres on a square each is in one block, within a small sphere around it."""
    rng = np.random.default_rng(3)
    centers_m = np.vstack((rng.uniform(-200, 200, (2, 40_000)), np.zeros(40_000)))
    blocks = SphereBlocks(centers_m.T, np.ones(40_000), np.arange(40_000))
    assert np.sort(blocks.nodes, axis=None).tolist() == list(range(40_000))
    # As squares of 64 spheres they would have a radius of 11.3 m and that of a sphere;
    # those along Morton's curve are half as long again at times.
    assert np.median(blocks.around_m) < 18.0
    gap_m = np.linalg.norm(blocks.points[:3] - blocks.around[:3, :, None], axis=0)
    assert (gap_m + blocks.radius_m <= blocks.around_m[:, None]).all()


def test_large_spheres_stand_apart_from_small_ones() -> None:
    """A few spheres as large as the scene do not make the blocks of the small ones large."""
    rng = np.random.default_rng(3)
    centers_m = np.vstack((rng.uniform(-200, 200, (2, 6_400)), np.zeros(6_400)))
    radius_m = np.ones(6_400)
    radius_m[::100] = 300.0
    blocks = SphereBlocks(centers_m.T, radius_m, np.arange(6_400))
    assert np.count_nonzero(blocks.around_m > 300.0) == 1


def test_the_last_block_is_filled_up_with_its_last_sphere() -> None:
    """65 spheres make two blocks, the second of one sphere 64 times; none make none."""
    centers_m = np.zeros((65, 3))
    centers_m[:, 0] = np.arange(65.0)
    blocks = SphereBlocks(centers_m, np.full(65, 0.5), np.arange(65))
    assert len(blocks) == 2
    assert blocks.nodes[1].tolist() == [64] * 64
    assert blocks.around[:, 1].tolist() == [64.0, 0.0, 0.0, 1.0]
    assert len(SphereBlocks(centers_m, np.ones(65), np.arange(0))) == 0
