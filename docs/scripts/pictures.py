"""Make the pictures of `docs/reading-a-report.md` and `docs/viewer.md`, with Debian's Chromium.

``pictures.py`` carries a suite, a comparison and a sweep out in ``out/pictures``, where a second
start goes on, takes pictures of the pages that come out, and keeps the record of the comparison
beside them: what captions claim is held to that by ``tests/docs/test_pictures.py``.
"""

import shutil
import sys
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from viewer_picture import PICTURE as VIEWER
from viewer_picture import make_picture

from lodbench.analysis.report.render import SECTIONS
from lodbench.cli.main import run

ROOT = Path(__file__).parents[2]
IMAGES = ROOT / "docs" / "images"
RECORD = IMAGES / "reading-a-report.json"
POLICIES = ("static-screen", "gobbetti", "feedback", "hoppe", "full")
"""Of the comparison whose report is shown."""
SWEPT = ROOT / "docs" / "examples" / "sweeps" / "budgets.toml"
STUDY = ROOT / "out" / "pictures"
WIDTH_PX = 1000
_MARGIN_PX = 12
_COLORS, _BRIGHT = 100, 60
_SATURATED = 60  # between the channels of a colour that tells policies apart
_MOST_BYTES = 110_000

REPORT = {
    "answer": ("the_answer", "ranks"),
    "tradeoffs": ("tradeoffs",),
    "along-the-path": ("along_the_trace",),
    "switches": ("flicker", "object_levels"),
    "robustness": ("robustness",),
    "worst-moments": ("worst_moments",),
    "costs-and-predictions": ("cost_breakdown", "predictions"),
    "slow-frames": ("slow_frames", "load_steps"),
    "above-and-provenance": ("from_above", "provenance"),
}
"""By the name of a picture the first and the last section of the report that it shows."""


@contextmanager
def opened(page: Path) -> Generator[Any]:
    """Open a page of the disk in a browser."""
    from playwright.sync_api import sync_playwright

    found = shutil.which("chromium")
    if found is None:
        sys.exit("error: expected chromium, found none; apt-get install chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
        shown: Any = browser.new_page(viewport={"width": WIDTH_PX, "height": 900})
        shown.goto(page.resolve().as_uri())
        yield shown
        browser.close()


def photograph(page: Path, parts: Mapping[str, tuple[int, int]]) -> None:
    """Cut pictures out of one of a whole page, each from one of its sections to another."""
    with opened(page) as shown:
        boxes: list[list[float]] = shown.eval_on_selector_all(
            "main > section, main > details",
            "els => els.map(e => e.getBoundingClientRect()).map(b => [b.top, b.bottom])",
        )
        whole = Image.open(BytesIO(shown.screenshot(full_page=True))).convert("RGB")
    for name, (first, last) in parts.items():
        top = 0 if first == 0 else round(boxes[first][0]) - _MARGIN_PX
        bottom = min(round(boxes[last][1]) + _MARGIN_PX, whole.height)
        save(whole.crop((0, top, whole.width, bottom)), IMAGES / f"{name}.png")


def save(picture: Image.Image, path: Path) -> None:
    """Write a picture in few colours, which makes it small and keeps every ink."""
    pixels = np.asarray(picture.convert("RGB")).astype(np.int32)
    codes, of_pixel, counts = np.unique(
        pixels @ np.array([65_536, 256, 1], dtype=np.int32), return_inverse=True, return_counts=True
    )
    colors = np.column_stack((codes >> 16, codes >> 8 & 255, codes & 255))
    # Inks are of few pixels beside the shades of a drawn scene, and have to stay what they are.
    order = np.argsort(-counts, kind="stable")
    bright = order[np.ptp(colors[order], axis=1) > _SATURATED][:_BRIGHT]
    kept = colors[np.unique(np.concatenate((order[:_COLORS], bright)))]
    apart = colors[:, None, :] - kept[None, :, :]
    nearest = np.square(apart).sum(axis=2).argmin(axis=1).astype(np.uint8)
    few = Image.fromarray(nearest[of_pixel.ravel()].reshape(picture.height, picture.width), "P")
    few.putpalette(kept.ravel().tolist())
    few.save(path, optimize=True)
    size = path.stat().st_size
    assert size <= _MOST_BYTES, f"{path.name}: expected {_MOST_BYTES} bytes at most, got {size}"


def lodbench(*words: str) -> None:
    """Run a command, which has to end well."""
    code = run([*words])
    assert code == 0, f"lodbench {' '.join(words)} ended with {code}"


def main() -> None:
    """Make all pictures and the record."""
    STUDY.mkdir(parents=True, exist_ok=True)
    ranked, compared, swept, page = (
        STUDY / name for name in ("suite", "compared", "budgets", "sweep.html")
    )
    lodbench("suite", "quick", "--out", str(ranked), "--policy-timeout", "600")
    photograph(ranked / "report.html", {"leaderboard": (0, 3)})
    named = [word for policy in POLICIES for word in ("--policy", policy)]
    lodbench("compare", "--quick", "--budget-ms", "16", *named, "--out", str(compared))
    shutil.copyfile(compared / "comparison.json", RECORD)
    at = {name: place for place, name in enumerate(SECTIONS)}
    parts = {f"report-{name}": (at[some[0]], at[some[-1]]) for name, some in REPORT.items()}
    photograph(compared / "report.html", parts)
    lodbench("sweep", str(SWEPT), "--out", str(swept))
    lodbench("sweep", "show", str(swept), "--html", str(page), "--metric", "work_ms_p99",
             "--metric", "visible_error_px")  # fmt: skip
    photograph(page, {"sweep": (0, 2)})
    make_picture()
    save(Image.open(VIEWER).convert("RGB"), VIEWER)


if __name__ == "__main__":
    main()
