"""Test levels by their error on the screen."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.scene import Scene
from lodbench.policies.thresholds.pixel_error import PixelError

Make = Callable[..., Any]
ERRORS = (0.0, 0.1, 0.2, 0.4)
LOOKING_ON = (0.0, 0.0, 0.0, 1.0)


@pytest.fixture(scope="module")
def chain(make_scene: Make, make_levels: Make) -> Callable[..., Scene]:
    """Return a function that builds objects ahead at given depths, errors 0 to 0.4 m."""
    levels = make_levels([[8.0, 4.0, 2.0, 1.0]], error_m=[ERRORS])

    def build(depth_m: Any, **more: Any) -> Scene:
        position_m = [(0.0, 0.0, -float(z)) for z in np.atleast_1d(depth_m)]
        return make_scene(position_m, radius_m=0.5, **{"levels": levels, **more})

    return build


def full_hd() -> Camera:
    """Return the camera of the notes: 60 degrees over 1080 px, 935.307 px per metre at 1 m."""
    return Camera((0.0, 0.0, 0.0), LOOKING_ON, 1920, 1080, np.radians(60.0))


def select(scene: Scene, make_view: Make, detail: Any = np.nan, **params: Any) -> list[float]:
    """Return the levels of all objects."""
    policy = PixelError(**params)
    policy.reset(scene, 10.0)
    return policy.select(make_view(scene, full_hd(), detail=detail)).detail.tolist()


def test_coarsest_level_within_a_pixel(chain: Callable[..., Scene], make_view: Make) -> None:
    """935.307 px/m: 0.1 m is one pixel from 93.53 m on, 0.2 m from 187.06 m, 0.4 m from 374.12 m.

    Distances are to the surface, half a metre before the centre.
    """
    depth_m = np.array([10.0, 93.5, 93.6, 187.0, 187.1, 374.1, 374.2, 5000.0]) + 0.5
    assert select(chain(depth_m), make_view) == [0, 0, 1, 1, 2, 2, 3, 3]


def test_threshold_of_cesium_sixteen_pixels(chain: Callable[..., Scene], make_view: Make) -> None:
    """An error of 1 m reaches 16 px at 58.46 m (notes, section 2), so 0.1 m does at 5.846 m."""
    levels = select(chain([6.34, 6.35]), make_view, threshold_px=16.0)
    assert levels == [0, 1]


def test_scale_multiplies_the_error(chain: Callable[..., Scene], make_view: Make) -> None:
    """An object of twice the size keeps its level to twice the distance."""
    scene = chain([187.0 + 1.0, 187.1 + 1.0], scale=2.0)
    assert select(scene, make_view) == [0, 1]


def test_hysteresis_delays_only_coarser_levels(
    chain: Callable[..., Scene], make_view: Make
) -> None:
    """With 10 % an object at level 0 goes to 1 at 103.9 m; coming back it does so at 93.5 m."""
    scene = chain(np.array([93.4, 93.6, 103.8, 104.0]) + 0.5)
    assert select(scene, make_view, detail=0.0, hysteresis=0.1) == [0, 0, 0, 1]
    assert select(scene, make_view, detail=1.0, hysteresis=0.1) == [0, 1, 1, 1]
    assert select(scene, make_view, hysteresis=0.1) == [0, 1, 1, 1]  # never drawn before
    assert select(scene, make_view, detail=2.0, hysteresis=0.1) == [0, 1, 1, 1]


def test_a_step_forward_and_back_switches_once_at_most(
    chain: Callable[..., Scene], make_view: Make
) -> None:
    """Within the band of hysteresis, forward, back and forward again is one switch, not three."""
    policy = PixelError(hysteresis=0.1)
    scene = chain(100.0)
    policy.reset(scene, 10.0)
    switches, detail = 0, np.nan
    for depth_m in (90.0, 100.0, 90.0, 100.0, 90.0):
        camera = replace(full_hd(), position_m=(0.0, 0.0, depth_m - 100.0))
        now = policy.select(make_view(scene, camera, detail=detail)).detail[0]
        switches += int(not np.isnan(detail) and now != detail)
        detail = now
    assert switches == 0


def test_continuous_types_take_knots(
    chain: Callable[..., Scene], make_view: Make, make_levels: Make
) -> None:
    """The same distances give the resolutions 1, 1/2, 1/4 and 1/8 of the knots, held alike."""
    soft = make_levels([[8.0, 4.0, 2.0, 1.0]], error_m=[ERRORS], continuous=True)
    depth_m = np.array([93.5, 93.6, 187.1, 374.2]) + 0.5
    scene = chain(depth_m, levels=soft)
    assert select(scene, make_view) == [1.0, 0.5, 0.25, 0.125]
    assert select(scene, make_view, detail=1.0, hysteresis=0.1) == [1.0, 1.0, 0.5, 0.25]


@given(
    depth_m=st.lists(st.floats(1.0, 5000.0), min_size=1, max_size=8),
    threshold_px=st.floats(0.1, 20.0),
    detail=st.sampled_from([np.nan, 0.0, 1.0, 2.0, 3.0]),
    hysteresis=st.sampled_from([0.0, 0.2]),
)
def test_error_never_exceeds_the_threshold(
    chain: Callable[..., Scene],
    make_view: Make,
    depth_m: list[float],
    threshold_px: float,
    detail: float,
    hysteresis: float,
) -> None:
    """What is drawn errs by the threshold at most, with any past; without, the next is worse."""
    scene = chain(depth_m)
    levels = select(scene, make_view, detail, threshold_px=threshold_px, hysteresis=hysteresis)
    for level, depth in zip(map(int, levels), depth_m, strict=True):
        px_per_m = full_hd().focal_px / max(depth - 0.5, 0.1)
        assert level == 0 or ERRORS[level] * px_per_m <= threshold_px * (1 + 1e-12)
        if not hysteresis and level < 3:
            assert ERRORS[level + 1] * px_per_m > threshold_px * (1 - 1e-12)


@pytest.mark.parametrize("params", [{"threshold_px": 0.0}, {"hysteresis": 1.0}])
def test_senseless_parameters_are_refused(
    chain: Callable[..., Scene], params: dict[str, float]
) -> None:
    """A parameter out of its range is bad input."""
    with pytest.raises(InputError, match=f"pixel-error: expected .*{next(iter(params))}.*, got"):
        PixelError(**params).reset(chain(10.0), 10.0)
