"""The tables that hold popping against pictures: rates and ranks by hand, intervals that cover."""

import re

import numpy as np
import pytest
from numpy.typing import NDArray
from validation_figures import Table
from validation_flicker import flicker_by_policy, flicker_ranks, interval, steps_of


def build_table(
    popping_px: NDArray[np.float64], switch: NDArray[np.float64], moving: NDArray[np.float64]
) -> Table:
    """Return columns of pictures every 10 frames, every half a second; the first has no step."""
    count = len(popping_px)
    number = np.arange(count, dtype=np.float64)
    first = np.zeros(count, dtype=np.float64)
    first[0] = np.nan
    return {
        "frame": 10.0 * number,
        "trace_s": 0.5 * number,
        "popping_px": popping_px,
        "switch_flip": switch + first,
        "step_flip": moving + 0.25 + first,
        "held_step_flip": first + 0.25,
    }


def numbers(text: str) -> list[float]:
    """Return the numbers of a cell."""
    return [float(found) for found in re.findall(r"-?\d+\.?\d*", text)]


def test_rates_by_hand() -> None:
    """Three steps of 0, 1 and 2 px, each one of ten, within 1.5 s: 3 × 10 / 1.5 = 20 px/s."""
    popping = np.array((9.0, 0.0, 1.0, 2.0))  # the first frame has no step to hold against
    made = build_table(popping, 0.01 * popping, 0.003 * popping)
    assert steps_of(made).shape == (3, 3)
    _, row = flicker_by_policy({"one": made})
    assert row == ("one", "3", "67", "20", "0.2", "0.06")


def test_ranks_of_what_follows_and_of_what_does_not() -> None:
    """Pictures that rise with popping have ρ = 1 throughout; ones that know nothing of it, none."""
    rng = np.random.default_rng(5)
    tables: dict[str, Table] = {}
    for i in range(5):
        popping = 3.0**i * np.where(rng.random(200) < 0.4, rng.exponential(size=200), 0.0)
        tables[f"p{i}"] = build_table(popping, np.sqrt(popping), rng.normal(size=200))
    _, every, switched, order = flicker_ranks(tables, 50)
    for row in (every, switched, order):
        assert numbers(row[1]) == [1.0, 1.0, 1.0]
    for row in (every, switched):
        found, low, high = numbers(row[2])
        assert low < 0.0 < high
        assert abs(found) < 0.2


def test_order_is_of_rates_and_not_of_single_steps() -> None:
    """A policy with more, smaller switches can be seen more: the order goes by their sums."""
    few = np.tile((4.0, 0.0, 0.0, 0.0), 25)
    many = np.full(100, 2.0)
    tables = {"few": build_table(few, few, few), "many": build_table(many, many, -many)}
    *_, order = flicker_ranks(tables, 50)
    assert numbers(order[1])[0] == 1.0
    assert numbers(order[2])[0] == -1.0


def test_blocks_widen_intervals_where_steps_are_alike() -> None:
    """Of a mean of runs of ten equal steps blocks of ten tell the spread, single steps a third."""
    rng = np.random.default_rng(2)
    runs = np.repeat(rng.normal(size=60), 10)
    steps = [np.stack((runs, runs, runs))]

    def mean(resampled: list[NDArray[np.float64]]) -> float:
        return float(resampled[0][0].mean())

    spans: list[float] = []
    for block in (1, 10):
        low, high = interval(
            steps, [block], mean, np.random.default_rng(3), 1_000, policies_too=False
        )
        spans.append(high - low)
    single, whole = spans
    deviation = 1.0 / np.sqrt(60.0)  # of the mean of 60 independent runs
    assert whole == pytest.approx(2 * 1.645 * deviation, rel=0.35)
    assert single < 0.5 * whole
