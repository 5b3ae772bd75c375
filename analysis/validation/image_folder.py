"""A folder of pictures beside full detail, with a table that sets metrics against them."""

from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from ...base.files.whole_folder import claimed_folder, whole_folder
from ...render.gl.image_comparison import PictureFolder, require_images
from .recordings import Recorded

_TABLE, _OURS = "images.csv", r"images\.csv|frame-\d+\.png"
_METRICS = ("sse_px_p95", "sse_px_max", "popping_px", "triangles", "drawn")


class ImageFolder(PictureFolder):
    """Pictures that are being written, and their table."""

    def write_table(self, recorded: Recorded) -> None:
        """Write ``images.csv``: how each picture differs, and the metrics of its frame."""
        frames = recorded.frames
        lines = [f"frame,trace_s,ssim,difference,differing,benefit_share,{','.join(_METRICS)}"]
        for picture in recorded.pictures:
            at = picture.frame
            full = float(frames["full_benefit"][at])
            share = float(frames["benefit"][at]) / full if full > 0.0 else 1.0
            numbers = (picture.trace_s, picture.ssim, picture.difference, picture.differing, share)
            metrics = (float(frames[name][at]) for name in _METRICS)
            lines.append(",".join([str(at), *(f"{value:.8g}" for value in (*numbers, *metrics))]))
        (self.path / _TABLE).write_text("\n".join(lines) + "\n", encoding="utf-8")


@contextmanager
def image_folder(path: Path | None, every: int) -> Generator[ImageFolder | None]:
    """Yield a folder to write pictures to, and put it in place when all is written.

    Raises `InputError` if scikit-image is missing, or the folder holds anything but an earlier
    recording.
    """
    if path is None:
        yield None
        return
    require_images()
    with claimed_folder(path, _OURS, "record"), whole_folder(path) as partial:
        yield ImageFolder(partial, every)
