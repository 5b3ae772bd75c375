"""What studies share of their runs: how far they are, and which draws of a machine they take."""

from collections.abc import Callable

import numpy as np

from ...models.machine.hardware import HardwareProfile

Progress = Callable[[int, int], None]
"""Called with the replays done and the replays in all."""


def part_of(progress: Progress | None, at: int, parts: int) -> Progress | None:
    """Return what tells of one part of the work as of a thousand steps of all parts."""
    if progress is None:
        return None
    return lambda now, of: progress(1000 * at + 1000 * now // max(of, 1), 1000 * parts)


def choose_draws(hardware: HardwareProfile, count: int) -> list[int]:
    """Return draws of a machine, each once: of one with scatter the first, else evenly spaced ones.

    Any first draws cover the scatter (`models.machine.scatter`); samples of a fit are evenly spaced
    along its chain, of which any choice is as good.
    """
    available = hardware.draws
    if hardware.scatter.any:
        return list(range(min(count, available)))
    chosen = np.linspace(0, available - 1, min(count, available)).round()
    return [int(draw) for draw in chosen]
