"""How many entries of each column of a mask are true, fast where there are few rows."""

import numpy as np

from ...base.arrays import BoolArray, IntArray

_ROWS_OF_A_BYTE = 255


def count_true(mask: BoolArray) -> IntArray:
    """Return counts of (k, n) truth values by column, (n,).

    Bytes are added five times as fast as truth values that become larger integers.
    """
    if len(mask) > _ROWS_OF_A_BYTE:
        return np.add.reduce(mask, axis=0, dtype=np.intp)
    return np.add.reduce(mask.view(np.uint8), axis=0, dtype=np.uint8).astype(np.intp)
