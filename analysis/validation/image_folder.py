"""A folder of pictures beside full detail, with a table that sets metrics against them."""

from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import astuple
from pathlib import Path

from ...base.files.whole_folder import claimed_folder, whole_folder
from ...render.gl.image_comparison import PictureFolder, require_images
from .recordings import Recorded

_TABLE, _OURS = "images.csv", r"images\.csv|frame-\d+\.png"
_SHOWN = ("frame", "trace_s", "ssim", "difference", "differing", "flip")
_STEPS = ("step_flip", "held_step_flip", "switch_flip")  # as `PictureStep` has them
_NO_STEP = (float("nan"),) * len(_STEPS)
_METRICS = ("sse_px_p95", "sse_px_max", "popping_px", "triangles", "drawn")


class ImageFolder(PictureFolder):
    """Pictures that are being written, and their table."""

    def write_table(self, recorded: Recorded) -> None:
        """Write ``images.csv``: how each picture differs, and the metrics of its frame.

        Steps are nan where there is no picture before to compare with.
        """
        frames = recorded.frames
        lines = [",".join((*_SHOWN, *_STEPS, "benefit_share", *_METRICS))]
        for picture in recorded.pictures:
            at = picture.frame
            full = float(frames["full_benefit"][at])
            share = float(frames["benefit"][at]) / full if full > 0.0 else 1.0
            shown = (float(getattr(picture, name)) for name in _SHOWN[1:])
            step = _NO_STEP if picture.step is None else astuple(picture.step)
            metrics = (float(frames[name][at]) for name in _METRICS)
            numbers = (*shown, *step, share, *metrics)
            lines.append(",".join([str(at), *(f"{value:.8g}" for value in numbers)]))
        (self.path / _TABLE).write_text("\n".join(lines) + "\n", encoding="utf-8")


@contextmanager
def image_folder(path: Path | None, every: int) -> Generator[ImageFolder | None]:
    """Yield a folder to write pictures to, and put it in place when all is written.

    Raises `InputError` if a package that compares pictures is missing, or the folder holds anything
    but an earlier recording.
    """
    if path is None:
        yield None
        return
    require_images()
    with claimed_folder(path, _OURS, "record"), whole_folder(path) as partial:
        yield ImageFolder(partial, every)
