"""The GPU predictor ``state_changes``."""

from .term import FrameShape, FrameTerm


class StateChanges(FrameTerm):
    """Distinct types drawn in the frame: pipeline and material are set once for each."""

    unit = "types"

    def count(self, frame: FrameShape) -> float:
        """Return the number of types."""
        return frame.types
