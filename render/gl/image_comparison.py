"""Pictures at a policy's levels compared with full detail: per-pixel difference and SSIM."""

from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...sim.simulated_machine import FrameTimes, Submitted
from .opengl_machine import GlMachine, picture_of
from .renderer import Renderer

_VISIBLE = 8  # of 255, from which on a pixel counts as another
_GAIN = 4  # by which the picture of differences is brightened


@dataclass(frozen=True, slots=True)
class PictureDifference:
    """One frame, as drawn and in full detail.

    Attributes
    ----------
    ssim : structural similarity of all pixels, 1 for the same picture (Wang et al. 2004)
    difference : mean absolute difference of the channels over their range, in [0, 1]
    differing : share of pixels of which some channel differs by more than 8 of 255
    """

    frame: int
    trace_s: float
    ssim: float
    difference: float
    differing: float


@dataclass(frozen=True, slots=True)
class PictureFolder:
    """Where pictures are written, one every so many frames."""

    path: Path
    every: int

    def __post_init__(self) -> None:
        if self.every < 1:
            raise InputError(f"--image-every: expected frames >= 1, got {self.every}")


def require_images() -> None:
    """Raise InputError, naming the package to install, if pictures cannot be compared."""
    if find_spec("skimage") is None:
        message = "--images: expected scikit-image, got none; pip install 'lodbench[gl]'"
        raise InputError(message)


def compare_pictures(
    frame: int, trace_s: float, drawn: NDArray[np.uint8], full: NDArray[np.uint8]
) -> PictureDifference:
    """Return how two (height, width, 3) pictures differ; both sides at least 7 pixels long."""
    from skimage import metrics

    measures: Any = metrics  # its functions have no complete types
    similar = float(measures.structural_similarity(full, drawn, channel_axis=2, data_range=255))
    gap = np.abs(full.astype(np.int16) - drawn.astype(np.int16))
    differing = float((gap.max(axis=2) > _VISIBLE).mean())
    return PictureDifference(frame, trace_s, similar, float(gap.mean() / 255.0), differing)


class PictureMachine:
    """A machine that compares every so many frames with full detail, outside of what is timed.

    Attributes
    ----------
    compared : list of PictureDifference
    """

    def __init__(self, machine: GlMachine, renderer: Renderer, pictures: PictureFolder) -> None:
        self._machine, self._renderer = machine, renderer
        self._pictures = pictures
        self.compared: list[PictureDifference] = []

    def begin(self) -> None:
        """Begin a frame."""
        self._machine.begin()

    def run(self, frame: Submitted) -> FrameTimes:
        """Draw and measure the frame, and compare it if it is its turn."""
        times = self._machine.run(frame)
        if frame.view.frame % self._pictures.every == 0:
            self._compare(frame)
        return times

    def _compare(self, frame: Submitted) -> None:
        renderer, number = self._renderer, frame.view.frame
        drawn = renderer.picture(picture_of(frame))
        full = renderer.picture(picture_of(frame, full=True))
        difference = compare_pictures(number, frame.view.time_ns * 1e-9, drawn, full)
        self.compared.append(difference)
        _write(self._pictures.path / f"frame-{number:06}.png", drawn, full)


def _write(path: Path, drawn: NDArray[np.uint8], full: NDArray[np.uint8]) -> None:
    """Write both pictures side by side, and their difference: the darker the more."""
    from PIL import Image

    gap = np.abs(full.astype(np.int16) - drawn.astype(np.int16)).max(axis=2, keepdims=True)
    shown = 255 - np.clip(_GAIN * np.repeat(gap, 3, axis=2), 0, 255).astype(np.uint8)
    Image.fromarray(np.concatenate((drawn, full, shown), axis=1)).save(path)
