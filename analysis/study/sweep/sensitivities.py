"""Sensitivity of metrics to the axes of a study, from its results."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..sensitivity import FEWEST_SEEDS, Share, Shares, split_variance
from .full_grid import find_full_grid
from .query import Query

TOGETHER, NOISE = "together", "noise of seeds"


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """How the variance of one metric is split.

    Attributes
    ----------
    metric : str
    shares : dict of str to Share
        By axis, then `TOGETHER` and `NOISE`; empty where there is nothing to split.
    """

    metric: str
    shares: dict[str, Share]


@dataclass(frozen=True, slots=True)
class Sensitivities:
    """How the variances of metrics are split.

    Attributes
    ----------
    runs : int
        Of the full grid.
    seeds : int
        Of each combination.
    metrics : tuple of Sensitivity
    notes : tuple of str
        What was left out and joined, and what has no shares or no intervals and why, a line each.
    """

    runs: int
    seeds: int
    metrics: tuple[Sensitivity, ...]
    notes: tuple[str, ...]


def find_sensitivities(query: Query, metrics: Sequence[str]) -> Sensitivities:
    """Split the variance of metrics over the runs that a query holds.

    Raises `InputError` if they hold no full grid (see `find_full_grid`).
    """
    axes = query.results.axes
    table = query.rows([*axes, "status", *metrics])
    grid = find_full_grid(table, axes)
    notes = list(grid.notes)
    found: list[Sensitivity] = []
    for metric in metrics:
        values = table.column(metric).to_numpy().astype(np.float64)[grid.rows]
        missing = int(np.count_nonzero(np.isnan(values)))
        shares = None if missing else split_variance(values)
        if missing:
            notes.append(f"{metric}: {missing:,} of {values.size:,} runs have none, so no shares")
        elif shares is None:
            notes.append(f"{metric}: the same in all runs")
        found.append(Sensitivity(metric, {} if shares is None else _named(grid.axes, shares)))
    seeds = grid.rows.shape[-1]
    if seeds < FEWEST_SEEDS:
        notes.append(f"no intervals: they need {FEWEST_SEEDS} seeds or more, got {seeds}")
    return Sensitivities(grid.rows.size, seeds, tuple(found), tuple(notes))


def _named(axes: Sequence[str], shares: Shares) -> dict[str, Share]:
    named = dict(zip(axes, shares.axes, strict=True)) | {TOGETHER: shares.together}
    return named if shares.noise is None else named | {NOISE: shares.noise}
