"""The page of a long comparison: twenty policies, ten paths, 20,000 frames of each on the first."""

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench.analysis.study.comparison_folder import Compared, write_results
from lodbench.analysis.study.comparison_parts import Curve, PolicyResult
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.level_history import MOST_CHANGES, LevelHistory

pytestmark = pytest.mark.slow

POLICIES, PATHS, FRAMES = 20, 10, 20_000
MOST_BYTES = 8_000_000


def lengthened(log: FrameLog, label: str) -> FrameLog:
    """Return a replay that goes the same way again and again, for 20,000 frames."""
    times = -(-FRAMES // len(log))
    span_ns = int(log.times_ns.max()) + 16_000_000
    laps = np.repeat(np.arange(times), len(log))[:, None] * span_ns
    tiled = np.tile(log.times_ns, (times, 1))
    times_ns = np.where(tiled < 0, tiled, tiled + laps)[:FRAMES]
    levels = log.levels
    assert levels is not None
    rounds = min(times, MOST_CHANGES // max(len(levels.node), 1))
    starts = [levels.start[:-1] + lap * len(levels.node) for lap in range(rounds)]
    start = np.concatenate([*starts, [rounds * len(levels.node)]])
    kept = min(rounds * len(levels), FRAMES)
    history = LevelHistory(
        start[: kept + 1],
        np.tile(levels.node, rounds)[: start[kept]],
        np.tile(levels.level, rounds)[: start[kept]],
        np.tile(levels.turn_xyzw, (rounds, 1))[:kept],
    )
    counts = np.tile(log.counts, (times, 1))[:FRAMES]
    return FrameLog(replace(log.header, policy=label), times_ns, counts, levels=history)


@pytest.fixture(scope="module")
def large(compared: Compared) -> Compared:
    """Return a comparison of that size, of policies that do what those of a small one did."""
    small = compared.comparison
    policies: list[PolicyResult] = []
    logs: dict[str, FrameLog] = {}
    for at in range(POLICIES):
        model = small.ok[at % len(small.ok)]
        label = f"{model.label},copy={at}"
        policies.append(replace(model, label=label, rank=at + 1, same_as=None))
        logs[label] = lengthened(compared.logs[model.label], label)
    labels = [policy.label for policy in policies]
    rising = tuple(np.linspace(1.0, 20.0, 12).tolist())
    end_s = min(float(log["input_ns"][-1]) * 1e-9 for log in logs.values())
    comparison = replace(
        small,
        policies=tuple(policies),
        paths=tuple(f"path-{at}" for at in range(PATHS)),
        window_s=((1.0, end_s),) * PATHS,
        curve=dict.fromkeys(labels, Curve(rising, rising, rising[::-1], rising, rising)),
        worst_moments=dict.fromkeys(labels, next(iter(small.worst_moments.values()))),
        p_best=dict.fromkeys(labels, 0.05),
    )
    pictures = dict(zip(labels, compared.pictures.values(), strict=False))
    return Compared(comparison, logs, compared.runs, compared.scene, pictures)


def test_a_long_comparison_has_a_page_that_opens(
    large: Compared, open_page: Callable[..., Any], tmp_path: Path
) -> None:
    """Below 8 MB, and all of it is there; with -rP it tells how long writing and opening took."""
    begun = time.perf_counter()
    write_results(tmp_path / "run", large)
    written_s = time.perf_counter() - begun
    report = tmp_path / "run" / "report.html"
    begun = time.perf_counter()
    page = open_page(report.as_uri())
    page.evaluate("() => new Promise(next => requestAnimationFrame(() => setTimeout(next)))")
    opened_s = time.perf_counter() - begun
    size = report.stat().st_size
    print(f"written in {written_s:.1f} s, opened in {opened_s:.1f} s, {size / 1e6:.2f} MB")
    assert size < MOST_BYTES
    assert all(len(log) == FRAMES for log in large.logs.values())
    assert page.locator(".legend .names button").count() == POLICIES
    assert page.locator("#chart-work path.line").count() == POLICIES
