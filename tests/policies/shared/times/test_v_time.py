"""Predictions that follow measured times: by hand, and in replays on a machine that is slower."""

from collections.abc import Callable

import numpy as np
import pytest

from lodbench.models.scene.scene import Scene
from lodbench.policies.shared.times.v_time import VTime
from lodbench.policies.view import View

POLICIES = ("funkhouser", "gobbetti")
BUDGET_MS = 8.0


@pytest.fixture
def views(make_scene: Callable[..., Scene], make_view: Callable[..., View]) -> Callable[..., View]:
    """Return a builder of views with reported times."""
    scene = make_scene([[0.0, 0.0, -5.0]])

    def build(*work_ms: float) -> View:
        return make_view(scene, work_ms=work_ms)

    return build


def test_the_factor_follows_measured_over_predicted(views: Callable[..., View]):
    """Predicted 4 ms, took 8: at rate 0.5 the factor is 1.5, then 1.75."""
    loop = VTime(0.5)
    assert loop.budget_ms(views(), 12.0) == 12.0
    assert loop.expect(4.0) == 4.0
    assert loop.budget_ms(views(8.0), 12.0) == 12.0 / 1.5
    assert loop.expect(4.0) == 6.0
    assert loop.budget_ms(views(8.0, 8.5), 12.0) == pytest.approx(12.0 / (1.5 + 0.5 * 0.625))


def test_no_report_and_no_rate_change_nothing(views: Callable[..., View]):
    """A missing, zero or negative report is none; a rate of 0 learns nothing."""
    loop, still = VTime(0.5), VTime(0.0)
    for times in ((), (np.nan,), (np.nan, 0.0), (np.nan, 0.0, -1.0)):
        assert loop.budget_ms(views(*times), 12.0) == 12.0
        assert still.budget_ms(views(*(99.0 for _ in times)), 12.0) == 12.0
        assert loop.expect(4.0) == still.expect(4.0) == 4.0
