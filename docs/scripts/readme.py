"""Make what the README shows: the answer of its tour, and the picture of a report.

``readme.py answer DATA`` runs the tour in an empty folder where ``data`` is DATA, and writes what
its comparison says.  ``readme.py picture REPORT`` photographs a page that `compare --out` wrote, by
the Chromium or Chrome that the shell finds.
"""

import contextlib
import json
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path

from lodbench.cli.main import run

ROOT = Path(__file__).parents[2]
README, PICTURE = ROOT / "README.md", ROOT / "docs" / "images" / "report.png"
TOUR = re.compile(
    r"(?P<commands>lodbench scene build .*?lodbench compare .*?^```\n\n```text\n)"
    r"(?P<answer>.*?)```\n",
    re.MULTILINE | re.DOTALL,
)
WIDTH = 100
SIZE_PX = (1200, 1475)
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")


def write_answer(data: Path) -> None:
    """Run the tour up to its comparison and put the answer, as a terminal has it, below that."""
    text = README.read_text(encoding="utf-8")
    found = TOUR.search(text)
    assert found, "the tour has a comparison with its answer"
    link = data.resolve()
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        Path("data").symlink_to(link)
        for line in found["commands"].replace("\\\n", " ").splitlines():
            if line.startswith("lodbench "):
                assert run(shlex.split(line)[1:]) == 0, line
        (record,) = Path().glob("out/*/comparison.json")
        answer: list[str] = json.loads(record.read_text(encoding="utf-8"))["answer"]
    wrapped = "\n".join(textwrap.fill(sentence, WIDTH) for sentence in answer)
    start, end = found.span("answer")
    README.write_text(f"{text[:start]}{wrapped}\n{text[end:]}", encoding="utf-8")


def take_picture(report: Path) -> None:
    """Photograph the head of a report."""
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        sys.exit(f"error: expected a browser without a window, found none of {BROWSERS}")
    width, height = SIZE_PX
    options = ["--headless", "--no-sandbox", "--hide-scrollbars", "--virtual-time-budget=5000"]
    shot = [f"--window-size={width},{height}", f"--screenshot={PICTURE}"]
    command = [browser, *options, *shot, report.resolve().as_uri()]
    subprocess.run(command, check=True)  # noqa: S603 - a browser of known name


if __name__ == "__main__":
    what, source = sys.argv[1:]
    {"answer": write_answer, "picture": take_picture}[what](Path(source))
