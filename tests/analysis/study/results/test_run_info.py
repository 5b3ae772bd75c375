"""What runs took, by policy and over all starts of a study."""

import json
from pathlib import Path
from typing import Any

from lodbench.analysis.study.engine.task import Outcome
from lodbench.analysis.study.results.run_info import RUN_INFO, Stopwatch


def written(folder: Path) -> dict[str, Any]:
    """Return what the file says."""
    return json.loads((folder / RUN_INFO).read_text(encoding="utf-8"))


def test_runs_are_summed_by_policy_over_all_starts(tmp_path: Path) -> None:
    """Times are added, the slowest run and the most memory are kept, policies by name."""
    first = Stopwatch(tmp_path, "study")
    first.add("full", Outcome(0, None, took_s=2.0, peak_bytes=300))
    first.add("feedback", Outcome(1, None, took_s=1.0, peak_bytes=100))
    first.write(tmp_path)
    before_s = written(tmp_path)["wall_s"]
    second = Stopwatch(tmp_path, "study")
    second.add("full", Outcome(2, None, took_s=0.5, peak_bytes=400))
    second.write(tmp_path)
    info = written(tmp_path)
    assert info.pop("wall_s") >= before_s >= 0.0
    assert info == {
        "schema": "lodbench.run-info/1",
        "study": "study",
        "starts": 2,
        "policies": {
            "feedback": {"runs": 1, "run_s": 1.0, "slowest_run_s": 1.0, "peak_bytes": 100},
            "full": {"runs": 2, "run_s": 2.5, "slowest_run_s": 2.0, "peak_bytes": 400},
        },
    }
    assert list(info["policies"]) == ["feedback", "full"]


def test_another_study_begins_at_nothing(tmp_path: Path) -> None:
    """Nor does a damaged file add anything."""
    watch = Stopwatch(tmp_path, "study")
    watch.add("full", Outcome(0, None, took_s=2.0))
    watch.write(tmp_path)
    Stopwatch(tmp_path, "other").write(tmp_path)
    assert written(tmp_path)["starts"] == 1
    assert written(tmp_path)["policies"] == {}
    (tmp_path / RUN_INFO).write_text("{", encoding="utf-8")
    Stopwatch(tmp_path, "other").write(tmp_path)
    assert written(tmp_path)["starts"] == 1
