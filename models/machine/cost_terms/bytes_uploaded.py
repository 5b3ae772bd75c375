"""The GPU predictor ``bytes_uploaded``."""

from .term import FrameShape, FrameTerm


class BytesUploaded(FrameTerm):
    """Bytes sent to the GPU: geometry of levels at their first use, and index sets that changed.

    An index set is sent whole, as a totally ordered mesh and index buffers need; a machine that
    changes strips in place (LodStrips) prices `triangles_changed` instead.
    """

    unit = "bytes"
    of_changes = True

    def count(self, frame: FrameShape) -> float:
        """Return the bytes."""
        return frame.changes.bytes_uploaded
