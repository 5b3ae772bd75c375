"""Whether two measurements of the same policies order them alike."""

from collections.abc import Sequence
from typing import Any

import numpy as np


def kendall_tau(first: Sequence[float | None], second: Sequence[float | None]) -> float | None:
    """Return Kendall's τ-b of paired values: 1 for the same order, −1 for the reverse.

    None where fewer than two pairs are complete, or one side does not tell any two apart.
    """
    from scipy.stats import kendalltau

    pairs = [(a, b) for a, b in zip(first, second, strict=True) if a is not None and b is not None]
    if len({a for a, _ in pairs}) < 2 or len({b for _, b in pairs}) < 2:
        return None
    found: Any = kendalltau(*np.array(pairs).T)
    return float(found.statistic)
