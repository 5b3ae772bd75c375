"""The GPU predictor ``levels_changed``."""

from .term import FrameShape, FrameTerm


class LevelsChanged(FrameTerm):
    """Nodes drawn at another level than in the frame before.

    Of a continuous type another collapse step; in a tree, nodes that take the place of others.
    """

    unit = "levels"
    of_changes = True

    def count(self, frame: FrameShape) -> float:
        """Return the nodes."""
        return frame.changes.levels_changed
