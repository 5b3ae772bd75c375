"""The finest knob that keeps the budget, and where to look for it."""

import math

import numpy as np
import pytest

from lodbench.analysis.verdict.folds import folds
from lodbench.analysis.verdict.keeping import p_keeps
from lodbench.analysis.verdict.operating_point import Scale, next_knob, operating_point

PATHS = np.array([0.9, 1.0, 1.05, 1.1])  # how much longer a path takes than another


def test_finest_that_keeps_by_hand() -> None:
    """Of 4, 6, 8 and 10 ms, with paths up to a tenth longer, 6 is the last that keeps 8 surely."""
    point = operating_point(
        np.array([8.0, 4.0, 2.0, 1.0]), np.array([[4.0], [6.0], [8.0], [10.0]]) * PATHS, 8.0
    )
    assert (point.index, point.value, point.keeps, point.monotone) == (1, 4.0, True, True)
    assert point.probability == p_keeps(6.0 * PATHS, 8.0)
    assert point.probability > 0.9 > p_keeps(8.0 * PATHS, 8.0)


def test_least_miss_where_none_keeps() -> None:
    """A knob that never keeps is shown at its least miss, which need not be its coarsest."""
    p99_ms = np.array([[22.0], [20.0], [30.0]]) * PATHS
    point = operating_point(np.array([1.0, 2.0, 3.0]), p99_ms, 8.0)
    assert (point.index, point.keeps, point.monotone) == (1, False, False)


def test_a_finer_knob_beyond_a_bump_is_found_and_said() -> None:
    """Knobs behind one that misses are looked at too; dips within noise are no bump."""
    values = np.array([1.0, 2.0, 3.0, 4.0])
    bump = operating_point(values, np.array([[4.0], [12.0], [5.0], [14.0]]) * PATHS, 8.0)
    assert (bump.index, bump.keeps, bump.monotone) == (2, True, False)
    noise = operating_point(values, np.array([[4.0], [5.0], [4.95], [14.0]]) * PATHS, 8.0)
    assert (noise.index, noise.monotone) == (2, True)


def test_single_path() -> None:
    """From one path the finest knob that keeps it is taken, without a probability."""
    point = operating_point(np.array([1.0, 2.0]), np.array([[7.9], [8.1]]), 8.0)
    assert (point.index, point.keeps) == (0, True)
    assert math.isnan(point.probability)


def test_chosen_knob_keeps_fresh_paths_as_often_as_said() -> None:
    """Choosing does not eat the certainty: of fresh paths about nine in ten are kept, not fewer.

    2,000 studies of ten paths, work in geometric progression along a knob of 60 fine steps.
    """
    rng = np.random.default_rng(11)
    ln_work = np.linspace(-1.5, 1.0, 60)[:, None]
    kept: list[float] = []
    for _ in range(2000):
        point = operating_point(
            np.arange(60.0), np.exp(ln_work + 0.3 * rng.standard_normal(10)), 1.0
        )
        fresh = ln_work[point.index] + 0.3 * rng.standard_normal(10)
        kept.append(float((fresh <= 0).mean()))
    # Steps of 4 % lie up to a tenth of a standard deviation short of the crossing.
    error = float(np.std(kept)) / math.sqrt(2000)
    assert 0.9 - 3 * error < np.mean(kept) < 0.925


def replayed(values: np.ndarray) -> np.ndarray:
    """Return the p99 on ten paths of a knob that is a tolerance: finer is less."""
    path = np.exp(0.15 * np.random.default_rng(3).standard_normal(10))
    return 16.0 / np.sqrt(values)[:, None] * path


def search(scale: Scale, training: list[np.ndarray]) -> tuple[np.ndarray, int]:
    """Return the knobs replayed until all is known well enough, and how many replays it took."""
    values = np.geomspace(64.0, 0.25, 3)
    for replays in range(40):
        value = next_knob(values, replayed(values), 8.0, scale, training)
        if value is None:
            return values, replays
        values = np.insert(values, int((values > value).sum()), value)
    raise AssertionError("no end")


@pytest.mark.parametrize("scale", ["log", "linear"])
def test_search_ends_within_five_per_cent_of_the_crossing(scale: Scale) -> None:
    """The crossing is bracketed as narrowly as said, for each training set, with shared replays."""
    training = [fold.train for fold in folds(10)] + [np.arange(10)]
    values, replays = search(scale, training)
    assert replays <= 12  # halving takes 15, and six searches apart 30
    for paths in training:
        point = operating_point(values, replayed(values)[:, paths], 8.0)
        ends = values[point.index], values[point.index + 1]
        narrow = ends[0] / ends[1] <= 1.05 + 1e-12
        assert narrow if scale == "log" else ends[0] - ends[1] <= 0.05 * 63.75
        # Work goes with the root of the knob, so the crossing is known in closed form.
        ln_path = np.log(replayed(np.array([1.0]))[0, paths] / 8.0)
        crossing = brute_force_crossing(ln_path)
        assert ends[1] < crossing <= ends[0] * (1 + 1e-12)


def brute_force_crossing(ln_at_one: np.ndarray) -> float:
    """Return the least tolerance at which a path is kept with .9, by halving on the definition."""
    low, high = 0.25, 64.0
    for _ in range(60):
        middle = math.sqrt(low * high)
        keeps = p_keeps(np.exp(ln_at_one - 0.5 * math.log(middle)), 1.0) >= 0.9
        low, high = (low, middle) if keeps else (middle, high)
    return high


def test_first_step_by_hand() -> None:
    """One path at 4, 6 and 13.5 ms: ln p99 crosses 9 ms half-way, on either scale of the knob."""
    values, p99_ms = np.array([16.0, 4.0, 1.0]), np.array([[4.0], [6.0], [13.5]])
    first = [np.array([0])]
    step = 1 / 64  # half a step of the search
    on_log = next_knob(values, p99_ms, 9.0, "log", first)
    assert on_log == pytest.approx(4.0 ** (0.5 - step), rel=1e-9)
    assert next_knob(values, p99_ms, 9.0, "linear", first) == pytest.approx(2.5 - 3 * step)


def test_a_crossing_beside_an_end_is_closed_in_at_once() -> None:
    """Where the fine end all but keeps, the next knob leaves a bracket of just 5 % to it."""
    values, p99_ms = np.array([16.0, 4.0, 1.0]), np.array([[4.0], [6.0], [9.001]])
    value = next_knob(values, p99_ms, 9.0, "log", [np.array([0])])
    assert value is not None
    assert 1.04 < value <= 1.05


@pytest.mark.parametrize("budget_ms", [1.0, 100.0])
def test_nothing_to_search_where_all_keep_or_none(budget_ms: float) -> None:
    """Without a crossing there is nothing to replay."""
    values = np.array([16.0, 4.0, 1.0])
    p99_ms = np.array([[4.0], [6.0], [16.0]]) * PATHS
    assert next_knob(values, p99_ms, budget_ms, "log", [np.arange(4)]) is None
