"""Who keeps the budget and who is first, in worlds worked by hand."""

import numpy as np
import pytest

from lodbench.analysis.validation.measures.decisions import (
    count_decided,
    decide,
    first_of,
    leaders,
)
from lodbench.analysis.verdict.verdict import LEAST


@pytest.mark.parametrize(
    ("yes", "measured", "decided", "as_measured"),
    [
        (36, (True, True), "yes", True),
        (35, (True, True), "undecided", None),
        (4, (True, True), "no", False),
        (4, (False, False), "no", True),
        (40, (True, False), "yes", None),
        (40, (False,), "yes", False),
    ],
)
def test_nine_in_ten_decide(
    yes: int, measured: tuple[bool, ...], decided: str, as_measured: bool | None
) -> None:
    """Fewer leave it open, as two recordings do that differ."""
    found = decide(np.arange(40) < yes, np.array(measured))
    assert (found.decided, found.as_measured) == (decided, as_measured)
    assert found.probability == pytest.approx(yes / 40)


def tables(**given: list[float]) -> dict[str, np.ndarray]:
    """Return the metrics of the order of three policies in one run; others are equal."""
    return {name: np.array(given.get(name, [1.0, 1.0, 1.0]))[:, None] for name in LEAST}


def test_only_who_keeps_the_budget_can_be_first() -> None:
    """The finest misses it; of the two others, the second is finer by more than the margin."""
    keeps = np.array([[False], [True], [True]])
    judged = np.array([[30.0], [15.0], [10.0]])
    found = leaders(keeps, judged, tables(visible_error_px=[0.0, 1.0, 2.0]))
    assert found[:, 0].tolist() == [0.0, 1.0, 0.0]


def test_equals_share_the_first_place_and_less_work_leads() -> None:
    """Within .25 px and all else equal, both are first, and the one that works less leads."""
    keeps = np.ones((3, 1), dtype=bool)
    judged = np.array([[15.0], [10.0], [5.0]])
    work = [9.0, 8.5, 3.0]
    values = tables(visible_error_px=[1.0, 1.2, 2.0], work_ms_mean=work)
    found = leaders(keeps, judged, values)
    assert found[:, 0].tolist() == [1.0, 1.0, 0.0]
    assert first_of(found, judged) == [1]


def test_where_nobody_keeps_the_budget_the_least_miss_is_first() -> None:
    """Whatever the picture is like; who is within a tenth of it is as good."""
    keeps = np.zeros((3, 1), dtype=bool)
    judged = np.array([[21.0], [22.0], [40.0]])
    found = leaders(keeps, judged, tables(visible_error_px=[9.0, 5.0, 0.0]))
    assert found[:, 0].tolist() == [1.0, 1.0, 0.0]
    assert first_of(found, judged) == [0]


def test_a_metric_that_a_run_lacks_decides_nothing() -> None:
    """A policy without a value stays with the best in that metric."""
    keeps = np.ones((3, 1), dtype=bool)
    judged = np.full((3, 1), 5.0)
    found = leaders(keeps, judged, tables(visible_error_px=[np.nan, 1.0, 9.0]))
    assert found[:, 0].tolist() == [1.0, 1.0, 0.0]


def test_decisions_are_counted() -> None:
    """Open ones do not count, and an undecided one far off the budget is named."""
    yes = decide(np.ones(10, bool), np.array([True]))
    open_ = decide(np.ones(10, bool), np.array([True, False]))
    wrong = decide(np.zeros(10, bool), np.array([True]))
    unsure = decide(np.arange(10) < 5, np.array([True]))
    found = count_decided([(yes, 0.1), (open_, 0.1), (wrong, 0.1), (unsure, 0.3), (unsure, 0.2)])
    assert (found.asked, found.undecided, found.as_measured, found.far_undecided) == (4, 2, 1, 1)
