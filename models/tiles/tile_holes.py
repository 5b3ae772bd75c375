"""Tiles that cannot be drawn whole, and what is left when no such hole replaces a parent."""

from collections.abc import Sequence

import numpy as np

from ...base.arrays import BoolArray


def keep_from_holes(
    parent: Sequence[int],
    additive: Sequence[bool],
    solid: BoolArray,
    whole: BoolArray,
    empty: BoolArray,
) -> BoolArray:
    """Return the tiles that can be drawn, or lead to such, without a hole where others would do.

    A renderer keeps a tile on the screen until all that replaces it is there (3D Tiles, REPLACE),
    which what is missing never is: such a tile is a leaf, whatever stands below it.  Beside a tile
    that stays (ADD) only what is missing goes.  A tile without geometry is passed through.  Where
    nothing above a hole has geometry it stays one.  Tiles that have no content by design, and
    nothing below that has, are no holes, and go too, unless nothing at all can be drawn.

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
    empty
        (n,) whether a tile has no content by design.
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
    keep = _leads_to_content(parent, empty) if solid.any() else np.ones(n, dtype=np.bool_)
    for row, above in enumerate(parent):
        if above < 0:
            continue
        keep[row] &= keep[above]
        if solid[above] and below[above]:
            keep[row] &= additive[above] and not hole[row]
    return keep


def _leads_to_content(parent: Sequence[int], empty: BoolArray) -> BoolArray:
    leads = ~empty
    for row in range(len(parent) - 1, 0, -1):
        if leads[row] and parent[row] >= 0:
            leads[parent[row]] = True
    return leads
