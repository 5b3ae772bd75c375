"""What a folder that `compare --out` wrote holds: the runs by which policies were judged."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...base.errors import InputError
from ..study.comparison import Comparison, read_comparison
from ..study.comparison_folder import COMPARISON, RUNS
from ..study.comparison_parts import PolicyResult
from ..study.results.record import decode
from ..study.results.run_table import read_runs
from ..study.score import Scored
from .measurements import Conditions, MeasuredPolicy

if TYPE_CHECKING:
    import pyarrow as pa

_WHERE = ("policy", "trace", "trace_hash", "seed", "draw", "judged")


def measure_run(folder: Path) -> tuple[Conditions, list[MeasuredPolicy]]:
    """Return the judged runs of a comparison, on the machine of the profile's mean.

    Raises `InputError` if a file is missing or broken, or holds no such runs.
    """
    comparison = read_comparison(folder / COMPARISON)
    table = read_runs(folder / RUNS)
    try:
        runs = _judged(table)
    except (KeyError, TypeError, ValueError) as error:
        message = f"expected the runs of a comparison, got {error}; run `lodbench compare` again"
        raise InputError(message, path=folder / RUNS) from error
    measured = [_measured(policy, comparison, runs) for policy in comparison.policies]
    return _conditions(comparison), measured


Runs = dict[str, dict[tuple[str, str], dict[int, Scored]]]
"""By policy, by name and hash of the path, by seed."""


def _judged(table: "pa.Table") -> Runs:
    columns: dict[str, list[Any]] = {name: table.column(name).to_pylist() for name in _WHERE}
    runs: Runs = {}
    for at, (_, result) in enumerate(decode(table)):
        if not columns["judged"][at] or columns["draw"][at] is not None:
            continue
        if isinstance(result, Scored):
            path = columns["trace"][at], columns["trace_hash"][at]
            runs.setdefault(columns["policy"][at], {}).setdefault(path, {})[columns["seed"][at]] = (
                result
            )
    return runs


def _measured(policy: PolicyResult, comparison: Comparison, runs: Runs) -> MeasuredPolicy:
    order = list(comparison.paths)
    mine = sorted(runs.get(policy.label, {}).items(), key=lambda item: order.index(item[0][0]))
    names = tuple(name for (name, _), _ in mine)
    hashes = tuple(digest for (_, digest), _ in mine)
    if policy.status != "ok":
        failed = policy.status == "failed"
        reason = policy.reason if failed else f"not applicable: {policy.reason}"
        return MeasuredPolicy(policy.label, comparison.scene, (), (), (), reason, failed)
    scored = tuple(tuple(by_seed[seed] for seed in sorted(by_seed)) for _, by_seed in mine)
    return MeasuredPolicy(policy.label, comparison.scene, names, hashes, scored)


def _conditions(comparison: Comparison) -> Conditions:
    had = comparison.conditions
    return Conditions(
        hardware=comparison.hardware,
        display=had.display,
        refresh_hz=had.refresh_hz,
        frames_in_flight=had.frames_in_flight,
        pacing=had.pacing,
        latency_limit=had.latency_limit,
        budget_ms=comparison.budget_ms,
        seed=comparison.seed,
        seeds=comparison.sampling.seeds,
        warmup_s=comparison.window_s[0][0],
        visible_px=comparison.visible,
        fovy_deg=had.fovy_deg,
        crossfade_ms=had.crossfade_ms,
        measurement_delay=had.measurement_delay,
        eyes=had.eyes,
    )
