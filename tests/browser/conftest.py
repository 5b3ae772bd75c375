"""Pages in a real browser, with its network off: Debian's Chromium, driven by Playwright."""

import shutil
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import Any

import pytest

from lodbench.analysis.study.comparison_folder import Compared, read_results
from lodbench.cli.main import run

HERE = Path(__file__).parent
ASK = "no browser to open pages in: apt-get install chromium, and npm ci in tests/browser"
"""What `.ci/run` looks for: there no test of a page may be skipped."""

_NAMES = ("chromium", "chromium-browser", "google-chrome")
_ARGUMENTS = (
    "--no-sandbox",  # as root, which CI is
    "--use-angle=swiftshader",  # WebGL where there is no GPU
    "--enable-unsafe-swiftshader",
    "--disable-gpu-compositing",  # nor is there one to put pictures on the screen
)

_DRIVER = "GL Driver Message"
"""Begins what Chromium says of itself, where pictures are read back from a driver without a GPU."""

PATIENCE = ("--policy-timeout", "600")
"""No policy is judged by how busy the machine is that opens pages beside it."""

Open = Callable[..., Any]


@pytest.fixture(scope="session")
def browser() -> Generator[Any]:
    """Start Chromium once."""
    found = next(filter(None, map(shutil.which, _NAMES)), None)
    if found is None or not (HERE / "node_modules").is_dir():
        pytest.skip(ASK)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=found, args=[*_ARGUMENTS])
        yield chromium
        chromium.close()


def listen(page: Any, event: str, heard: Callable[[Any], object]) -> None:
    """Have a page tell of an event."""
    page.on(event, heard)


@pytest.fixture
def open_page(browser: Any) -> Iterator[Open]:
    """Return what opens a page; it fails the test that the page speaks, or asks for anything."""
    said: list[str] = []
    contexts: list[Any] = []

    def open_at(url: str, *, width: int = 1280, height: int = 900, offline: bool = True,
                **media: Any) -> Any:  # fmt: skip
        context = browser.new_context(viewport={"width": width, "height": height}, **media)
        context.set_offline(offline)
        contexts.append(context)
        page = context.new_page()
        own = url.partition("#")[0]

        def hear(text: str) -> None:
            if _DRIVER not in text:
                said.append(text)

        listen(page, "console", lambda message: hear(message.text))
        listen(page, "pageerror", lambda error: hear(str(error)))
        listen(page, "dialog", lambda dialog: hear(dialog.message))
        listen(page, "request", lambda asked: own == asked.url.partition("#")[0] or hear(asked.url))
        page.goto(url)
        return page

    yield open_at
    for context in contexts:
        context.close()
    assert said == []


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a comparison of policies among 3,000 objects: one is far off scale, one predicts."""
    out = tmp_path_factory.mktemp("browser") / "run"
    policies = ("static-screen:bias=1.17", "lodmanager:target=0.6", "funkhouser:aim=0.2", "full")
    words = "--scene plaza --trace trial --paths 2 --seconds 0:3 --seeds 1 --draws 0 --budget-ms 8"
    chosen = [word for policy in policies for word in ("--policy", policy)]
    assert (
        run(["compare", *words.split(), *chosen, "--workers", "1", *PATIENCE, "--out", str(out)])
        == 0
    )
    return out


@pytest.fixture(scope="session")
def compared(folder: Path) -> Compared:
    """Return what that comparison wrote."""
    return read_results(folder)


@pytest.fixture(scope="session")
def serious() -> Callable[[Any], list[str]]:
    """Return what has axe-core judge a page: what it finds serious or worse."""
    axe = (HERE / "node_modules" / "axe-core" / "axe.min.js").read_text(encoding="utf-8")

    def judge(page: Any) -> list[str]:
        page.evaluate(axe)
        found = page.evaluate("async () => (await axe.run()).violations")
        return [
            f"{one['id']}: {one['nodes'][0]['html'][:160]}"
            for one in found
            if one["impact"] in {"serious", "critical"}
        ]

    return judge
