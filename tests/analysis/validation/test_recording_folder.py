"""Recordings in a folder: what is written comes back, and what is missing is named."""

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from lodbench.analysis.fit.drift import without_drift
from lodbench.analysis.validation import replays
from lodbench.analysis.validation.recorded_frames import Measured, measured_of
from lodbench.analysis.validation.recording_folder import (
    case_folders,
    find_recordings,
    forget_recordings,
    read_recordings,
    write_recording,
)
from lodbench.analysis.validation.recordings import Recorded
from lodbench.base.errors import InputError, PolicyError
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.traces.logs.render_log import RenderLog

LABELS = ["full", "feedback"]


@pytest.fixture
def item(
    recorded: Callable[..., dict[str, tuple[Measured, ...]]],
    make_machine: Callable[..., HardwareProfile],
) -> Recorded:
    """Return a recording with a reference drawing and lag."""
    measured = recorded(make_machine(), ("full",), (None,))["full"][0]
    n = len(measured.frames)
    columns = {name: np.asarray(measured.counts[name]) for name in ("triangles", "draw_calls")}
    columns["projected_px"] = np.full(n, 9.0)
    columns["reference_before_ms"] = np.linspace(1.0, 2.0, n)
    columns["reference_after_ms"] = np.linspace(2.0, 3.0, n)
    columns["lag_ms"] = np.linspace(5.0, 6.0, n)
    return Recorded({"scene": "by-hand", "policy": "full"}, columns, measured.frames)


def test_recordings_come_back_as_they_were(item: Recorded, tmp_path: Path) -> None:
    """Both passes, with every column; a policy that is not there fails by name."""
    write_recording(tmp_path / "case", LABELS, "full", 0, item)
    later = replace(item, columns=item.columns | {"lag_ms": 2.0 * item.columns["lag_ms"]})
    write_recording(tmp_path / "case", LABELS, "full", 1, later)
    found = read_recordings(find_recordings(tmp_path) / "case", LABELS, {"scene": "by-hand"})
    assert found.failed == {"feedback": "it was not recorded"}
    for expected, got in zip((item, later), found.policies["full"], strict=True):
        assert got.header == expected.header
        assert got.columns.keys() == expected.columns.keys()
        for name, values in expected.columns.items():
            assert np.array_equal(got.columns[name], values)
        assert np.array_equal(got.frames.times_ns, expected.frames.times_ns)
    measured = measured_of(found.policies["full"][1])
    assert measured.reference_ms is not None
    ran = np.linspace(1.5, 2.5, len(measured.reference_ms))  # of before and after
    assert measured.reference_ms[4:-4] == pytest.approx(ran[4:-4])  # nine about each: a line stays
    assert measured.lag_ms is not None
    assert measured.lag_ms[-1] == pytest.approx(12.0)
    assert measured.counts["shaded_samples"][0] == 9.0


def test_a_validation_divides_by_what_a_fit_divides_by(item: Recorded) -> None:
    """References with 20 % of noise and one that is missing: to the fit's own slowness."""
    rng = np.random.default_rng(0)
    noisy = 1.0 + 0.2 * rng.standard_normal(len(item.frames))
    noisy[7] = np.nan
    only = {"reference_before_ms": noisy, "reference_after_ms": noisy}
    measured = measured_of(replace(item, columns=item.columns | only))
    assert measured.reference_ms is not None
    ones = np.ones(len(noisy))
    log = RenderLog("run", "csv", ("triangles",), ones[:, None], frame_ms=ones, recorded=only)
    fitted = 1.0 / without_drift(log, "frame_ms")[0].time("frame_ms")
    assert measured.reference_ms / np.median(measured.reference_ms) == pytest.approx(fitted)
    assert measured.reference_ms.std() < 0.5 * 0.2


def test_a_recording_of_something_else_is_refused(item: Recorded, tmp_path: Path) -> None:
    """The entry that differs is named; and so is a folder without recordings."""
    write_recording(tmp_path / "case", LABELS, "full", 0, item)
    with pytest.raises(InputError, match="expected a recording with scene plaza, got by-hand"):
        read_recordings(tmp_path / "case", LABELS, {"scene": "plaza"})
    with pytest.raises(InputError, match="expected recordings of other, got those of case"):
        read_recordings(tmp_path / "other", LABELS, {})
    with pytest.raises(InputError, match="expected a recording of lodmanager, got none"):
        read_recordings(tmp_path / "case", ["lodmanager"], {})
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="expected recordings that `lodbench validate --out`"):
        find_recordings(tmp_path / "empty")


def test_folders_of_cases_are_distinct() -> None:
    """Two cases of one name have two folders, and none that of a case that is called so."""
    assert case_folders(["a b", "c", "a b"]) == ["a_b", "c", "a_b-3"]
    assert case_folders(["a", "a", "a-2"]) == ["a", "a-3", "a-2"]
    assert len({name.lower() for name in case_folders(["a-2", "a", "A", "a", "a-4", "a-2"])}) == 6


def test_a_policy_that_fails_when_it_is_recorded_again_has_no_recording(
    item: Recorded, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was written of it is gone, and the other policy's two stay."""
    recorded = list[str]()

    class Failing:
        """A recorder on which feedback fails the second time."""

        def record(self, label: str, *_: object, **__: object) -> Recorded:
            """Record, or fail."""
            recorded.append(label)
            if recorded.count("feedback") == 2:
                raise PolicyError("feedback", 3, "it fails")
            return item

    def opened(*_: object) -> Any:
        return nullcontext(Failing())

    monkeypatch.setattr(replays, "open_recorder", opened)
    folder, screen = tmp_path / "case", SimpleNamespace(width_px=1, height_px=1)
    nothing: Any = None
    hardware: Any = SimpleNamespace(display=screen)
    found = replays.record_all(
        *(LABELS, nothing, nothing, hardware, nothing, nothing, 2),
        on_recorded=partial(write_recording, folder, LABELS),
        on_failed=partial(forget_recordings, folder, LABELS),
    )
    assert recorded == ["full", "feedback"] * 2
    assert found.failed == {"feedback": "policy feedback, frame 3: it fails"}
    assert (list(found.policies), len(found.policies["full"])) == (["full"], 2)
    assert len(list(folder.rglob("*full*.parquet"))) == 4
    assert not list(folder.rglob("*feedback*"))
