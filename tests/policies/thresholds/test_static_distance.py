"""Levels from distance: thresholds and hysteresis by hand."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.thresholds.static_distance import StaticDistance
from lodbench.policies.view import View

Choose = Callable[..., list[float]]


@pytest.fixture
def choose(
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., LevelTable],
    make_view: Callable[..., View],
) -> Choose:
    """Return a function that selects levels of objects straight ahead at given distances."""

    def chosen(
        policy: StaticDistance,
        distances: Sequence[float],
        triangles: Sequence[float] = (100, 50),
        detail: object = np.nan,
    ) -> list[float]:
        scene = make_scene([(0.0, 0.0, -d) for d in distances], levels=make_levels([triangles]))
        view = make_view(scene, detail=detail)
        policy.reset(scene, 10.0)
        selection = policy.select(view)
        assert selection.ids is view.ids
        assert selection.work.objects_visited == len(distances)
        return selection.detail.tolist()

    return chosen


def test_levels_share_the_distance_evenly(choose: Choose) -> None:
    """From 10 to 90 m, four levels change at 30, 50 and 70 m; beyond both ends they are held."""
    distances = [5, 10, 29.9, 30, 49.9, 50, 69.9, 70, 89.9, 90, 500]
    got = choose(StaticDistance(10.0, 90.0), distances, (100, 50, 25, 12))
    assert got == [0, 0, 0, 1, 1, 2, 2, 3, 3, 3, 3]


def test_types_with_other_numbers_of_levels(
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., LevelTable],
    make_view: Callable[..., View],
) -> None:
    """At 60 of 100 m, a type of one level draws it, of two level 1, of five level 3."""
    levels = make_levels([(9,), (9, 8), (9, 8, 7, 6, 5)])
    scene = make_scene([(0.0, 0.0, -60.0)] * 3, kind=[0, 1, 2], levels=levels)
    policy = StaticDistance(0.0, 100.0)
    policy.reset(scene, 10.0)
    assert policy.select(make_view(scene)).detail.tolist() == [0, 1, 3]


def test_hysteresis_as_in_three_js(choose: Choose) -> None:
    """Up at 50 m, back at 45 m with a share of 0.1, the example of three.js's documentation."""
    distances = [44.9, 45.1, 49.9, 50.1]
    policy = StaticDistance(0.0, 100.0, hysteresis=0.1)
    assert choose(policy, distances, detail=0.0) == [0, 0, 0, 1]
    assert choose(policy, distances, detail=1.0) == [0, 1, 1, 1]
    assert choose(policy, distances) == [0, 0, 0, 1]  # never drawn before
    assert choose(StaticDistance(0.0, 100.0), distances, detail=1.0) == [0, 0, 0, 1]


def test_hysteresis_does_not_delay_coarser_levels(choose: Choose) -> None:
    """Going away, levels change at their thresholds whatever was drawn before."""
    policy = StaticDistance(0.0, 100.0, hysteresis=0.2)
    assert choose(policy, [20.0, 30, 60, 99], (9, 8, 7, 6), detail=0.0) == [0, 1, 2, 3]


def test_walking_to_and_fro_switches_less_with_hysteresis(
    make_scene: Callable[..., Scene], make_view: Callable[..., View]
) -> None:
    """Swaying between 47 and 52 m changes the level each time without hysteresis, once with it."""
    for hysteresis, expected in ((0.0, 9), (0.1, 1)):
        policy = StaticDistance(0.0, 150.0, hysteresis)
        detail, switches = np.nan, 0
        for step in range(10):
            scene = make_scene([(0.0, 0.0, -(52.0 if step % 2 else 47.0))])
            policy.reset(scene, 10.0)
            level = float(policy.select(make_view(scene, detail=detail)).detail[0])
            switches += not np.isnan(detail) and level != detail
            detail = level
        assert switches == expected


def test_default_distances_come_from_sizes(
    make_scene: Callable[..., Scene], make_view: Callable[..., View]
) -> None:
    """Levels of a sphere of 1 m go from 4 to 80 m, of one of 2 m from 8 to 160, alone or not."""
    third_m = 4.0 + 76.0 / 3.0  # of three levels
    for distance, radius_m, level in (
        (3.0, 1.0, 0),
        (third_m - 0.01, 1.0, 0),
        (third_m + 0.01, 1.0, 1),
        (81.0, 1.0, 2),
        (2.0 * third_m - 0.01, 2.0, 0),
        (2.0 * third_m + 0.01, 2.0, 1),
    ):
        alone = make_scene([(0.0, 0.0, -distance)], radius_m=radius_m)
        policy = StaticDistance()
        policy.reset(alone, 10.0)
        assert policy.select(make_view(alone)).detail.tolist() == [level]


def test_one_distance_gives_the_other(
    make_scene: Callable[..., Scene], make_view: Callable[..., View]
) -> None:
    """Far is 20 times near: levels of near 1 m, and of far 20 m, change at 7.3 and 13.7 m."""
    scene = make_scene([(0.0, 0.0, -7.3), (0.0, 0.0, -7.4), (0.0, 0.0, -13.6), (0.0, 0.0, -13.7)])
    for policy in (StaticDistance(near_m=1.0), StaticDistance(far_m=20.0)):
        policy.reset(scene, 10.0)
        assert policy.select(make_view(scene)).detail.tolist() == [0, 1, 1, 2]


@pytest.mark.parametrize(
    "wrong",
    [
        {"near_m": -1.0},
        {"near_m": 5.0, "far_m": 5.0},
        {"far_m": float("nan")},
        {"hysteresis": 1.0},
        {"hysteresis": -0.1},
    ],
)
def test_impossible_parameters_are_refused(
    make_scene: Callable[..., Scene], wrong: dict[str, float]
) -> None:
    """Distances out of order and shares outside [0, 1) are errors."""
    with pytest.raises(InputError, match=f"static-distance: expected .*{list(wrong)[-1]}"):
        StaticDistance(**wrong).reset(make_scene([(0.0, 0.0, -1.0)]), 10.0)
