"""Logs as JSON: records, lines of records, columns, and what is damaged."""

import json
from pathlib import Path

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.traces.logs.read_log import read_render_log
from lodbench.traces.logs.render_log import RenderLog

RECORDS = [{"gpu_ms": 4.0 + k, "draws": 10 + k, "note": "x"} for k in range(4)]


def log_of(tmp_path: Path, text: str) -> RenderLog:
    """Read a file of this text."""
    path = tmp_path / "log.json"
    path.write_text(text, encoding="utf-8")
    return read_render_log(path)


@pytest.mark.parametrize(
    "text",
    [
        json.dumps(RECORDS),
        json.dumps({"meta": {"gpu": "x"}, "frames": RECORDS}),
        json.dumps({name: [record[name] for record in RECORDS] for name in RECORDS[0]}),
        "\n".join(json.dumps(record) for record in RECORDS),
        "\n".join(f"{json.dumps(record)}," for record in RECORDS),
        json.dumps(RECORDS, indent=2),
        json.dumps(
            [{"gpu": {"ms": r["gpu_ms"]}, "stats": {"draws": str(r["draws"])}} for r in RECORDS]
        ),
    ],
)
def test_all_forms_hold_the_same_log(tmp_path: Path, text: str):
    """Arrays, lines, columns and records within records give one log."""
    log = log_of(tmp_path, text)
    assert log.format == "json"
    assert log.time("gpu_ms").tolist() == [4.0, 5.0, 6.0, 7.0]
    assert log.counts[:, 0].tolist() == [10.0, 11.0, 12.0, 13.0]


def test_gaps_and_words_are_missing_values(tmp_path: Path):
    """A record without the key, null and words are NaN; the words are counted."""
    log = log_of(tmp_path, '[{"gpu_ms": 1.5}, {}, {"gpu_ms": null}, {"gpu_ms": "slow"}]')
    assert np.isnan(log.time("gpu_ms")).tolist() == [False, True, True, True]
    assert "1 cell of gpu_ms is no number, such as 'slow': missing" in log.warnings


def test_a_line_that_is_cut_off_is_left_aside(tmp_path: Path):
    """Of a file of lines the last may be torn."""
    lines = [json.dumps(record) for record in RECORDS]
    log = log_of(tmp_path, "\n".join([*lines, '{"gpu_ms": 8.0, "dra']))
    assert len(log) == 4
    assert "1 lines are no records: left aside" in log.warnings


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('{"a": 1}', "expected records of frames, got other JSON"),
        ('[["gpu_ms", 1]]', "expected records of frames"),
        ('[{"gpu_ms": 1', "expected JSON, got"),
        ('[{"tris": 1}]', "expected a column with a time"),
        ('{"a":' * 2_000 + '"x"', "expected JSON, got"),
    ],
)
def test_other_json_is_refused(tmp_path: Path, text: str, says: str):
    """What has no frames says so in one line."""
    with pytest.raises(InputError, match=says):
        log_of(tmp_path, text)
