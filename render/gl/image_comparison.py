"""Pictures at a policy's levels compared with full detail, and with the picture before.

FLIP (Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", HPG 2020) says how
much of a difference an observer sees who flips between two pictures; here by its authors' package
and at its default, 67 pixels a degree.

What is seen of switches is told from the motion of the camera by drawing each step twice: as the
policy wants it, and with every node that the frame before drew held at its level there.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...sim.machine.simulated_machine import FrameTimes, Submitted
from .draw_list import Picture
from .opengl_machine import GlMachine, picture_of
from .renderer import Renderer

_VISIBLE = 8  # of 255, from which on a pixel counts as another
_GAIN = 4  # by which the picture of differences is brightened
_PACKAGES = {"skimage": "scikit-image", "flip_evaluator": "flip-evaluator"}


@dataclass(frozen=True, slots=True)
class PictureStep:
    """One frame beside the frame before: mean FLIP in [0, 1].

    Attributes
    ----------
    change : of the pictures of both frames: motion and switches
    held_change : the same with the levels of the frame before: motion alone
    switch : of this frame with its levels and with those of the frame before: switches alone
    """

    change: float
    held_change: float
    switch: float


@dataclass(frozen=True, slots=True)
class PictureDifference:
    """One frame, as drawn and in full detail.

    Attributes
    ----------
    ssim : structural similarity of all pixels, 1 for the same picture (Wang et al. 2004)
    difference : mean absolute difference of the channels over their range, in [0, 1]
    differing : share of pixels of which some channel differs by more than 8 of 255
    flip : mean FLIP, 0 for the same picture, in [0, 1]
    step : what changed since the frame before; None of a first frame, and of hierarchies, whose
        fronts hold no level
    """

    frame: int
    trace_s: float
    ssim: float
    difference: float
    differing: float
    flip: float
    step: PictureStep | None = None


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
    for module, package in _PACKAGES.items():
        if find_spec(module) is None:
            message = f"--images: expected {package}, got none; pip install 'lodbench[gl]'"
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
    seen = mean_flip(full, drawn)
    return PictureDifference(frame, trace_s, similar, float(gap.mean() / 255.0), differing, seen)


def mean_flip(reference: NDArray[np.uint8], test: NDArray[np.uint8]) -> float:
    """Return the mean FLIP of two (height, width, 3) sRGB pictures, in [0, 1]."""
    import flip_evaluator

    if np.array_equal(reference, test):
        return 0.0
    flip: Any = flip_evaluator  # it has no types
    shown = (picture.astype(np.float32) / np.float32(255.0) for picture in (reference, test))
    return float(flip.evaluate(*shown, "LDR", applyMagma=False)[1])


def summarise_pictures(pictures: Sequence[PictureDifference]) -> dict[str, float]:
    """Return means and extremes of at least one comparison, of steps where there are any."""
    ssim = [picture.ssim for picture in pictures]
    summary = {
        "count": len(ssim),
        "ssim_mean": float(np.mean(ssim)),
        "ssim_min": float(np.min(ssim)),
        "difference_mean": float(np.mean([picture.difference for picture in pictures])),
        "flip_mean": float(np.mean([picture.flip for picture in pictures])),
    }
    steps = [picture.step for picture in pictures if picture.step is not None]
    if steps:
        summary["switch_flip_mean"] = float(np.mean([step.switch for step in steps]))
    return summary


class PictureMachine:
    """A machine that compares every so many frames, outside of what is timed.

    Each is compared with full detail and, in a flat scene, with the frame before.

    Attributes
    ----------
    compared : list of PictureDifference
    """

    def __init__(self, machine: GlMachine, renderer: Renderer, pictures: PictureFolder) -> None:
        self._machine, self._renderer = machine, renderer
        self._pictures = pictures
        self._before: NDArray[np.uint8] | None = None  # the frame before, if this is compared
        self._levels = _LastLevels()
        self.compared: list[PictureDifference] = []

    def begin(self) -> None:
        """Begin a frame."""
        self._machine.begin()

    def run(self, frame: Submitted) -> FrameTimes:
        """Draw and measure the frame, and compare it if it is its turn."""
        times = self._machine.run(frame)
        number, every = frame.view.frame, self._pictures.every
        picture, drawn = picture_of(frame), None
        if number % every == 0:
            drawn = self._renderer.picture(picture)
            self._compare(frame, picture, drawn)
        if (number + 1) % every == 0 and frame.view.scene.flat:
            drawn = self._renderer.picture(picture) if drawn is None else drawn
            self._before = drawn
        self._levels.keep(picture)
        return times

    def _compare(self, frame: Submitted, picture: Picture, drawn: NDArray[np.uint8]) -> None:
        number = frame.view.frame
        full = self._renderer.picture(picture_of(frame, full=True))
        difference = compare_pictures(number, frame.view.time_ns * 1e-9, drawn, full)
        if self._before is not None:
            step = self._step(self._before, picture, drawn)
            difference, self._before = replace(difference, step=step), None
        self.compared.append(difference)
        _write(self._pictures.path / f"frame-{number:06}.png", drawn, full)

    def _step(
        self, before: NDArray[np.uint8], picture: Picture, drawn: NDArray[np.uint8]
    ) -> PictureStep:
        change = mean_flip(before, drawn)
        held = self._levels.held(picture)
        if held is None:
            return PictureStep(change, change, 0.0)
        still = self._renderer.picture(held)
        return PictureStep(change, mean_flip(before, still), mean_flip(still, drawn))


class _LastLevels:
    """At which row of the level table the frame before drew each node."""

    def __init__(self) -> None:
        self._ids = np.empty(0, dtype=np.int32)
        self._row = np.empty(0, dtype=np.int64)

    def keep(self, picture: Picture) -> None:
        """Take over what a frame draws."""
        self._ids, self._row = picture.ids, picture.row

    def held(self, picture: Picture) -> Picture | None:
        """Return a picture with the levels of the frame before; None if no level is another.

        Nodes that the frame before did not draw have come into view, and stay as they are.
        """
        last = np.full(picture.centers_m.shape[1], -1, dtype=np.int64)
        last[self._ids] = self._row
        row = last[picture.ids]
        row = np.where(row < 0, picture.row, row)
        return None if np.array_equal(row, picture.row) else replace(picture, row=row)


def _write(path: Path, drawn: NDArray[np.uint8], full: NDArray[np.uint8]) -> None:
    """Write both pictures side by side, and their difference: the darker the more."""
    from PIL import Image

    gap = np.abs(full.astype(np.int16) - drawn.astype(np.int16)).max(axis=2, keepdims=True)
    shown = 255 - np.clip(_GAIN * np.repeat(gap, 3, axis=2), 0, 255).astype(np.uint8)
    Image.fromarray(np.concatenate((drawn, full, shown), axis=1)).save(path)
