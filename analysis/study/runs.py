"""What studies share of their runs: how far they are, and which draws of a machine they take."""

from collections.abc import Callable

import numpy as np

from ...models.machine.hardware import HardwareProfile

Progress = Callable[[int, int], None]
"""Called with the replays done and the replays in all."""


def choose_draws(hardware: HardwareProfile, count: int) -> list[int]:
    """Return evenly spaced posterior draws, each once."""
    available = 0 if hardware.posterior is None else len(hardware.posterior)
    chosen = np.linspace(0, available - 1, min(count, available)).round()
    return [int(draw) for draw in chosen]
