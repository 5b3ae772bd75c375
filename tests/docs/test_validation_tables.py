"""The tables of the page of validation: what a record says is what the page says."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from validation_meshes import write_meshes
from validation_tables import (
    CALIBRATED,
    DOCS,
    LOG,
    PROFILE,
    decision,
    error_cells,
    inside,
    inside_text,
    lag,
    rank_text,
    verdicts,
)

from lodbench.analysis.fit.bundled_logs import bundled_fit
from lodbench.analysis.validation.study_file import read_cases
from lodbench.base.content_hash import content_hash
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.machine.profile_file import read_profile

Record = dict[str, Any]


def error(mean: float, sd: float) -> Record:
    """Return a summary of errors."""
    return {"mean_pct": mean, "sd_pct": sd}


def test_what_is_bundled_anew_is_what_the_package_has() -> None:
    """The profile and the log that ``--bundle`` writes are files that are there."""
    assert content_hash(load_hardware("llvmpipe")) == content_hash(read_profile(PROFILE))
    assert bundled_fit("llvmpipe").logs[0].samefile(LOG)


def test_corrected_errors_stand_beside_raw_ones() -> None:
    """The noise is that of the corrected ones, and what is not there is a dash."""
    raw: Record = {
        "model": error(5.0, 9.0),
        "repeat": error(1.0, 8.0),
        "noise_pct": 5.66,
        "excess": 1.59,
    }
    better = raw | {"model": error(1.0, 4.0), "repeat": error(0.5, 5.0), "noise_pct": 3.54}
    assert error_cells(raw, better) == ("+5.0 ± 9.0", "+1.0 ± 4.0", "+0.5 ± 5.0", "3.5 (× 1.59)")
    assert error_cells(raw, None)[:3] == ("+5.0 ± 9.0", "–", "+1.0 ± 8.0")
    alone = raw | {"repeat": None, "noise_pct": None, "excess": None}
    assert error_cells(alone, None)[2:] == ("–", "–")


def test_decisions_that_are_not_as_measured_are_marked() -> None:
    """A wrong one has a cross, an open one has not."""
    wrong = {"probability": 0.05, "decided": "no", "measured": True, "as_measured": False}
    open_ = {"probability": 0.5, "decided": "undecided", "measured": None, "as_measured": None}
    assert decision(wrong) == "no (5%), measured yes ✗"
    assert decision(open_) == "undecided (50%), measured open"
    policy = {"label": "full", "judged_ms": (5.123, 6.0), "keeps_budget": wrong, "first": open_}
    case = {"scene": "market", "trace": "drive-0", "policies": [policy]}
    row = list(verdicts({"cases": [case]}))[1]
    assert row[:3] == ("market, drive-0", "full", "5.12 and 6")


def test_shares_and_ranks_say_of_how_many() -> None:
    """Without a cell, or a pair, there is a dash."""
    assert inside_text({"inside": 9, "counted": 10}) == "9 of 10, 90%"
    assert inside_text({"inside": 0, "counted": 0}) == "–"
    rank = {"simulated": 0.9, "low": 0.5, "high": 1.0, "apart": 7, "pairs": 10}
    assert rank_text(rank) == "0.90 (0.50 to 1.00), 7 of 10 pairs"
    assert rank_text(rank | {"simulated": None}) == rank_text(None) == "–"
    found = {"pooled": {"inside": {"by_metric": {"lag_ms_mean": [3, 4]}}}}
    assert list(inside(found))[1] == ("`lag_ms_mean`", "3 of 4", "75%")


def test_lag_is_told_with_what_it_is_off_by() -> None:
    """Simulated over measured less one, in per cent."""
    metrics = {
        "lag_ms_mean": {"measured": 10.0, "simulated": 11.0, "low": 9.0, "high": 12.0},
        "frame_ms_mean": {"measured": 5.0, "simulated": 5.5, "low": 5.0, "high": 6.0},
    }
    case = {"frames_in_flight": 2, "policies": [{"label": "feedback", "metrics": metrics}]}
    row = list(lag({"cases": [case]}))[1]
    assert row == ("feedback", "2", "10", "11 (9 to 12)", "+10 %", "5", "5.5")


def test_the_study_that_the_page_shows_is_one(tmp_path: Path) -> None:
    """Its cases read as they stand, and so do those that the page is measured by."""
    page = (DOCS / "validation.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    study = tmp_path / "study.toml"
    study.write_text(block, encoding="utf-8")
    first, second = read_cases(study)
    assert (first.scene, first.budget_ms, first.seconds) == ("mine.lodscene", 8.0, "0:5")
    assert (second.frames_in_flight, second.threads, second.policies) == (2, 1, ("feedback",))
    measured = read_cases(DOCS / "scripts" / "validation.toml")
    scenes = [case.scene for case in measured]
    assert len(set(scenes)) >= 4
    assert all(scenes.count(scene) == 2 for scene in scenes)
    assert not {scene for scene, _ in CALIBRATED} & set(scenes)
    deep = read_cases(DOCS / "scripts" / "validation_lag.toml")
    assert {case.frames_in_flight for case in deep} == {1, 2, 3, 4}
    # What the CPU takes is one number of a case.
    assert all(case.policies is not None and len(case.policies) == 1 for case in deep)


@pytest.mark.slow
def test_the_meshes_are_dense_closed_and_the_same_each_time(tmp_path: Path) -> None:
    """Three of 30,720 triangles; each edge has two of them."""
    (tmp_path / "again").mkdir()
    for first, second in zip(write_meshes(tmp_path), write_meshes(tmp_path / "again"), strict=True):
        assert first.read_bytes() == second.read_bytes()
        mesh = trimesh.load_mesh(first, process=False)
        assert len(mesh.faces) == 30_720
        edges, count = np.unique(mesh.edges_sorted, axis=0, return_counts=True)
        assert len(edges) == 3 * 30_720 // 2
        assert (count == 2).all()
