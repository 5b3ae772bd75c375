"""Displays, profiles and posterior draws: what they refuse and what a draw replaces."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.base.predictors import GPU_PREDICTORS
from lodbench.models.machine.hardware import Display, HardwareProfile, Posterior
from lodbench.models.machine.residual import Residual

MakeHardware = Callable[..., HardwareProfile]
P = len(GPU_PREDICTORS)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mode": "fast"}, "display mode: expected immediate, vsync, mailbox or vrr, got fast"),
        ({"images": 4}, "display images: expected 2 or 3, got 4"),
        ({"refresh_hz": 0.0}, "expected 0 < vrr_min_hz <= refresh_hz"),
        ({"refresh_hz": math.nan}, "expected 0 < vrr_min_hz <= refresh_hz"),
        ({"vrr_min_hz": 90.0}, "expected 0 < vrr_min_hz <= refresh_hz"),
        ({"vrr_min_hz": 0.0}, "expected 0 < vrr_min_hz <= refresh_hz"),
        ({"pacing": "slow"}, "pacing: expected none, limiter, just-in-time, got slow"),
        ({"limiter_hz": -1.0}, "limiter_hz: expected 0 .the refresh. to 1e5, got -1.0"),
        ({"latency_limit": 17}, "latency_limit: expected 0 to 16, got 17"),
        ({"latency_limit": 1.5}, "latency_limit: expected a whole number"),
        ({"width_px": 0}, "display: expected positive size, got 0x720"),
    ],
)
def test_impossible_displays_are_refused(changes: dict[str, object], message: str) -> None:
    """Each rule of a display has its own error."""
    with pytest.raises(InputError, match=message):
        replace(Display(), **changes)  # pyright: ignore[reportArgumentType]  # broken on purpose


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"frames_in_flight": 0}, "frames_in_flight: expected 1 to 4, got 0"),
        ({"frames_in_flight": 5}, "frames_in_flight: expected 1 to 4, got 5"),
        ({"memory_bytes": 0.0}, "expected positive finite memory and disk"),
        ({"disk_bytes_per_s": math.inf}, "expected positive finite memory and disk"),
        ({"disk_latency_ms": -1.0}, "disk latency: expected >= 0 ms, got -1"),
    ],
)
def test_impossible_machines_are_refused(
    make_hardware: MakeHardware, changes: dict[str, object], message: str
) -> None:
    """Each rule of a profile has its own error."""
    with pytest.raises(InputError, match=message):
        replace(make_hardware(), **changes)  # pyright: ignore[reportArgumentType]  # on purpose


def test_a_draw_replaces_coefficients_and_scale(make_hardware: MakeHardware) -> None:
    """Draw 1 gives its own base, coefficients and scatter; the rooflines stay the profile's."""
    posterior = Posterior(
        np.array([1.0, 2.0]), np.arange(2.0 * P).reshape(2, P), np.array([0.1, 0.2])
    )
    hardware = replace(
        make_hardware(roofline={"triangles": 7.0}, residual=Residual("student-t", 0.5, dof=3.0)),
        posterior=posterior,
    )
    model, scatter = hardware.truth(1)
    assert (model.base_ms, model.linear_ms.tolist()) == (2.0, list(range(P, 2 * P)))
    assert model.roofline_ms[GPU_PREDICTORS.index("triangles")] == 7.0
    assert scatter == Residual("student-t", 0.2, dof=3.0)
    assert hardware.truth(None) == (hardware.gpu, hardware.gpu_residual)


@pytest.mark.parametrize("draw", [-1, 2])
def test_draws_that_do_not_exist_are_refused(make_hardware: MakeHardware, draw: int) -> None:
    """A profile of two draws has no third, and one that was not fitted has none."""
    posterior = Posterior(np.ones(2), np.ones((2, P)), np.ones(2))
    with pytest.raises(InputError, match=f"has 2 draws, got {draw}"):
        replace(make_hardware(), posterior=posterior).truth(draw)
    with pytest.raises(InputError, match="has 0 draws, got 0"):
        make_hardware().truth(0)


def test_impossible_posteriors_are_refused() -> None:
    """No draws, a negative coefficient and a wrong width are errors."""
    with pytest.raises(InputError, match="expected at least one draw"):
        Posterior(np.zeros(0), np.zeros((0, P)), np.zeros(0))
    with pytest.raises(InputError, match="posterior linear_ms: expected finite values >= 0"):
        Posterior(np.ones(1), np.full((1, P), -1.0), np.ones(1))
    with pytest.raises(InputError, match="posterior linear_ms: expected shape"):
        Posterior(np.ones(1), np.ones((1, 2)), np.ones(1))
