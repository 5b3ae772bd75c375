"""The stored baseline: what relative limits are compared with, as one JSON file to commit."""

from collections.abc import Iterable
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Literal

import msgspec
import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.files.strict_json import read_json
from ...base.files.whole_file import write_whole
from .limits import LimitRules
from .measurements import Conditions, MeasuredPolicy

_SCHEMA = "lodbench.baseline/2"
_UPDATE = "write it again with `lodbench check --update-baseline`"


@dataclass(frozen=True, slots=True)
class Entry:
    """A metric of a policy, scene and trace: its mean, and its value under each seed."""

    value: float
    by_seed: list[float]


@dataclass(frozen=True, slots=True)
class _Case:
    policy: str
    scene: str
    trace: str
    metrics: dict[str, Entry]


@dataclass(frozen=True, slots=True)
class Baseline:
    """Metrics that had a relative limit when the baseline was written.

    Its seeds are those of a later check under the same conditions.
    """

    conditions: Conditions
    cases: list[_Case] = field(default_factory=list[_Case])
    schema: Literal["lodbench.baseline/2"] = _SCHEMA

    def find(self, measured: MeasuredPolicy, metric: str) -> tuple[float, FloatArray] | None:
        """Return a metric's mean and its values by seed, None if the baseline lacks it."""
        for case in self.cases:
            if (case.policy, case.scene, case.trace) == measured.case and metric in case.metrics:
                entry = case.metrics[metric]
                return entry.value, np.array(entry.by_seed)
        return None


def make_baseline(
    conditions: Conditions, measured: Iterable[MeasuredPolicy], limits: LimitRules
) -> Baseline:
    """Return the baseline that the relative limits need; policies without scores are left out."""
    cases: list[_Case] = []
    for item in measured:
        wanted = sorted({limit.metric for limit in limits.of(*item.case) if limit.relative})
        entries: dict[str, Entry] = {}
        for metric in wanted:
            score = item.scores.get(metric)
            values = [value for value in item.by_seed.get(metric, []) if value is not None]
            if score is not None and score.value is not None and len(values) == conditions.seeds:
                entries[metric] = Entry(score.value, values)
        if entries:
            cases.append(_Case(*item.case, entries))
    return Baseline(conditions, sorted(cases, key=lambda c: (c.scene, c.trace, c.policy)))


def write_baseline(path: Path, baseline: Baseline) -> None:
    """Write a baseline, all of it or nothing; the same baseline gives the same bytes."""
    text = msgspec.json.format(msgspec.json.encode(baseline, order="sorted"), indent=1) + b"\n"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, text)


def read_baseline(path: Path, conditions: Conditions) -> Baseline:
    """Read a baseline of a measurement under these conditions.

    Raises `InputError` if it is missing, not a baseline, or of other conditions.
    """
    baseline = read_json(path, Baseline, _SCHEMA, _UPDATE)
    for item in fields(Conditions):
        now, then = getattr(conditions, item.name), getattr(baseline.conditions, item.name)
        if now != then:
            raise InputError(
                f"expected a baseline of {item.name} {now}, got {then}; {_UPDATE}, or check as "
                "it was measured",
                path=path,
            )
    short = [
        metric
        for case in baseline.cases
        for metric, entry in case.metrics.items()
        if len(entry.by_seed) != conditions.seeds
    ]
    if short:
        raise InputError(
            f"expected {conditions.seeds} values of {short[0]}, a seed each, got another number; "
            f"{_UPDATE}",
            path=path,
        )
    return baseline
