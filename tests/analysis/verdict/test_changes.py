"""What changed from one comparison to another is told from noise, path by path."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from lodbench.analysis.study.comparison import Comparison
from lodbench.analysis.study.comparison_folder import Compared
from lodbench.analysis.study.comparison_parts import (
    Conditions,
    KnobSetting,
    PolicyResult,
    Provenance,
    Sampling,
    UnitCosts,
)
from lodbench.analysis.verdict.changes import WATCHED, find_changes
from lodbench.base.errors import InputError
from lodbench.sim.frame_log import FrameLog

PATHS = 10


def make_compared(
    log: FrameLog,
    values: Mapping[str, Any],
    *,
    label: str = "feedback",
    rank: int | None = 1,
    bias: float = 1.0,
    paths: str = "path",
    runs: bool = True,
) -> Compared:
    """Return a comparison of one policy with given values by path, or by path and seed."""
    policy = PolicyResult(
        label, label, {}, KnobSetting("bias", bias, tuned=True), "ok", None, oracle=False, rank=rank
    )
    comparison = Comparison(
        scene="scene",
        paths=("path",),
        hardware="machine",
        budget_ms=16.0,
        miss=0.01,
        seed=0,
        window_s=((1.0, 12.0),),
        population="such paths",
        visible=1.0,
        margin=0.1,
        conditions=Conditions("vsync", 60.0, 2, "none", 0, 100, 100, 60.0, 0.0, 0, 5, "made", True),
        sampling=Sampling(0.9, 2, 0, "no knob was tuned"),
        warnings=(),
        answer=("a", "b", "c"),
        policies=(policy,),
        p_best={},
        p_near_best={},
        regret={},
        chances={},
        least_miss=None,
        curve={},
        worst_moments={},
        robustness=None,
        unit_costs=UnitCosts({"triangles": 0.002, "framebuffer_pixels": 0.5}, {"draw_calls": 0.1}),
        provenance=Provenance("", "0", "", {}, ""),
    )
    given = {name: np.asarray(values.get(name, 1.0), np.float64) for name in WATCHED}
    known = {  # by path and seed
        name: np.broadcast_to(of if of.ndim != 1 else of[:, None], (PATHS, 2))
        for name, of in given.items()
    }
    rows = [
        {"policy": label, "trace_hash": f"{paths}-{at}", "judged": judged, "draw": draw}
        | {name: float(known[name][at, seed]) * factor for name in WATCHED}
        for at in range(PATHS)
        # Replays of the search, and of other machines, judge nobody: their values are far off.
        for seed, judged, draw, factor in (
            *((0, True, None, 1.0), (1, True, None, 1.0)),
            *((0, False, None, 9.0), (0, True, 3, 7.0)),
        )
    ]
    return Compared(comparison, {label: log}, pa.Table.from_pylist(rows) if runs else None)


@pytest.fixture
def log(make_log: Callable[..., FrameLog]) -> FrameLog:
    """Return a log of three frames of 1,000 triangles."""
    return make_log(triangles=np.full(3, 1000.0))


def test_the_same_twice_changed_nothing(log: FrameLog) -> None:
    """No metric, no term, no rank."""
    before = make_compared(log, {"work_ms_mean": np.arange(1.0, 11.0)})
    changes = find_changes(before, before)
    assert changes.paired
    assert not any(change.beyond_noise for change in changes.metrics)
    assert changes.policies[0].term == ""


def test_a_small_change_on_every_path_is_found(
    log: FrameLog, make_log: Callable[..., FrameLog]
) -> None:
    """Paths differ tenfold, the change is 3 % ± 1: path by path it is plain, its term is named."""
    rng = np.random.default_rng(1)
    work = np.linspace(2.0, 20.0, PATHS)
    later = work * (1.03 + 0.01 * rng.standard_normal(PATHS))
    before = make_compared(log, {"work_ms_mean": work})
    after = make_compared(
        make_log(triangles=np.full(3, 1100.0)),
        {"work_ms_mean": later},
        rank=2,
        bias=1.5,
    )
    changes = find_changes(before, after)
    (found,) = [change for change in changes.metrics if change.beyond_noise]
    assert found.metric == "work_ms_mean"
    assert found.before == pytest.approx(11.0)
    change = pytest.approx(later.mean() - work.mean())
    assert (found.low, found.high) == (change, change)  # its seeds are alike: there is no noise
    (policy,) = changes.policies
    assert (policy.term, policy.side) == ("triangles", "gpu")
    assert policy.term_ms == pytest.approx(100 * 0.002)
    assert (policy.rank_before, policy.rank_after) == (1, 2)
    assert (policy.knob_before, policy.knob_after) == ("bias=1", "bias=1.5")


def test_a_change_that_differs_from_path_to_path_is_a_change(log: FrameLog) -> None:
    """Work that doubles on one path and hardly changes on others exceeds the noise all the same.

    With noise of 1 % the change of the mean is known to 1 % / sqrt(10 paths * 2 seeds).
    """
    rng = np.random.default_rng(6)
    noise = 1.0 + 0.01 * rng.standard_normal((2, PATHS, 2))
    grown = np.where(np.arange(PATHS) == 3, 2.0, 1.01)[:, None]
    before = make_compared(log, {"work_ms_mean": 10.0 * noise[0]})
    after = make_compared(log, {"work_ms_mean": 10.0 * grown * noise[1]})
    (found,) = [change for change in find_changes(before, after).metrics if change.beyond_noise]
    assert found.metric == "work_ms_mean"
    assert 0.9 < found.low < found.high < 1.3  # (1.0 + 9 * 0.01) / 10 paths, of 10 ms


def test_noise_is_no_change(log: FrameLog) -> None:
    """Of 60 pairs that differ by chance alone, at most one in twenty is told, whatever metric."""
    rng = np.random.default_rng(4)
    told = 0
    for _ in range(60):
        one, other = (
            {name: rng.lognormal(0.0, 0.2, (PATHS, 2)) for name in WATCHED} for _ in range(2)
        )
        changes = find_changes(make_compared(log, one), make_compared(log, other))
        told += any(change.beyond_noise for change in changes.metrics)
    assert told <= 7  # 3 expected of 60; 8 or more have a chance of 1 %


def test_other_paths_are_two_samples(log: FrameLog) -> None:
    """What is not of the same paths is not paired, and a difference must exceed the paths' own."""
    work = np.linspace(2.0, 20.0, PATHS)
    before = make_compared(log, {"work_ms_mean": work})
    after = make_compared(log, {"work_ms_mean": 1.03 * work}, paths="other")
    changes = find_changes(before, after)
    assert not changes.paired
    assert not any(change.beyond_noise for change in changes.metrics)


def test_what_cannot_be_compared_is_refused(log: FrameLog) -> None:
    """Folders without a policy in common, and without their runs."""
    one = make_compared(log, {})
    with pytest.raises(InputError, match="none in common"):
        find_changes(one, make_compared(log, {}, label="full"))
    with pytest.raises(InputError, match=r"runs\.parquet"):
        find_changes(one, make_compared(log, {}, runs=False))
