"""The space that a scene takes, by which camera traces are placed."""

import numpy as np

from ...base.arrays import FloatArray
from .scene import Scene


def scene_extent(scene: Scene) -> tuple[FloatArray, FloatArray]:
    """Return centre and size in metres, (3,) both, of the box about every bounding sphere.

    Moving nodes count with the whole circle that they go round.
    """
    low = scene.center_m - scene.radius_m[:, None]
    high = scene.center_m + scene.radius_m[:, None]
    motion = scene.motion
    if motion is not None:
        angle = motion.phase_rad
        hub = -motion.radius_m[:, None] * np.stack((np.cos(angle), np.sin(angle)), axis=1)
        swing = np.abs(motion.radius_m)[:, None]
        np.add.at(low[:, :2], motion.node, hub - swing)
        np.add.at(high[:, :2], motion.node, hub + swing)
    bottom, top = low.min(axis=0), high.max(axis=0)
    return (bottom + top) / 2.0, top - bottom
