"""A flight over all of Styria, 200 m above the ground; the paper's own path is not printed.

It goes from one edge to the other, since what is in view decides what there is to share: at its
beginning terrain as far as the other edge, near its end mostly trees.
"""

import numpy as np

from ....base.arrays import FloatArray
from ....models.scenes.styria import CELL_M, WIDTH_M, styria_heights
from ....traces.cameras.camera_trace import CameraTrace
from ....traces.cameras.orientation import look_along

LENGTH_S = 40.0
SPEED_M_S = 2_500.0
UP_M = 200.0
_PITCH_DEG = -25.0  # as the tool's own fly-over looks
_SWAY_M, _RATE_HZ = 15_000.0, 10.0
_BEGIN_M = 10_000.0
_SIGHT_M = 500.0  # as far around the height of the ground is the highest, so that nothing is hit


def flight(seconds: float = LENGTH_S) -> CameraTrace:
    """Return 40 s at 2,500 m/s northwards, swaying once, 25 degrees down, or a part."""
    time_s = np.arange(0.0, seconds + 0.5 / _RATE_HZ, 1.0 / _RATE_HZ)
    turn = 2.0 * np.pi * time_s / LENGTH_S
    x = 0.5 * WIDTH_M + _SWAY_M * np.sin(turn)
    y = _BEGIN_M + SPEED_M_S * time_s
    sideways = _SWAY_M * np.cos(turn) * 2.0 * np.pi / LENGTH_S
    heading = np.arctan2(SPEED_M_S, sideways)
    z = _ground(x, y) + UP_M
    return CameraTrace(
        "flight",
        time_s,
        np.stack((x, y, z), axis=1),
        look_along(heading, np.full(len(x), np.radians(_PITCH_DEG))),
        np.zeros(len(x), dtype=np.bool_),
    )


def _ground(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the highest ground near each place, evened out along the way."""
    heights = styria_heights()
    reach = int(np.ceil(_SIGHT_M / CELL_M))
    row, column = (np.round(v / CELL_M).astype(np.int64) for v in (y, x))
    highest = np.array(
        [
            heights[r - reach : r + reach + 1, c - reach : c + reach + 1].max()
            for r, c in zip(row, column, strict=True)
        ]
    )
    window = np.hanning(11)[1:-1]
    padded = np.pad(highest, 4, mode="edge")
    # Evened out, but nowhere below the ground itself.
    return np.maximum(np.convolve(padded, window / window.sum(), mode="valid"), highest)
