"""What is mended, counted, or refused when samples become a trace."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.samples import trace_from_samples

PATH = Path("some.csv")
IDENTITY = [0.0, 0.0, 0.0, 1.0]


def build(times: list[float], quaternions: Any = None, **more: Any) -> CameraTrace:
    """Trace of samples that stand on file lines 10, 20, 30, …, at x = 0, 1, 2, …."""
    count = len(times)
    positions = more.pop("position_m", [[float(i), 0.0, 0.0] for i in range(count)])
    return trace_from_samples(
        "t",
        PATH,
        [10 * (i + 1) for i in range(count)],
        time_s=times,
        position_m=positions,
        orientation_xyzw=[IDENTITY] * count if quaternions is None else quaternions,
        **more,
    )


def test_time_starts_at_zero_and_the_origin_is_kept() -> None:
    """The first time of the source moves to ``origin_s``."""
    trace = build([100.5, 101.0, 102.0], origin_s=1000.0)
    assert trace.time_s.tolist() == [0.0, 0.5, 1.5]
    assert trace.origin_s == 1100.5


def test_repeated_times_drop_the_later_sample() -> None:
    """Of samples at one time the first stays, and the repair is counted."""
    trace = build([0.0, 1.0, 1.0, 1.0, 2.0])
    assert trace.position_m[:, 0].tolist() == [0.0, 1.0, 4.0]
    assert [str(repair) for repair in trace.repairs] == ["2 repeated timestamps dropped"]


def test_a_dropped_cut_passes_to_the_next_sample() -> None:
    """A teleport is not lost with the sample that carried it, and the first never has one."""
    trace = build([0.0, 1.0, 1.0, 2.0, 3.0], cut=[True, False, True, False, False])
    assert trace.cut.tolist() == [False, False, True, False]


def test_backward_time_is_refused_with_its_line() -> None:
    """The second of the two samples that are out of order is named."""
    with pytest.raises(InputError, match=r"some.csv:30: expected times in order, got 1 after 5"):
        build([0.0, 5.0, 1.0])


def test_quaternions_are_renormalised_and_counted() -> None:
    """A norm off by 5 % is mended and counted, rounding by 0.05 % is mended without a word."""
    trace = build([0.0, 1.0, 2.0], [IDENTITY, [0, 0, 0, 1.05], [0, 0, 0, 1.0005]])
    assert trace.orientation_xyzw.tolist() == [IDENTITY] * 3
    assert [str(repair) for repair in trace.repairs] == ["1 quaternions renormalised"]


@pytest.mark.parametrize("quaternion", [[0, 0, 0, 0], [0, 0, 0, 1.2], [1, 1, 1, 1]])
def test_wrong_quaternion_is_refused_with_its_line(quaternion: list[float]) -> None:
    """A norm more than 0.1 off 1 is no rounding: the columns are probably in another order."""
    with pytest.raises(InputError, match=r"some.csv:20: expected a unit quaternion"):
        build([0.0, 1.0], [IDENTITY, quaternion])


def test_unit_quaternions_keep_every_bit() -> None:
    """Normalising twice changes nothing, so that native files round-trip."""
    rng = np.random.default_rng(4)
    raw = rng.normal(size=(500, 4))
    once = build(list(range(500)), raw / np.linalg.norm(raw, axis=1, keepdims=True))
    twice = build(list(range(500)), once.orientation_xyzw)
    assert np.array_equal(once.orientation_xyzw, twice.orientation_xyzw)
    assert not once.repairs


def test_nanoseconds_taken_for_seconds_are_refused() -> None:
    """A median interval of 10,000,000 cannot be seconds."""
    with pytest.raises(InputError, match="expected times in seconds"):
        build([0.0, 1e7, 2e7])


def test_positions_off_the_earth_are_refused() -> None:
    """Coordinates beyond 10,000 km are in another unit; the line is named."""
    positions = [[0.0, 0.0, 0.0], [0.0, 2e7, 0.0]]
    with pytest.raises(InputError, match=r"some.csv:20: expected positions in metres"):
        build([0.0, 1.0], position_m=positions)


def test_a_name_that_is_no_text_is_made_one() -> None:
    """Bytes of a file name that are not UTF-8 become question marks, which can be written."""
    trace = trace_from_samples(
        "walk\udcff",
        PATH,
        [1],
        time_s=[0.0],
        position_m=[[0.0, 0.0, 0.0]],
        orientation_xyzw=[IDENTITY],
    )
    assert trace.name == "walk?"


def test_no_samples_are_refused() -> None:
    """A file of comments only is named as empty of samples."""
    with pytest.raises(InputError, match="at least one sample"):
        build([])
