"""Errors of frame times: by hand, and what v_time makes of a machine that runs otherwise."""

import numpy as np
import pytest

from lodbench.analysis.validation.measures.time_errors import adapted_ms, at_times, summarise
from lodbench.base.errors import InputError


def test_errors_by_hand() -> None:
    """Predictions of 11, 9 and 10 for 10 ms are off by 10, -10 and 0 per cent."""
    found = summarise(np.array([11.0, 9.0, 10.0]), np.full(3, 10.0))
    assert found.frames == 3
    assert (found.mean_pct, found.sd_pct) == pytest.approx((0.0, 10.0))
    assert (found.p05_pct, found.p50_pct, found.p95_pct) == pytest.approx((-9.0, 0.0, 9.0))


def test_frames_that_the_other_series_has_not_are_left_out() -> None:
    """A prediction that is NaN is no frame to compare, and one frame is not enough."""
    found = summarise(np.array([np.nan, 11.0, 11.0]), np.full(3, 10.0))
    assert found.frames == 2
    with pytest.raises(InputError, match="expected at least two frames to compare, got 1"):
        summarise(np.array([np.nan, 11.0]), np.full(2, 10.0))


def test_adaptation_begins_at_the_model_and_ends_at_the_machine() -> None:
    """The first frame is the model's; on a machine 30 % slower the error decays as 0.8^k."""
    predicted = np.full(60, 10.0)
    adapted = adapted_ms(predicted, 1.3 * predicted, rate=0.2)
    expected = 10.0 * (1.3 - 0.3 * 0.8 ** np.arange(60))
    assert adapted == pytest.approx(expected)


def test_a_frame_predicted_to_take_no_time_teaches_nothing() -> None:
    """The factor stays as it was, and later frames are adapted as ever."""
    found = adapted_ms(np.array([1.0, 0.0, 1.0, 1.0]), np.full(4, 2.0), rate=0.5)
    assert found == pytest.approx([1.0, 0.0, 1.5, 1.75])


def test_adaptation_never_sees_the_frame_that_it_predicts() -> None:
    """Changing the last measurement changes no prediction."""
    rng = np.random.default_rng(2)
    predicted, measured = rng.uniform(5.0, 9.0, (2, 20))
    other = measured.copy()
    other[-1] *= 3.0
    assert np.array_equal(adapted_ms(predicted, measured), adapted_ms(predicted, other))


def test_a_series_at_other_times_is_interpolated_and_ends_where_it_ends() -> None:
    """Between 1 s and 2 s the value is between; after the last frame there is none."""
    found = at_times(np.array([1.0, 2.0]), np.array([10.0, 20.0]), np.array([1.25, 2.0, 2.5]))
    assert found[:2] == pytest.approx([12.5, 20.0])
    assert np.isnan(found[2])
