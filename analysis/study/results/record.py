"""The one record of results: a row of a table for each run, and back again to the bit.

Columns are the run's own (`COLUMNS`), then the axes of its study, then each metric by its id, and
the answers to load steps.  No column has a time of day, or the time that anything took.
"""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from numbers import Integral, Real
from operator import attrgetter
from typing import TYPE_CHECKING, Any, TypeAlias, cast

import msgspec
import pyarrow as pa

from ...metrics.footing import Footing
from ...metrics.metric_registry import METRICS
from ...metrics.steps import Step
from ...metrics.worst_moment import Moment
from ..engine.task import Failure
from ..score import Scored

if TYPE_CHECKING:
    from .run_list import RunList

SCHEMA = "lodbench.study/2"

AxisValue: TypeAlias = str | float | int | bool | None

COLUMNS: dict[str, pa.DataType] = {
    "digest": pa.string(),  # content hash of the run, which tells it from every other
    "policy": pa.string(),  # its label
    "policy_name": pa.string(),
    "params": pa.string(),  # those that differ from their defaults, as JSON
    "scene": pa.string(),
    "scene_hash": pa.string(),
    "trace": pa.string(),
    "trace_hash": pa.string(),
    "hardware": pa.string(),
    "hardware_hash": pa.string(),
    "budget_ms": pa.float64(),
    "seed": pa.int64(),  # null where it has more than 63 bits; the options have it too
    "draw": pa.int64(),  # null for the profile's mean
    "options": pa.string(),  # all of the replay's and the scoring's, as JSON
    "status": pa.string(),  # ok, failed or not-applicable
    "reason": pa.string(),  # null where it is ok
    "frame": pa.int64(),  # in which it failed; null before the first, and where it is ok
    "frames": pa.int64(),  # replayed, warm-up included; null unless it is ok
    "log_hash": pa.string(),  # of the file of its frame log; null where none is kept
    "judged_ms": pa.float64(),  # work time by which the budget is judged; null unless it is ok
}
"""What every row has, by name."""

_STEPS = "steps"
_STEP = pa.struct(
    [
        ("frame", pa.int64()),
        ("time_ms", pa.float64()),
        ("load_before_ms", pa.float64()),
        ("load_after_ms", pa.float64()),
        ("settle_ms", pa.float64()),
        ("settled", pa.bool_()),
        ("overshoot_ratio", pa.float64()),
    ]
)
_WORST = "worst"
_MOMENT = pa.struct(
    [
        ("path", pa.string()),
        ("time_s", pa.float64()),
        ("camera_m", pa.list_(pa.float64(), 3)),
        ("work_ms", pa.float64()),
        ("usual_ms", pa.float64()),
        ("term", pa.string()),
        ("grown_ms", pa.float64()),
    ]
)
_FOOTING = "footing"
_GROUND = pa.struct([("full_gpu_ms", pa.float64()), ("empty_fraction", pa.float64())])
_ADDED = "added_ms"
_IDS = tuple(metric.id for metric in METRICS)


_OF_SCORED = ("digest", "status", "reason", "frame", "frames", "judged_ms")
_DECODED = (*_OF_SCORED, _STEPS, _WORST, _FOOTING, _ADDED)


@dataclass(frozen=True, slots=True, eq=False)
class Entry:
    """What became of one run.

    Attributes
    ----------
    at : int
        The run's position in its study.
    result : Scored or Failure
        A frame log that the scores have is kept elsewhere, see `log_hash`.
    log_hash : str or None
        Of the file of the frame log.
    """

    at: int
    result: Scored | Failure
    log_hash: str | None = None


def schema_of(axes: Mapping[str, Sequence[AxisValue]]) -> pa.Schema:
    """Return the columns of a study's results; raises ValueError if an axis has another's name."""
    fields = [pa.field(name, kind) for name, kind in COLUMNS.items()]
    fields += [pa.field(name, _kind_of(values)) for name, values in axes.items()]
    fields += [pa.field(name, pa.float64()) for name in _IDS]
    fields.append(pa.field(_STEPS, pa.list_(_STEP)))
    fields += [pa.field(_WORST, _MOMENT), pa.field(_FOOTING, _GROUND)]
    fields.append(pa.field(_ADDED, pa.map_(pa.string(), pa.float64())))
    names = [item.name for item in fields]
    taken = next((name for name in axes if names.count(name) > 1), None)
    if taken is not None:
        raise ValueError(f"axis {taken}: results have a column of that name")
    return pa.schema(fields, metadata={"schema": SCHEMA})


def encode(runs: "RunList", entries: Sequence[Entry]) -> pa.Table:
    """Return a row for each entry, in the order given."""
    schema = schema_of(runs.axes)
    columns = _about(runs, entries)
    for name, values in runs.axes.items():
        kind = _kind_of(values)
        columns[name] = [_as_kind(values[entry.at], kind) for entry in entries]
    scored = [entry.result if isinstance(entry.result, Scored) else None for entry in entries]
    for name in _IDS:
        columns[name] = [None if one is None else one.values.get(name) for one in scored]
    columns[_STEPS] = [
        None if one is None else [asdict(step) for step in one.steps] for one in scored
    ]
    columns["judged_ms"] = [None if one is None else one.judged_ms for one in scored]
    columns[_WORST] = [None if one is None else asdict(one.worst) for one in scored]
    columns[_FOOTING] = [None if one is None else asdict(one.footing) for one in scored]
    columns[_ADDED] = [None if one is None else list(one.added_ms.items()) for one in scored]
    return pa.Table.from_pydict(columns, schema=schema)


def decode(table: pa.Table) -> Iterator[tuple[str, Scored | Failure]]:
    """Yield of each row the digest of its run and what became of it, bit for bit.

    Scores come without their frame log.
    """
    columns: dict[str, list[Any]] = {
        name: table.column(name).to_pylist() for name in (*_DECODED, *_IDS)
    }
    for row, digest in enumerate(columns["digest"]):
        status = columns["status"][row]
        if status != "ok":
            yield digest, Failure(status, columns["reason"][row], columns["frame"][row])
            continue
        yield (
            digest,
            Scored(
                log=None,
                values={name: columns[name][row] for name in _IDS},
                steps=tuple(Step(**step) for step in columns[_STEPS][row]),
                frames=columns["frames"][row],
                judged_ms=columns["judged_ms"][row],
                worst=Moment(**columns[_WORST][row] | _camera(columns[_WORST][row])),
                footing=Footing(**columns[_FOOTING][row]),
                added_ms=dict(columns[_ADDED][row]),
            ),
        )


def _camera(moment: Mapping[str, Any]) -> dict[str, Any]:
    return {"camera_m": tuple(moment["camera_m"])}


def _about(runs: "RunList", entries: Sequence[Entry]) -> dict[str, list[Any]]:
    """Return the values of `COLUMNS`."""
    which = [runs.runs[entry.at] for entry in entries]
    results = [entry.result for entry in entries]
    failures = [result if isinstance(result, Failure) else None for result in results]
    columns: dict[str, list[Any]] = {
        name: list(map(attrgetter(path), which)) for name, path in _OF_RUN.items()
    }
    for name in ("scene", "trace", "hardware"):
        columns[name] = [runs.names[digest] for digest in columns[f"{name}_hash"]]
    columns["digest"] = [runs.digests[entry.at] for entry in entries]
    for name in ("policy", "policy_name"):
        columns[name] = [_text(value) for value in columns[name]]
    columns["params"] = [_json(run.policy.params) for run in which]
    columns["options"] = [_options(run) for run in which]
    columns["seed"] = [seed if seed < 1 << 63 else None for seed in columns["seed"]]
    columns["status"] = ["ok" if one is None else one.kind for one in failures]
    columns["reason"] = [None if one is None else _text(one.reason) for one in failures]
    columns["frame"] = [None if one is None else one.frame for one in failures]
    columns["frames"] = [
        result.frames if isinstance(result, Scored) else None for result in results
    ]
    columns["log_hash"] = [entry.log_hash for entry in entries]
    return columns


_OF_RUN = {
    "policy": "policy.label",
    "policy_name": "policy.name",
    "scene_hash": "scene",
    "trace_hash": "trace",
    "hardware_hash": "hardware",
    "budget_ms": "options.budget_ms",
    "seed": "options.seed",
    "draw": "options.draw",
}
"""Columns that are attributes of the run."""


def _options(run: Any) -> str:
    return _json(asdict(run.options) | {"warmup_s": run.warmup_s, "miss": run.miss})


def _json(value: object) -> str:
    """Return JSON of plain values; of others what they show themselves as."""
    # Not msgspec's, which refuses whole numbers of more than 64 bits, as a seed may be.
    plain = _finite(msgspec.to_builtins(value, enc_hook=repr))
    return json.dumps(plain, separators=(",", ":"), allow_nan=False)


def _finite(value: Any) -> Any:
    """Return plain values with texts for the numbers that JSON does not have."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in cast("dict[str, Any]", value).items()}
    if isinstance(value, list):
        return [_finite(item) for item in cast("list[Any]", value)]
    return repr(value) if isinstance(value, float) and not math.isfinite(value) else value


def _text(value: str) -> str:
    """Return a text without what UTF-8 has no bytes for, such as a lone half of a pair."""
    return value.encode("utf-8", "backslashreplace").decode()


def _kind_of(values: Sequence[AxisValue]) -> pa.DataType:
    """Return the type of an axis; values of several kinds are texts."""
    known: list[Any] = [value for value in values if value is not None]
    if known and all(isinstance(value, bool) for value in known):
        return pa.bool_()
    if not known or any(isinstance(value, bool) or not isinstance(value, Real) for value in known):
        return pa.string()
    if all(isinstance(value, Integral) and abs(int(value)) < 1 << 63 for value in known):
        return pa.int64()
    return pa.float64()


def _as_kind(value: AxisValue, kind: pa.DataType) -> AxisValue:
    if value is None:
        return None
    if kind == pa.float64():
        return float(value)
    return str(value) if kind == pa.string() else value
