"""The replay viewer in a browser: quick, in step, and true to the record."""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench.analysis.study.comparison_folder import Compared
from lodbench.analysis.view.view_page import render_view
from lodbench.cli.main import run
from lodbench.sim.frame_log import FrameLog

pytestmark = pytest.mark.slow

Open = Callable[..., Any]
Judge = Callable[[Any], list[str]]

SIDES = "() => [...document.querySelectorAll('.pane')].map(p => +p.dataset.frame)"
FRAMES_PER_S = """async (count) => {
  const scrub = document.querySelector(".scrub"), next = () => new Promise(requestAnimationFrame);
  const from = performance.now();
  for (let i = 1; i <= count; i++) {
    scrub.value = scrub.max * i / count; scrub.dispatchEvent(new Event("input")); await next();
  }
  await next();
  return 1000 * count / (performance.now() - from);
}"""
SHOWN_S = "() => performance.getEntriesByName('first-picture')[0].startTime / 1000"
READY = "html[data-ready]"


@pytest.fixture(scope="module")
def viewer(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return the address of the exported viewer on the disk."""
    out = tmp_path_factory.mktemp("viewer") / "view.html"
    assert run(["view", str(folder), "--export", str(out)]) == 0
    return out.as_uri()


def time_of(page: Any) -> float:
    """Return the time that the link keeps."""
    return float(page.url.partition("#t=")[2].partition("&")[0])


def frame_at(log: FrameLog, time_s: float) -> int:
    """Return the frame that began last at a time of the path."""
    return int(np.searchsorted(log["input_ns"] * 1e-9, time_s + 1e-6) - 1)


def test_the_first_picture_comes_soon_and_scrubbing_is_smooth(open_page: Open, viewer: str) -> None:
    """Of 3,000 objects, up to 2,800 of them in view at once on both sides, and without a GPU.

    A machine with nothing else to do takes a second, and follows the scrubber 30 times a second;
    the bounds leave room for one whose processors have six times the work.
    """
    page = open_page(viewer, width=640, height=700)
    page.wait_for_selector(READY)
    assert page.evaluate(SHOWN_S) < 4.0
    page.evaluate(FRAMES_PER_S, 10)
    assert page.evaluate(FRAMES_PER_S, 60) > 5.0


def test_both_sides_show_one_time(open_page: Open, viewer: str, compared: Compared) -> None:
    """Each side shows its own frame that began last at the time of the scrubber, and its levels."""
    page = open_page(viewer, width=640)
    page.wait_for_selector(READY)
    page.locator(".pane select").nth(1).select_option(label="full")
    names = page.eval_on_selector_all(
        ".pane select", "els => els.map(e => e.selectedOptions[0].text)"
    )
    sides = page.eval_on_selector_all(".pane select", "els => els.map(e => e.selectedIndex)")
    logs = [compared.logs[name] for name in names]
    assert names == [compared.comparison.ok[0].label, "full"]
    for time_s in (0.4, 2.5, 1.7, 0.0, 2.9):
        page.evaluate("([t, a, b]) => { location.hash = `t=${t}&sides=${a}.${b}`; }",
                      [time_s, *sides])  # fmt: skip
        page.wait_for_function("t => document.querySelector('.at').textContent.startsWith(t)",
                               arg=f"{time_s:.2f}")  # fmt: skip
        got = page.evaluate(SIDES)
        assert got == [frame_at(log, time_s) for log in logs], time_s
        for says, log, frame in zip(
            page.locator(".says").all_inner_texts(), logs, got, strict=True
        ):
            assert f" {log['drawn'][frame]:.0f} drawn, " in says
            assert f" {log['toggles'][: frame + 1].sum():.0f} so far" in says


def test_stepping_goes_from_switch_to_switch(
    open_page: Open, viewer: str, compared: Compared
) -> None:
    """N is the next frame with a switch on either side, P the one before; space plays on."""
    page = open_page(viewer, width=640)
    page.wait_for_selector(READY)
    labels = [policy.label for policy in compared.comparison.ok[:2]]
    logs = [compared.logs[label] for label in labels]
    times = sorted(
        {t for log in logs for t in (log["input_ns"][log["toggles"] > 0] * 1e-9).tolist()}
    )
    for at in (0, 1, 2):
        page.keyboard.press("n")
        page.wait_for_function("t => Math.abs(document.querySelector('.scrub').value - t) < 0.02",
                               arg=times[at])  # fmt: skip
        assert time_of(page) == pytest.approx(times[at], abs=2e-6)
    page.locator(".says", has_text=re.compile(r" [1-9]\d* switch(es)? now")).first.wait_for()
    page.keyboard.press("p")
    assert time_of(page) == pytest.approx(times[1], abs=2e-6)
    page.keyboard.press(" ")
    page.wait_for_function("t => document.querySelector('.scrub').value > t", arg=times[1] + 0.1)
    page.locator("[data-do=play]").press("Enter")
    assert page.locator("[data-do=play]").inner_text() == "Play"


def test_the_picture_is_of_the_levels(open_page: Open, viewer: str) -> None:
    """What full detail draws is in the colour of the finest level, and of no other."""
    page = open_page(f"{viewer}#t=1.0&sides=2.2", width=640)
    page.wait_for_selector(READY)
    shown = page.evaluate("""() => {
      const eye = document.querySelector(".eye"), copy = new OffscreenCanvas(eye.width, eye.height);
      return new Promise(requestAnimationFrame).then(() => {
        dispatchEvent(new HashChangeEvent("hashchange"));
        document.querySelector(".scrub").value = 1.2;
        document.querySelector(".scrub").dispatchEvent(new Event("input"));
        return new Promise(requestAnimationFrame);
      }).then(() => {
        const draw = copy.getContext("2d");
        draw.drawImage(eye, 0, 0);
        const data = draw.getImageData(0, 0, eye.width, eye.height).data, found = [0, 0, 0];
        for (let i = 0; i < data.length; i += 4) {
          const [r, g, b] = data.slice(i, i + 3);
          found[r === 0x17 && g === 0x1b && b === 0x21 ? 0 : r > g && g > 2 * b ? 1 : 2]++;
        }
        return found;
      });
    }""")
    ground, yellow, other = shown
    assert ground > 1000
    assert yellow > 1000
    assert other < 0.05 * yellow, "edges alone"


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_viewer_fits_and_can_be_read(
    open_page: Open, viewer: str, serious: Judge, scheme: str
) -> None:
    """Nothing is off the screen at three widths, and axe-core finds nothing serious."""
    page = open_page(viewer, color_scheme=scheme, height=500)
    page.wait_for_selector(READY)
    for width in (400, 768, 1280):
        page.set_viewport_size({"width": width, "height": 500})
        assert page.evaluate("() => document.documentElement.scrollWidth") <= width
    assert serious(page) == []


HOSTILE = '</script><script>alert("\'")</script><img src=x onerror=alert(1)>' + "é" * 10_000


def test_names_stay_text(open_page: Open, compared: Compared, tmp_path: Path) -> None:
    """A policy, a scene and a type that are called a script are shown by that name, cut."""
    first = compared.comparison.ok[0]
    assert compared.scene is not None
    named = replace(
        compared,
        comparison=replace(
            compared.comparison, scene=HOSTILE, paths=(HOSTILE, "other"),
            policies=(replace(first, label=HOSTILE),),
        ),
        logs={HOSTILE: compared.logs[first.label]},
    )  # fmt: skip
    out = tmp_path / "hostile.html"
    out.write_text(render_view(named), encoding="utf-8")
    page = open_page(out.as_uri(), width=640)
    page.wait_for_selector(READY)
    assert page.locator("h1").inner_text().startswith("</script><script>alert(")
    assert page.locator(".pane option").first.inner_text().startswith("</script><script>")
    assert page.locator("img").count() == 0


@contextmanager
def serving(folder: Path) -> Generator[tuple[str, "subprocess.Popen[str]"]]:
    """Yield the address that the command prints, and its process."""
    command = [sys.executable, "-m", "lodbench", "view", str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=os.environ) as process:
        try:
            assert process.stdout is not None
            yield process.stdout.readline().removeprefix("view: ").strip(), process
        finally:
            process.kill()


def test_the_server_shows_the_viewer_until_it_is_interrupted(open_page: Open, folder: Path) -> None:
    """The address that is printed opens in a browser under the server's policy of content."""
    with serving(folder) as (url, process):
        page = open_page(url, width=640, offline=False)
        page.wait_for_selector(READY)
        assert page.evaluate(SHOWN_S) < 4.0
        page.context.close()
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=10) == 0
