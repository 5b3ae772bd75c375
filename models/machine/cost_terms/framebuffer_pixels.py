"""The GPU predictor ``framebuffer_pixels``."""

from .term import FrameShape, FrameTerm


class FramebufferPixels(FrameTerm):
    """Pixels of the picture, width times height, as it is rendered."""

    unit = "px"

    def count(self, frame: FrameShape) -> float:
        """Return the pixels."""
        return frame.pixels
