"""Tiles that cannot be drawn whole, and what is left when no such hole replaces a parent."""

from collections.abc import Sequence

import numpy as np

from ...base.arrays import BoolArray


def keep_from_holes(
    parent: Sequence[int], additive: Sequence[bool], solid: BoolArray, whole: BoolArray
) -> BoolArray:
    """Return the tiles that can be drawn, or lead to such, without a hole where others would do.

    A renderer keeps a tile on the screen until all that replaces it is there (3D Tiles, REPLACE),
    which what is missing never is: such a tile is a leaf, whatever stands below it.  Beside a tile
    that stays (ADD) only what is missing goes.  A tile without geometry is passed through.  Where
    nothing above a hole has geometry it stays one.

    Parameters
    ----------
    parent
        (n,) of each tile, parents first; -1 of roots.
    additive
        (n,) whether a tile stays when its children are drawn.
    solid
        (n,) whether anything of a tile can be drawn.
    whole
        (n,) whether all contents of a tile could be read.
    """
    n = len(parent)
    leaf, below = np.ones(n, dtype=np.bool_), np.zeros(n, dtype=np.bool_)
    leaf[[above for above in parent if above >= 0]] = False
    hole = ~whole & (leaf | solid)
    for row in range(n - 1, -1, -1):
        # Holes below a tile with geometry end there; it is one itself only by its own contents.
        if below[row] and not solid[row]:
            hole[row] = True
        if hole[row] and parent[row] >= 0:
            below[parent[row]] = True
    keep = np.ones(n, dtype=np.bool_)
    for row, above in enumerate(parent):
        if above < 0:
            continue
        keep[row] = keep[above]
        if solid[above] and below[above]:
            keep[row] &= additive[above] and not hole[row]
    return keep
