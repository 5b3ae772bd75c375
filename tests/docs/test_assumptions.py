"""What the first rank rests on: variants of a profile by hand, and the table that has them."""

import re
from pathlib import Path

import pytest
from assumptions import VARIANTS

from lodbench.base.predictors import CPU_PREDICTORS
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.machine.profile_catalog import load_hardware

PAGE = Path(__file__).parents[2] / "docs" / "hardware.md"


def prices(name: str) -> tuple[HardwareProfile, HardwareProfile]:
    """Return the bundled profile, and a variant of it."""
    plain = load_hardware("desktop-assumed")
    return plain, VARIANTS[name][1](plain)


def test_an_idling_clock_costs_a_light_frame_most() -> None:
    """At a full budget a frame takes what it took, at none half a budget, and lines in between."""
    plain, idling = prices("idling-clock")
    budget_ms = 1e3 / 60.0
    for work_ms, expected_ms in ((0.0, budget_ms / 2), (budget_ms, budget_ms), (10.0, 40.0 / 3)):
        triangles = (work_ms - plain.gpu.base_ms) / plain.gpu.unit_ms("triangles")
        found_ms = idling.gpu.base_ms + triangles * idling.gpu.unit_ms("triangles")
        assert found_ms == pytest.approx(expected_ms)


def test_other_variants_change_the_prices_that_they_name() -> None:
    """Seven samples of 1 ns a triangle; half of what objects cost; changes for nothing."""
    plain, quads = prices("quads-heavy")
    assert quads.gpu.unit_ms("rasterized_triangles") == pytest.approx(7e-6)
    _, hidden = prices("occlusion")
    for name in ("triangles", "draw_calls", "shaded_samples"):
        assert hidden.gpu.unit_ms(name) == 0.5 * plain.gpu.unit_ms(name)
    assert hidden.gpu.unit_ms("framebuffer_pixels") == plain.gpu.unit_ms("framebuffer_pixels")
    _, free = prices("free-changes")
    assert free.gpu.unit_ms("bytes_uploaded") == 0.0
    assert free.cpu.linear_ms[CPU_PREDICTORS.index("first_uses")] == 0.0


def test_the_table_has_a_row_for_each_variant() -> None:
    """In the order of the script, each by the words that the script has for it."""
    table = re.search(
        r"<!-- assumptions -->\n(.*?)<!-- /assumptions -->", PAGE.read_text("utf-8"), re.DOTALL
    )
    assert table is not None
    rows = [line.split("|")[1].strip() for line in table[1].splitlines()[2:] if line]
    assert rows == [words for words, _ in VARIANTS.values()]
