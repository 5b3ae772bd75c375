"""The GPU predictor ``first_uses``."""

from .term import FrameShape, FrameTerm


class FirstUses(FrameTerm):
    """Levels drawn for the first time in a replay: their pipelines are compiled.

    All resolutions of a continuous type are one level.
    """

    unit = "first uses"
    of_changes = True

    def count(self, frame: FrameShape) -> float:
        """Return the levels."""
        return frame.changes.first_uses
