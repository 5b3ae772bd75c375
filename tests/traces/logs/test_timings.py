"""Frame timings: what is refused on construction."""

from dataclasses import replace

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.traces.logs.timings import FloatArray, FrameTimings, complete_timings


def made(dropped: list[bool], **known: FloatArray) -> FrameTimings:
    """Return timings of these columns."""
    return complete_timings(
        known,
        np.array(dropped, dtype=np.bool_),
        dialect="simulated",
        application="",
        process_id=-1,
        swap_chain="",
    )


def test_what_nothing_is_known_of_is_nan() -> None:
    """Times of Present() alone give no other column."""
    timings = made([False, False], present_s=np.array([0.0, 0.1]))
    assert len(timings) == 2
    assert np.isnan(timings.frame_ms).all()
    assert np.isnan(timings.cpu_start_s).all()


def test_display_times_of_dropped_frames_are_disregarded() -> None:
    """Version 1 writes zeros for a dropped frame; they are no latency."""
    zeros = np.zeros(2)
    timings = made([True, False], present_s=np.array([0.0, 0.1]), until_displayed_ms=zeros)
    assert np.isnan(timings.until_displayed_ms).tolist() == [True, False]


def test_screen_times_follow_from_latency_and_clock() -> None:
    """Three frames shown 10 and 30 ms apart, a dropped one between."""
    timings = made(
        [False, False, True, False],
        present_s=np.array([0.0, 0.010, 0.020, 0.030]),
        until_displayed_ms=np.array([5.0, 5.0, 0.0, 15.0]),
    )
    nan = float("nan")
    assert timings.between_display_change_ms == pytest.approx([nan, 10, nan, 30], nan_ok=True)
    assert timings.displayed_ms == pytest.approx([10, 30, nan, nan], nan_ok=True)


@pytest.mark.parametrize(
    ("dropped", "known", "message"),
    [
        ([], {"present_s": []}, "at least one frame"),
        ([False, False], {"present_s": [0.0, np.nan]}, "finite"),
        ([False, False], {"present_s": [1.0, 0.5]}, "never to decrease"),
    ],
)
def test_inconsistent_columns_are_refused(
    dropped: list[bool], known: dict[str, list[float]], message: str
) -> None:
    """No frames, no times, backward times."""
    with pytest.raises(InputError, match=message):
        made(dropped, **{name: np.array(values) for name, values in known.items()})


def test_columns_of_unequal_length_are_refused() -> None:
    """Every column has a value for each frame."""
    timings = made([False, False], present_s=np.array([0.0, 0.1]))
    with pytest.raises(InputError, match=r"frame_ms: expected shape \(2,\), got \(1,\)"):
        replace(timings, frame_ms=np.zeros(1))
