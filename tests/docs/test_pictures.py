"""What captions of `docs/reading-a-report.md` claim is true of the record of their pictures."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

DOCS = Path(__file__).parents[2] / "docs"
PAGE = " ".join((DOCS / "reading-a-report.md").read_text(encoding="utf-8").split())
PICTURES = re.findall(r"\]\(images/([\w-]+\.png)\)", PAGE)
RECORD: dict[str, Any] = json.loads((DOCS / "images" / "reading-a-report.json").read_bytes())
POLICIES = {policy["label"]: policy for policy in RECORD["policies"]}


def value_of(label: str, metric: str) -> float:
    """Return a policy's value of a metric."""
    return POLICIES[label]["metrics"][metric]["value"]


def test_the_answer_is_the_first_of_the_ranking() -> None:
    """The caption's policy is the first, surely keeps the budget, and full detail misses it."""
    keeps, full = (POLICIES[label]["keeps_budget"] for label in ("static-screen", "full"))
    assert RECORD["answer"][0].startswith("Take static-screen ")
    assert [label for label, policy in POLICIES.items() if policy["rank"] == 1] == ["static-screen"]
    assert keeps["probability"] >= 0.9 > full["probability"]
    budget_ms, ratio = RECORD["budget_ms"], full["work_ms"] / RECORD["budget_ms"]
    assert (
        f"✓ *Take static-screen: it keeps {budget_ms:g} ms on such paths with probability "
        f"{keeps['probability']:.2f}, where full detail takes {full['work_ms']:.0f} ms, "
        f"{ratio:.1f} times the budget.*"
    ) in PAGE


def test_as_fine_a_picture_costs_many_more_switches() -> None:
    """Errors of the two are within the margin of each other, and their pops are far apart."""
    errors = [value_of(label, "visible_error_px") for label in ("gobbetti", "static-screen")]
    pops = [value_of(label, "visible_pops_per_s") for label in ("gobbetti", "static-screen")]
    assert max(errors) <= (1.0 + RECORD["margin"]) * min(errors)
    assert pops[0] > 100.0 * pops[1] > 0.0
    assert (
        f"✓ *At this budget gobbetti draws as fine a picture as static-screen, {errors[0]:.2f} px "
        f"of visible error beside {errors[1]:.2f}, but switches so that it is seen {pops[0]:.0f} "
        f"times a second, where static-screen does {pops[1]:.1f} times.*"
    ) in PAGE


def test_the_first_rank_stands_over_the_speeds_and_rates_that_are_told() -> None:
    """The strip's ends are the record's; gobbetti is first too where the caption says, else not."""
    robust = RECORD["robustness"]
    assert robust["leader"] == "static-screen"
    low, high = robust["speed"]
    assert all("static-screen" in at["first"] for at in robust["budgets"])
    rates = [at["refresh_hz"] for at in robust["budgets"] if "gobbetti" in at["first"]]
    assert all(at["first"] == ["static-screen"] for at in robust["costs"])
    assert len(rates) == 2
    assert (
        f"✓ *static-screen stays first on machines of {low:g} to {high:g} times the speed; at "
        f"{rates[0]:g} Hz and at {rates[1]:g} Hz gobbetti shares the rank with it.*"
    ) in PAGE


@pytest.mark.parametrize("name", PICTURES)
def test_pictures_are_small_and_have_their_sentences(name: str) -> None:
    """Each is a PNG of some 100 kB at most, and the text behind it is one sentence to take."""
    content = (DOCS / "images" / name).read_bytes()
    assert content.startswith(b"\x89PNG")
    assert len(content) <= 110_000
    assert re.match(r" (✓ )?\*[^*]+\.\*", PAGE.split(f"images/{name})")[1])


def test_there_are_a_dozen_at_most_and_three_are_held() -> None:
    """Each picture stands once; three captions are marked, which are those held above."""
    assert len(set(PICTURES)) == len(PICTURES) <= 12
    assert PAGE.count("✓ *") == 3
