"""Every other page has the report's shell: readable at any width and in any light, by keyboard."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lodbench
from lodbench.analysis.captures.capture_info import capture_record
from lodbench.analysis.captures.capture_page import render_capture
from lodbench.analysis.report.pages.suite_page import render_suite
from lodbench.analysis.report.pages.sweep_page import render_sweep
from lodbench.analysis.reproduce.experiment import Chart, Experiment, Findings, Line
from lodbench.analysis.reproduce.reproduction import Entry, Reproduction, Section
from lodbench.analysis.reproduce.web_page import render_reproduction
from lodbench.analysis.study.comparison_folder import Compared
from lodbench.analysis.study.suite.definition import Cell
from lodbench.analysis.study.suite.run_suite import cell_result, lead
from lodbench.analysis.study.suite.suite_record import SuiteResult
from lodbench.analysis.study.sweep.query import Query
from lodbench.cli.main import run
from lodbench.traces.logs.render_log import RenderLog

pytestmark = pytest.mark.slow

Open = Callable[..., Any]
Judge = Callable[[Any], list[str]]
TAG = "<script>alert(1)</script>"
DRAWN = (
    "validate --scene market --trace drive --seconds 0:0.15 --size 96x54 --budget-ms 4 "
    "--warmup 0.02 --workers 1 --replicates 19 --repeats 1 --clock thread --policy full --out"
)


def suite_page(compared: Compared) -> str:
    """Return the page of a suite of one comparison, in which a policy failed with markup."""
    cell = cell_result(Cell("plaza", "trial", "desktop-assumed", 8.0), compared.comparison)
    failed = replace(
        cell.standings[0], label=TAG, status="failed", reason=TAG, rank=None, work_ms_p99=None
    )
    cell = replace(cell, standings=(*cell.standings, failed))
    cells = (cell, replace(cell, name="again"))
    result = SuiteResult("small", 1, "ab", "lodbench suite", "0", "cd", lead(cells, [TAG]), cells)
    return render_suite(result)


def sweep_page() -> str:
    """Return the page of a study of two policies, of which one has a name of markup."""
    study = lodbench.Study(
        {TAG: "full", "screen": "static-screen"},
        traces=["walk", "tour"],
        budget_ms=[4.0, 8.0],
        seeds=4,
        seconds=(0.0, 1.1),
    )
    return render_sweep(Query(study.run(workers=1)), ["work_ms_p99", "visible_error_px"])


def reproduction_page() -> str:
    """Return the page of an experiment with markup and a chart."""
    lines = (
        Line("in print", [1.0, 9.0], [2.0, 3.0], printed=True),
        Line(TAG, list(range(60)), [float(np.sin(x)) for x in range(60)]),
    )
    chart = Chart(name="sine", caption="It swings.", x="time, s", y="share", lines=lines)
    toy = Experiment(
        id="toy/sine",
        title=TAG,
        setting=TAG,
        trials=lambda _reduced: (),
        judge=lambda _numbers, _reduced: Findings(()),
    )
    entry = Entry(id=toy.id, claim=TAG, paper="1", ours="1", tolerance="", verdict="reproduced",
                  constants={})  # fmt: skip
    section = Section(toy, (entry,), (chart,), (TAG,))
    return render_reproduction(
        Reproduction(command="", version="0", code="ab", reduced=True, sections=(section,))
    )


def capture_page() -> str:
    """Return the page of a capture of 500 frames."""
    frame_ms = np.random.default_rng(5).gamma(9.0, 1.7, 500)
    log = RenderLog(TAG, "csv", (), np.empty((500, 0)), frame_ms)
    return render_capture(capture_record(log), {"frames": frame_ms})


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory, compared: Compared) -> dict[str, str]:
    """Return the addresses of pages on the disk."""
    made = {
        "suite": suite_page(compared),
        "sweep": sweep_page(),
        "reproduction": reproduction_page(),
        "capture": capture_page(),
    }
    folder = tmp_path_factory.mktemp("pages")
    for name, html in made.items():
        (folder / f"{name}.html").write_text(html, encoding="utf-8")
    return {name: (folder / f"{name}.html").as_uri() for name in made}


def require_readable(open_page: Open, serious: Judge, url: str) -> None:
    """At three widths only boxes that scroll are wider; axe-core finds nothing serious."""
    for scheme in ("light", "dark"):
        page = open_page(url, color_scheme=scheme)
        for width in (400, 768, 1280):
            page.set_viewport_size({"width": width, "height": 900})
            assert page.evaluate("() => document.documentElement.scrollWidth") <= width
        assert serious(page) == []


@pytest.mark.parametrize("name", ["suite", "sweep", "reproduction", "capture"])
def test_pages_can_be_read(
    open_page: Open, serious: Judge, pages: dict[str, str], name: str
) -> None:
    """Each fits the screen in light and dark, and what a user named runs nothing and is shown."""
    require_readable(open_page, serious, pages[name])
    shown = open_page(pages[name]).locator("body").inner_text()
    assert TAG in shown


@pytest.mark.usefixtures("egl")
def test_the_page_of_a_validation_can_be_read(
    open_page: Open, serious: Judge, tmp_path: Path
) -> None:
    """That of a recording by OpenGL, as `validate` writes it, is like the others."""
    assert run([*DRAWN.split(), str(tmp_path / "run")]) == 0
    require_readable(open_page, serious, (tmp_path / "run" / "report.html").as_uri())


def test_the_leaderboard_sorts_by_the_keyboard(open_page: Open, pages: dict[str, str]) -> None:
    """Enter on a comparison's number sorts by the rank there, and who failed comes last."""
    page = open_page(pages["suite"])
    page.locator("table[data-sort=leaderboard] button.sort").nth(4).press("Enter")
    cells = "els => els.map(e => e.cells[4].textContent.trim())"
    shown = page.eval_on_selector_all("table[data-sort=leaderboard] tbody tr", cells)
    ranked = [text for text in shown if text.isdigit()]
    assert ranked == sorted(ranked)
    assert shown[: len(ranked)] == ranked
    assert shown[-1] == "failed"
    assert "sort=leaderboard.4.up" in page.url


def test_the_legend_rules_small_multiples(open_page: Open, pages: dict[str, str]) -> None:
    """A policy that is off is in none of them; shares of variance, which are nobody's, stay."""
    page = open_page(pages["sweep"])
    button = page.locator(".legend .names button", has_text="screen")
    index = button.get_attribute("data-p")
    drawn = page.locator(f".plot [data-p='{index}']:visible")
    assert drawn.count() > 4
    button.press("Enter")
    assert drawn.count() == 0
    assert page.locator("#chart-shares-0 .mark:visible").count() > 2


def test_lines_say_their_own_names(open_page: Open, pages: dict[str, str]) -> None:
    """Under the pointer is what a line is called, where the legend has one entry for many."""
    page = open_page(pages["reproduction"])
    area = page.locator("#chart-toy-sine-sine .area")
    area.scroll_into_view_if_needed()
    box = area.bounding_box()
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.8 * box["height"])
    said = page.locator("#chart-toy-sine-sine .tip").inner_text()
    assert said.startswith(f"{TAG}: time, s ")
