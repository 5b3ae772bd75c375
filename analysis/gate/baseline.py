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

_SCHEMA = "lodbench.baseline/1"
_UPDATE = "write it again with `lodbench check --update-baseline`"


@dataclass(frozen=True, slots=True)
class Entry:
    """A metric of a policy, scene and trace: its value, and R resampled values of it."""

    value: float
    resampled: list[float]


@dataclass(frozen=True, slots=True)
class _Case:
    policy: str
    scene: str
    trace: str
    metrics: dict[str, Entry]


@dataclass(frozen=True, slots=True)
class Baseline:
    """Metrics that had a relative limit when the baseline was written.

    Every resample is of the same seeds and of the same windows of the camera's path as in a later
    check under the same conditions.
    """

    conditions: Conditions
    cases: list[_Case] = field(default_factory=list[_Case])
    schema: Literal["lodbench.baseline/1"] = _SCHEMA

    def find(self, measured: MeasuredPolicy, metric: str) -> tuple[float, FloatArray] | None:
        """Return value and resamples of a metric, or None if the baseline does not have it."""
        for case in self.cases:
            if (case.policy, case.scene, case.trace) == measured.case and metric in case.metrics:
                entry = case.metrics[metric]
                return entry.value, np.array(entry.resampled)
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
            if score is not None and score.value is not None and metric in item.paired:
                # Only a resample in which nothing of the kind happened is NaN.
                resampled = np.nan_to_num(item.paired[metric], nan=score.value)
                entries[metric] = Entry(score.value, resampled.tolist())
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
        if len(entry.resampled) != conditions.resamples
    ]
    if short:
        raise InputError(
            f"expected {conditions.resamples} resamples of {short[0]}, got another number; "
            f"{_UPDATE}",
            path=path,
        )
    return baseline
