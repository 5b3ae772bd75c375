"""Levels from projected height: the engines' formulas, thresholds and hysteresis by hand."""

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.thresholds.static_screen import StaticScreen, screen_height
from lodbench.policies.view import View

MakeScene = Callable[..., Scene]
MakeView = Callable[..., View]
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def test_screen_height_is_unitys_and_unreals(make_scene: MakeScene, make_view: MakeView) -> None:
    """A sphere of 1 m at 10 m, 90 degrees across at 16:9: 1.7778 / 10 of Unreal's screen size.

    Unity's relative height of its diameter is ``2 / (10 · 2 tan(fovy / 2))``: the same number.
    """
    fovy = 2.0 * math.atan(9.0 / 16.0)
    camera = Camera((0.0, 0.0, 0.0), UPRIGHT, 1600, 900, fovy)
    view = make_view(make_scene([(0.0, 0.0, -10.0)]), camera)
    assert screen_height(view) == pytest.approx([0.17778], abs=5e-6)
    assert screen_height(view) == pytest.approx([2.0 / (10.0 * 2.0 * math.tan(fovy / 2.0))])


def test_height_is_finite_around_the_eye(make_scene: MakeScene, make_view: MakeView) -> None:
    """Inside a sphere its height is that at its radius: the screen's, at 90 degrees."""
    view = make_view(make_scene([(0.0, 0.0, -0.5), (0.0, 0.0, 0.0)], radius_m=2.0))
    assert screen_height(view) == pytest.approx([1.0, 1.0])


@pytest.fixture
def choose(
    make_scene: MakeScene, make_levels: Callable[..., LevelTable], make_view: MakeView
) -> Callable[..., list[float]]:
    """Return a function that selects levels of spheres of given heights, at 90 degrees."""

    def chosen(
        policy: StaticScreen, heights: Sequence[float], detail: object = np.nan
    ) -> list[float]:
        levels = make_levels([(100, 50, 25, 12)])
        scene = make_scene([(0.0, 0.0, -1.0 / h) for h in heights], levels=levels)
        policy.reset(scene, 10.0)
        selection = policy.select(make_view(scene, detail=detail))
        assert selection.work.objects_visited == len(heights)
        return selection.detail.tolist()

    return chosen


Choose = Callable[..., list[float]]


def test_thresholds_form_a_geometric_ladder(choose: Choose) -> None:
    """From a height of 0.4 halving: level 0 down to 0.4, 1 to 0.2, 2 to 0.1, then 3."""
    policy = StaticScreen(first=0.4, ratio=0.5, hysteresis=0.0)
    heights = [0.9, 0.401, 0.399, 0.201, 0.199, 0.101, 0.099, 0.01]
    assert choose(policy, heights) == [0, 0, 1, 1, 2, 2, 3, 3]


def test_a_bias_multiplies_heights(choose: Choose) -> None:
    """With Unity's lodBias of 2 every object is judged at twice its height."""
    policy = StaticScreen(first=0.4, ratio=0.5, bias=2.0, hysteresis=0.0)
    assert choose(policy, [0.201, 0.199, 0.101, 0.099]) == [0, 1, 1, 2]


def test_hysteresis_as_in_unreal(choose: Choose) -> None:
    """Coarser below S = 0.2, finer again above S + h = 0.25, whatever is drawn in between."""
    policy = StaticScreen(first=0.2, ratio=0.5, hysteresis=0.05)
    heights = [0.19, 0.21, 0.24, 0.26]
    assert choose(policy, heights, detail=0.0) == [1, 0, 0, 0]
    assert choose(policy, heights, detail=1.0) == [1, 1, 1, 0]
    assert choose(policy, heights) == [1, 0, 0, 0]  # never drawn before


def test_coming_from_afar_hysteresis_holds_each_threshold(choose: Choose) -> None:
    """From level 3 at a height of 0.22, level 1 is reached at 0.15 but level 0 not before 0.25."""
    policy = StaticScreen(first=0.2, ratio=0.5, hysteresis=0.05)
    assert choose(policy, [0.22, 0.14, 0.04], detail=3.0) == [1, 2, 3]


def test_hysteresis_larger_than_a_height_keeps_the_level(choose: Choose) -> None:
    """With a margin above every height nothing ever becomes finer again."""
    policy = StaticScreen(first=0.2, ratio=0.5, hysteresis=2.0)
    assert choose(policy, [0.9, 0.15], detail=2.0) == [2, 2]


def level_by_rule(height: float, before: float, levels: int, hysteresis: float) -> int:
    """Return the level of one object under the default ladder, one threshold after the other."""

    def reached(height: float) -> int:
        return next((i for i in range(levels) if height >= 0.25 * 0.5**i), levels - 1)

    level = reached(height)
    if not math.isnan(before) and level < before:
        return min(reached(height - hysteresis), int(before))
    return level


@pytest.mark.parametrize("hysteresis", [0.0, 0.01])
@pytest.mark.parametrize("step_m", [0.02, 3.0])
def test_levels_follow_the_rule_whatever_came_before(
    make_scene: MakeScene,
    make_view: MakeView,
    make_levels: Callable[..., LevelTable],
    hysteresis: float,
    step_m: float,
) -> None:
    """Over 80 frames each object has the level that its height and its last level give.

    Candidates stay or change, some frames are left out, biases vary (also so that the screen is
    too high for an object around the eye), and now and then another level was drawn than chosen.
    """
    rng = np.random.default_rng(5)
    levels = make_levels([(900, 300, 100, 30), (50, 20)])
    scene = make_scene(rng.uniform(-12, 12, (60, 3)), kind=np.arange(60) % 2, levels=levels)
    policy = StaticScreen(hysteresis=hysteresis)
    policy.reset(scene, 16.0)
    drawn, frame, last, previous = np.full(60, np.nan), 0, None, None
    chosen: list[tuple[np.ndarray, list[int]]] = []
    for _ in range(80):
        frame += int(rng.choice((1, 1, 1, 2)))
        position = tuple(rng.uniform(-step_m, step_m, 3))
        camera = Camera(position, UPRIGHT, 100, 100, 1.5)
        view = make_view(scene, camera, detail=drawn, frame=frame, previous=previous)
        if last is not None and np.array_equal(last.ids, view.ids):
            view = View(view.state, last.ids, view.xyz_m, last.nodes)
        last, bias = view, float(rng.choice((0.05, 0.9, 1.0, 1.1)))
        before = [float(level) for level in drawn]
        selection = previous = policy.select_biased(view, bias)
        heights = list(map(float, screen_height(view, bias)))
        expected = [
            level_by_rule(height, before[i], 4 - 2 * (i % 2), hysteresis)
            for i, height in zip(map(int, view.ids), heights, strict=True)
        ]
        assert selection.detail.tolist() == expected
        chosen.append((selection.detail, expected))
        drawn[view.ids] = selection.detail
        if rng.random() < 0.1:
            # As after frames that were not this policy's.
            drawn[view.ids[:3]], frame, previous = 0.0, frame + 1, None
    assert all(detail.tolist() == levels for detail, levels in chosen)  # none was changed later


@pytest.mark.parametrize(
    "wrong",
    [{"first": 0.0}, {"ratio": 1.0}, {"ratio": 0.0}, {"bias": 0.0}, {"hysteresis": -0.1}],
)
def test_impossible_parameters_are_refused(make_scene: MakeScene, wrong: dict[str, float]) -> None:
    """A ladder that does not fall, and heights that are nothing, are errors."""
    with pytest.raises(InputError, match=f"static-screen: expected {next(iter(wrong))} in"):
        StaticScreen(**wrong).reset(make_scene([(0.0, 0.0, -1.0)]), 10.0)
