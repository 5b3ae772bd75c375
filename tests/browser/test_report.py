"""The report in a browser: it answers the pointer and the keyboard, at any width, in any light."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from lodbench.analysis.study.comparison_folder import Compared

pytestmark = pytest.mark.slow

Open = Callable[..., Any]
Judge = Callable[[Any], list[str]]

BOXES = "els => els.map(e => e.closest('svg').getAttribute('viewBox'))"


@pytest.fixture
def url(folder: Path) -> str:
    """Return the address of the report on the disk."""
    return (folder / "report.html").as_uri()


def test_tables_sort_by_the_keyboard(open_page: Open, url: str) -> None:
    """Enter on a heading sorts by it, once more the other way; the link keeps it."""
    page = open_page(url)
    heading = page.locator("table[data-sort=worst] button.sort", has_text="work ms")
    values = "els => els.map(e => +e.cells[1].dataset.v)"
    rows = "table[data-sort=worst] tbody tr"
    heading.focus()
    page.keyboard.press("Enter")
    up = page.eval_on_selector_all(rows, values)
    page.keyboard.press("Enter")
    down = page.eval_on_selector_all(rows, values)
    assert up == sorted(up)
    assert down == up[::-1] != up
    assert "sort=worst.1.down" in page.url
    page.reload()
    assert page.eval_on_selector_all(rows, values) == down


def test_one_legend_rules_all_charts(open_page: Open, url: str) -> None:
    """What is off is in no chart, the link keeps it, and all come back."""
    page = open_page(url)
    button = page.locator(".legend .names button", has_text="full")
    index = button.get_attribute("data-p")
    drawn = f".plot [data-p='{index}']:visible"
    charts = page.locator(f".plot:has([data-p='{index}'])").count()
    assert charts >= 8
    assert page.locator(drawn).count() >= charts
    button.press("Enter")
    assert button.get_attribute("aria-pressed") == "false"
    assert page.locator(drawn).count() == 0
    assert f"off={index}" in page.url
    page.reload()
    assert page.locator(drawn).count() == 0
    page.locator("[data-show=all]").press("Enter")
    assert page.locator(drawn).count() >= charts
    assert "off=" not in page.url


def test_charts_along_the_path_are_zoomed_together(open_page: Open, url: str) -> None:
    """Plus on one, or dragging over it, zooms all of the path's charts, the raster too."""
    page = open_page(url)
    boxes = ".plot[data-link=time] svg path:first-child"
    page.locator("#chart-work .area").press("+")
    zoomed = page.eval_on_selector_all(boxes, BOXES)
    assert set(zoomed) == {"5000 0 10000 2000"}
    linked = page.eval_on_selector_all(".plot[data-link=time]", "els => els.map(e => e.id)")
    assert {"chart-work", "chart-lag", "chart-flicker", "chart-objects-0"} <= set(linked)
    assert "zoom=time.2500.7500" in page.url
    page.locator("#chart-lag .area").press("0")
    assert set(page.eval_on_selector_all(boxes, BOXES)) == {"0 0 20000 2000"}
    area = page.locator("#chart-pops .area")
    area.scroll_into_view_if_needed()
    box = area.bounding_box()
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.75 * box["width"], box["y"] + 20)
    page.mouse.up()
    left, _, width, _ = map(float, page.eval_on_selector_all(boxes, BOXES)[0].split())
    assert left == pytest.approx(10_000, abs=100)
    assert width == pytest.approx(5_000, abs=100)


def test_hovering_says_what_is_there(open_page: Open, url: str, compared: Compared) -> None:
    """A point says its policy and values, a stretch of the raster its object and level."""
    page = open_page(url)
    page.locator("#chart-tradeoff .mark").first.hover()
    tip = page.locator("#chart-tradeoff .tip")
    assert any(tip.inner_text().startswith(policy.label) for policy in compared.comparison.ok)
    assert "visible error, px" in tip.inner_text()
    stretch = page.locator("#chart-objects-0 path[data-t]").first
    stretch.scroll_into_view_if_needed()
    box = stretch.bounding_box()
    page.mouse.move(box["x"] + 1, box["y"] + box["height"] / 2)
    said = page.locator("#chart-objects-0 .tip").inner_text()
    assert said.startswith("rock ")
    assert "switch" in said
    assert "level" in said


def test_what_is_off_the_scale_says_so(open_page: Open, url: str, compared: Compared) -> None:
    """The policy far beyond the budget stands at the edge of the main chart, with its work."""
    (full,) = (policy for policy in compared.comparison.ok if policy.label == "full")
    assert full.keeps_budget is not None
    assert full.keeps_budget.work_ms > 24.0
    label = open_page(url).locator("#chart-tradeoff .label", has_text="full")
    assert label.inner_text() == f"full → {full.keeps_budget.work_ms:.1f}"


def test_the_raster_shows_the_policy_that_is_chosen(
    open_page: Open, url: str, compared: Compared
) -> None:
    """Arrows in the picker change the chart; its first row switches as often as it says."""
    page = open_page(url)
    picker = page.locator("select[data-choice=objects]")
    names = picker.locator("option").all_inner_texts()
    assert names[:2] == [policy.label for policy in compared.comparison.ok[:2]]
    at = names.index("lodmanager:target=0.6")
    picker.focus()
    for _ in range(at):
        page.keyboard.press("ArrowDown")
    assert page.locator(f"#chart-objects-{at}").is_visible()
    assert not page.locator("#chart-objects-0").is_visible()
    assert f"show=objects.{at}" in page.url
    page.reload()
    assert page.locator(f"#chart-objects-{at}").is_visible()
    levels, scene = compared.logs["lodmanager:target=0.6"].levels, compared.scene
    assert levels is not None
    assert scene is not None
    most = max(levels.node[levels.switches(scene)].tolist().count(n) for n in range(len(scene)))
    first = page.locator(f"#chart-objects-{at} .row .label").first.inner_text()
    assert first.endswith(f"· {most}")
    assert 1 < page.locator(f"#chart-objects-{at} .row").count() <= 40


def test_worst_moments_are_pictures_that_the_legend_rules(
    open_page: Open, url: str, compared: Compared
) -> None:
    """Each is drawn, says what it shows, fits any width, and goes and comes with its policy."""
    page = open_page(url)
    pictures = page.locator(".pictures img")
    assert pictures.count() == len(compared.pictures) >= 3
    for at in range(3):
        picture = pictures.nth(at)
        picture.scroll_into_view_if_needed()
        assert picture.evaluate("e => e.complete && e.naturalWidth") == 640
        assert picture.get_attribute("alt").startswith("What the camera saw at ")
    across = {1280: 2, 768: 2, 400: 1}
    for width, most in across.items():
        page.set_viewport_size({"width": width, "height": 900})
        boxes = [pictures.nth(at).bounding_box() for at in range(3)]
        assert max(box["x"] + box["width"] for box in boxes) <= width
        assert sum(box["y"] == boxes[0]["y"] for box in boxes) == most
    button = page.locator(".legend .names button", has_text="full")
    mine = page.locator(f".pictures figure[data-p='{button.get_attribute('data-p')}']")
    assert mine.is_visible()
    button.press("Enter")
    assert not mine.is_visible()
    button.press("Enter")
    assert mine.is_visible()


def test_what_was_predicted_stands_beside_what_was_charged(open_page: Open, url: str) -> None:
    """Two charts and a table that sorts by the keyboard; that nobody measured is said."""
    page = open_page(url)
    section = page.locator("section", has=page.locator("h2", has_text="Predicted, simulated"))
    assert section.locator(".plot").count() == 2
    diagonal = section.locator("#chart-simulated path.rule").first.get_attribute("d")
    assert diagonal == "M0 2000l20000 -2000"
    assert "Measured: nothing in this record" in section.inner_text()
    heading = section.locator("button.sort", has_text="simulated ms")
    heading.press("Enter")
    assert heading.locator("xpath=..").get_attribute("aria-sort") == "ascending"


def test_every_section_is_said_in_a_sentence(open_page: Open, url: str) -> None:
    """Below each heading of results stands what to take from it, but where captions say it.

    No knob is tuned here, without which nothing is known of other machines.
    """
    heads = open_page(url).eval_on_selector_all(
        "section > h2", "els => els.filter(e => !e.parentNode.querySelector("
        "'.takeaway, .caption')).map(e => e.textContent)",
    )  # fmt: skip
    assert heads == ["How far the first rank stands", "Where the numbers come from"]


def test_every_control_is_reached_by_the_keyboard(open_page: Open, url: str) -> None:
    """Tab goes through every button, picker, table and chart that takes a key, in order."""
    page = open_page(url)
    wanted = page.evaluate("""() => {
      const all = [...document.querySelectorAll("button, select, summary, [tabindex='0']")]
        .filter(e => e.checkVisibility());
      all.forEach((e, i) => { e.dataset.order = i; });
      return all.length;
    }""")
    reached: list[int] = []
    for _ in range(wanted):
        page.keyboard.press("Tab")
        reached.append(page.evaluate("() => +(document.activeElement.dataset.order ?? -1)"))
    assert wanted > 60
    assert reached == list(range(wanted))


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_is_off_the_screen_or_hard_to_read(
    open_page: Open, url: str, serious: Judge, scheme: str
) -> None:
    """At three widths only boxes that scroll are wider; axe-core finds nothing serious."""
    page = open_page(url, color_scheme=scheme)
    for width in (400, 768, 1280):
        page.set_viewport_size({"width": width, "height": 900})
        assert page.evaluate("() => document.documentElement.scrollWidth") <= width
        last = page.locator("table.ranking thead th").last
        last.scroll_into_view_if_needed()
        box = last.bounding_box()
        assert box["x"] + box["width"] <= width, "the last column can be scrolled to"
    assert serious(page) == []


def test_print_has_all_that_is_folded(open_page: Open, url: str) -> None:
    """On paper nothing is cut, what a button would open is open, and buttons are gone."""
    page = open_page(url, width=720)
    page.emulate_media(media="print")
    page.evaluate("() => dispatchEvent(new Event('beforeprint'))")
    assert page.evaluate("() => document.documentElement.scrollWidth") <= 720
    assert page.locator("details:not([open])").count() == 0
    assert page.locator(".zoom button:visible, [data-copy]:visible").count() == 0
    assert page.pdf(format="A4").startswith(b"%PDF")
