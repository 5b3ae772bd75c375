"""The picture of `docs/viewer.md`, for `pictures.py`, with Debian's Chromium.

Two policies among the 3,000 objects of `plaza`, right after a turn of a trial has brought most of
them into view.
"""

import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from lodbench.cli.main import run

PICTURE = Path(__file__).parents[1] / "images" / "viewer.png"
COMPARED = (
    "compare --scene plaza --trace trial --paths 2 --seconds 0:4 --seeds 1 --draws 0 --budget-ms 8 "
    "--policy static-screen --policy lodmanager:target=0.6 --out"
)
WHEN_S = 2.3
WIDTH_PX, HEIGHT_PX = 1100, 900


def take_picture(page: Path) -> None:
    """Photograph a viewer at one time of its path, when its pictures are whole."""
    from playwright.sync_api import sync_playwright

    found = shutil.which("chromium")
    if found is None:
        sys.exit("error: expected chromium, found none; apt-get install chromium")
    arguments = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=arguments)
        opened: Any = browser.new_page(viewport={"width": WIDTH_PX, "height": HEIGHT_PX})
        opened.goto(f"{page.as_uri()}#t={WHEN_S}")
        opened.wait_for_selector("html[data-ready]")
        opened.wait_for_timeout(3000)
        opened.screenshot(path=PICTURE)
        browser.close()


def make_picture() -> None:
    """Compare, export the viewer and photograph it."""
    with tempfile.TemporaryDirectory() as folder:
        compared, page = Path(folder) / "run", Path(folder) / "view.html"
        assert run([*COMPARED.split(), str(compared)]) == 0
        assert run(["view", str(compared), "--export", str(page)]) == 0
        take_picture(page)
