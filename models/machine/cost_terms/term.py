"""What a cost term is: something that is counted in a frame, and costs so much a unit.

A predictor that is neither a column of the level table nor one of these has no price.  Adding a
term takes a file in this folder, named after its predictor and holding one class in the same words
(``quad_overhead_samples.py``, ``QuadOverheadSamples``), and the name in `base.predictors`.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar, NamedTuple, Protocol

import numpy as np

from ....base.arrays import BoolArray, FloatArray


class Footprint(Protocol):
    """Where m objects are in the picture."""

    @property
    def area_px(self) -> FloatArray:
        """Projected area of the bounding spheres, at most the viewport's, (m,)."""
        ...

    @property
    def covered_px(self) -> FloatArray:
        """Samples that the objects themselves should cover, (m,)."""
        ...

    @property
    def inside_share(self) -> FloatArray:
        """Share of each object that is in the picture, in [0, 1], (m,).

        Over several pictures it is summed, as samples and areas are.
        """
        ...


class Pass(NamedTuple):
    """Which of m objects one camera draws, (m,) bool, and where all of them are in its picture."""

    drawn: BoolArray
    seen: "Footprints"


class Footprints(Footprint, Protocol):
    """Where m objects are in the pictures of one camera or several; a policy's `View` is one."""

    @property
    def passes(self) -> tuple[Pass, ...]:
        """What each camera draws of the objects; a single one draws all."""
        ...


class LevelChanges(NamedTuple):
    """What a frame draws that the frames before did not.

    Attributes
    ----------
    levels_changed : int
        Nodes drawn at another level than in the frame before.
    first_uses : int
        Levels drawn for the first time.
    bytes_uploaded : float
        Geometry of these, and index sets that changed.
    """

    levels_changed: int = 0
    first_uses: int = 0
    bytes_uploaded: float = 0.0


NO_CHANGES = LevelChanges()


class FrameShape(NamedTuple):
    """What a frame is as a whole: pixels, types and objects drawn, and what is new in it."""

    pixels: float
    types: int
    changes: LevelChanges = NO_CHANGES
    objects: int = 1


class FrameTerm(ABC):
    """A term of the frame as a whole.

    Attributes
    ----------
    unit : str
        What is counted.
    of_changes : bool
        Whether it is of what is new in the frame, and so of no frame by itself.
    """

    unit: ClassVar[str]
    of_changes: ClassVar[bool] = False

    @abstractmethod
    def count(self, frame: FrameShape) -> float:
        """Return how many units a frame has."""


class ViewTerm(ABC):
    """A term of each object, by its level and by where it is in the picture.

    Attributes
    ----------
    unit : str
        What is counted.
    reads : tuple of str
        Level predictors that the count depends on; none if the view alone decides.
    logged_free : bool
        Whether frames are counted by it even where it costs nothing, so that logs have it.
    """

    unit: ClassVar[str]
    reads: ClassVar[tuple[str, ...]] = ()
    logged_free: ClassVar[bool] = False

    @abstractmethod
    def count(self, level: Sequence[FloatArray], seen: Footprint) -> FloatArray:
        """Return how many units each object has, never fewer at a finer level.

        `level` holds what the class `reads`, one array each.  These are of one shape, (m,) or
        (m, L) for L levels of each object, and the footprint's arrays stand beside them.
        """

    def line_above(
        self, full: Sequence[FloatArray], seen: Footprint, lowest: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return start and slope, (m,) each, of a line over resolution that is nowhere below.

        It holds from the resolution `lowest` to 1, where an object has `full` of what the class
        reads.  Any term has one that is level; a closer one lets policies use more of the budget.
        """
        count = self.count(full, seen)
        return count, np.zeros(len(count))
