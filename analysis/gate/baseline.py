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
from ...base.reader_guard import guarded
from .limits import LimitRules
from .measurements import Conditions, MeasuredPolicy

_SCHEMA = "lodbench.baseline/2"
_UPDATE = "write it again with `lodbench check --update-baseline`"


@dataclass(frozen=True, slots=True)
class Entry:
    """One path of a policy in a scene: its content, and values by metric, one a seed."""

    path: str
    hash: str
    metrics: dict[str, list[float | None]]


@dataclass(frozen=True, slots=True)
class Case:
    """A policy in a scene, by path."""

    policy: str
    scene: str
    paths: list[Entry]


@dataclass(frozen=True, slots=True)
class Baseline:
    """Metrics that had a relative limit when the baseline was written.

    Its seeds are those of a later check under the same conditions.
    """

    conditions: Conditions
    cases: list[Case] = field(default_factory=list[Case])
    schema: Literal["lodbench.baseline/2"] = _SCHEMA

    def find(self, measured: MeasuredPolicy, at: int, metric: str) -> FloatArray | str:
        """Return a metric on one of a policy's paths, (S,) by seed, or why there is none."""
        name, digest = measured.paths[at], measured.hashes[at]
        case = next(
            (c for c in self.cases if (c.policy, c.scene) == (measured.policy, measured.scene)),
            None,
        )
        if case is None:
            return f"the baseline has no {measured.policy} in {measured.scene}"
        entry = next((path for path in case.paths if path.path == name), None)
        if entry is None:
            return f"the baseline has no path {name}"
        if entry.hash != digest:
            return f"the baseline's path {name} is another"
        if metric not in entry.metrics:
            return f"the baseline has no {metric}"
        return np.array(entry.metrics[metric], dtype=np.float64)


def make_baseline(
    conditions: Conditions, measured: Iterable[MeasuredPolicy], limits: LimitRules
) -> Baseline:
    """Return the baseline that the relative limits need; policies without scores are left out."""
    cases: list[Case] = []
    for item in measured:
        entries: list[Entry] = []
        for name, digest, seeds in zip(item.paths, item.hashes, item.runs, strict=False):
            chosen = limits.of(item.policy, item.scene, name)
            wanted = sorted({limit.metric for limit in chosen if limit.relative})
            metrics = {metric: [run.values[metric] for run in seeds] for metric in wanted}
            if metrics:
                entries.append(Entry(name, digest, metrics))
        if entries:
            cases.append(Case(item.policy, item.scene, entries))
    return Baseline(conditions, sorted(cases, key=lambda case: (case.scene, case.policy)))


def write_baseline(path: Path, baseline: Baseline) -> None:
    """Write a baseline, all of it or nothing; the same baseline gives the same bytes."""
    text = msgspec.json.format(msgspec.json.encode(baseline, order="sorted"), indent=1) + b"\n"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, text)


def read_baseline(path: Path, conditions: Conditions) -> Baseline:
    """Read a baseline of a measurement under these conditions.

    Raises `InputError` if it cannot be read, is no baseline, or of other conditions.
    """
    with guarded(path, "a baseline", _UPDATE):
        baseline = read_json(path, Baseline, _SCHEMA, _UPDATE)
        _require_same(baseline, conditions, path)
    return baseline


def _require_same(baseline: Baseline, conditions: Conditions, path: Path) -> None:
    for item in fields(Conditions):
        now, then = getattr(conditions, item.name), getattr(baseline.conditions, item.name)
        if now != then:
            raise InputError(
                f"expected a baseline of {item.name} {now}, got {then}; {_UPDATE}, or check as "
                "it was measured",
                path=path,
            )
    entries = [entry for case in baseline.cases for entry in case.paths]
    for entry in entries:
        for metric, values in entry.metrics.items():
            if len(values) != conditions.seeds:
                raise InputError(
                    f"expected {conditions.seeds} values of {metric} on {entry.path}, a seed each, "
                    f"got {len(values)}; {_UPDATE}",
                    path=path,
                )
