"""The bundled tour."""

import numpy as np
import pytest

from lodbench.traces.cameras.generators.tour import tour
from lodbench.traces.cameras.orientation import turn_deg, view_direction


@pytest.mark.parametrize(("size", "axis"), [((90.0, 30.0), 0), ((30.0, 90.0), 1)])
def test_tour_goes_in_along_the_longer_side(size: tuple[float, float], axis: int) -> None:
    """It starts in the middle of the edge, and goes two thirds of the way at eye height."""
    trace = tour((100.0, 50.0, 2.0), size)
    start, end = trace.position_m[0], trace.position_m[-1]
    middle = (100.0, 50.0)[axis]
    assert start[axis] == pytest.approx(middle - 45.0)
    assert end[axis] == pytest.approx(middle + 15.0)
    assert np.ptp(trace.position_m[:, 1 - axis]) == 0.0
    assert (trace.position_m[:, 2] == 2.0 + 1.65).all()


def test_tour_turns_in_and_back() -> None:
    """It looks along the edge, then inward, and at last back from inside."""
    trace = tour((0.0, 0.0, 0.0), (90.0, 30.0))
    ahead = view_direction(trace.orientation_xyzw)
    assert ahead[0] == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)
    assert ahead[np.searchsorted(trace.time_s, 10.0)] == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)
    assert ahead[-1] == pytest.approx([-1.0, 0.0, 0.0], abs=1e-9)


def test_tour_keeps_its_limits() -> None:
    """Turns are at most 360 degrees a second and sudden; the way in is smooth."""
    trace = tour((0.0, 0.0, 0.0), (90.0, 30.0))
    step_s = np.diff(trace.time_s)
    rate = turn_deg(trace.orientation_xyzw[1:], trace.orientation_xyzw[:-1]) / step_s
    assert rate.max() == pytest.approx(360.0, rel=0.02)
    speed = np.linalg.norm(np.diff(trace.position_m, axis=0), axis=1) / step_s
    assert speed.max() == pytest.approx(60.0 / 18.75, rel=1e-3)
    assert np.abs(np.diff(speed)).max() < 0.05 * speed.max()
    assert not trace.cut.any()
