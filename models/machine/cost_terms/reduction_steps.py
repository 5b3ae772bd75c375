"""The GPU predictor ``reduction_steps``."""

import math

from .term import FrameShape, FrameTerm


class ReductionSteps(FrameTerm):
    """Steps in which threads of a GPU form a sum over all objects drawn, in pairs: log2 of them.

    Peng, Park and Cao ("A real-time system of crowd rendering", 2011, section 5.1) share their
    vertices by a sum over all characters in view; the selection times of their Table 1 rise by the
    same amount with each doubling of the crowd.
    """

    unit = "steps"

    def count(self, frame: FrameShape) -> float:
        """Return the steps, 0 of one object or none."""
        return math.log2(max(frame.objects, 1))
