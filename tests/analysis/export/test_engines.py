"""A policy as settings of engines: the engine's own rule switches where the policy does."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.analysis.export.engine_settings import EngineSettings
from lodbench.analysis.export.engines import ENGINES, engine_settings
from lodbench.analysis.export.settings_text import settings_text
from lodbench.base.errors import InputError
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy

LEVELS = 3


@pytest.fixture
def ball(make_scene: Callable[..., Scene]) -> Scene:
    """Return a scene of one sphere of radius 1 m with three levels, at the origin."""
    return make_scene([(0.0, 0.0, 0.0)])


def settings_of(engine: str, policy: str, scene: Scene | None) -> EngineSettings:
    """Return a policy in an engine, at 60 degrees."""
    return engine_settings(engine, parse_policy(policy), scene, 60.0)


def level_drawn(policy: str, ball: Scene, distance_m: float, before: float, make_view: Any) -> int:
    """Return the level that the policy itself draws at a distance, at 60 degrees."""
    made = parse_policy(policy).make()
    made.reset(ball, 10.0)
    camera = Camera((0.0, 0.0, distance_m), (0.0, 0.0, 0.0, 1.0), 1920, 1080, math.pi / 3.0)
    return int(made.select(make_view(ball, camera, detail=before)).detail[0])


def test_heights_by_hand(ball: Scene) -> None:
    """Level 0 down to a quarter of the screen, level 1 to an eighth, level 2 for ever; bias 2."""
    found = settings_of("unity", "static-screen:first=0.25,ratio=0.5,bias=2,hysteresis=0", ball)
    assert found.project == {"QualitySettings.lodBias": 2.0}
    assert found.types[0].settings == {"LODGroup.size": 2.0}
    heights = [level["LOD.screenRelativeTransitionHeight"] for level in found.types[0].levels]
    assert heights == [0.25, 0.125, 0.0]
    assert not any("hysteresis" in sentence for sentence in found.differs)
    # Radius 1 m: h = 1 / (d tan 30°) = sqrt 3 / d, so that a quarter at bias 2 is at 8 sqrt 3 m.
    by_distance = settings_of("threejs", found.policy, ball).types[0].levels
    assert [level["distance"] for level in by_distance] == pytest.approx(
        [0.0, 8.0 * math.sqrt(3.0), 16.0 * math.sqrt(3.0)]
    )


def test_screen_sizes_by_hand(ball: Scene) -> None:
    """A screen size is that below which a level is drawn; the bias and the hysteresis are in it."""
    found = settings_of("unreal", "static-screen:first=0.3,ratio=0.5,bias=2,hysteresis=0.02", ball)
    sizes = [level["ScreenSize"] for level in found.types[0].levels]
    assert sizes == pytest.approx([1.0, 0.15, 0.075])
    assert {level["LODHysteresis"] for level in found.types[0].levels} == {0.01}
    large = settings_of("unreal", "static-screen:first=0.3,ratio=0.5,bias=0.1", ball)
    assert [level["ScreenSize"] for level in large.types[0].levels] == pytest.approx([3, 3, 1.5])


def test_distances_by_hand(ball: Scene) -> None:
    """10 m to 70 m over three levels: 30 m and 50 m, back at nine tenths of these."""
    policy = "static-distance:near_m=10,far_m=70,hysteresis=0.1"
    three = settings_of("threejs", policy, ball).types[0].levels
    assert [level["distance"] for level in three] == pytest.approx([0.0, 30.0, 50.0])
    assert [level["hysteresis"] for level in three] == pytest.approx([0.0, 0.1, 0.1])
    ranges = settings_of("godot", policy, ball).types[0].levels
    assert [list(level.values()) for level in ranges] == [
        pytest.approx([0.0, 0.0, 28.5, 1.5]),
        pytest.approx([28.5, 1.5, 47.5, 2.5]),
        pytest.approx([47.5, 2.5, 0.0, 0.0]),
    ]
    doubled = settings_of("threejs", f"{policy},scale=2", ball).types[0].levels
    assert [level["distance"] for level in doubled] == pytest.approx([0.0, 60.0, 100.0])


def test_distances_by_size(make_scene: Callable[..., Scene]) -> None:
    """Where none is given it is 4 to 80 radii: of 1 m at scale 1, whatever the objects' scale."""
    scene = make_scene([(0.0, 0.0, 0.0)], scale=3.0)
    found = settings_of("threejs", "static-distance", scene)
    far_m = [4.0 + 76.0 / 3.0, 4.0 + 152.0 / 3.0]
    assert [level["distance"] for level in found.types[0].levels] == pytest.approx([0.0, *far_m])
    assert any("multiply them by an object's scale" in sentence for sentence in found.differs)


def test_thresholds_by_hand() -> None:
    """One number of the project: pixels of error in Godot, of screen-space error in Cesium."""
    godot = settings_of("godot", "pixel-error:threshold_px=2.5", None)
    assert godot.project["rendering/mesh_lod/lod_change/threshold_pixels"] == 2.5
    cesium = settings_of("cesium", "screen-space-error:tolerance_px=8,memory_bytes=1e6", None)
    assert cesium.project["maximumScreenSpaceError"] == 8.0
    assert cesium.project["cacheBytes"] == 1e6
    lost = settings_of("cesium", "pixel-error:threshold_px=3,hysteresis=0.2", None)
    assert lost.project["maximumScreenSpaceError"] == 3.0
    assert any("hysteresis=0.2 is lost" in sentence for sentence in lost.differs)


@pytest.mark.parametrize(
    "policy",
    [
        "static-screen:first=0.2,ratio=0.6,bias=1.7,hysteresis=0.02",
        "static-distance:near_m=2,far_m=40,hysteresis=0.15,scale=0.7",
        "static-distance:hysteresis=0.15",
    ],
)
def test_switches_are_those_of_the_policy(policy: str, ball: Scene, make_view: Any) -> None:
    """A little before and behind each distance, out and back, the policy draws what is exported."""
    three = settings_of("threejs", policy, ball).types[0].levels
    for level in range(1, LEVELS):
        out_m = three[level]["distance"]
        back_m = out_m * (1.0 - three[level]["hysteresis"])
        assert back_m < out_m
        for distance_m, before, drawn in (
            (0.9999 * out_m, level - 1, level - 1),
            (1.0001 * out_m, level - 1, level),
            (1.0001 * back_m, level, level),
            (0.9999 * back_m, level, level - 1),
        ):
            assert level_drawn(policy, ball, distance_m, before, make_view) == drawn


@pytest.mark.parametrize("distance_m", np.geomspace(2.0, 60.0, 9).tolist())
def test_unity_and_unreal_draw_the_same(distance_m: float, ball: Scene, make_view: Any) -> None:
    """By each engine's own formula, without hysteresis, the level is that of the policy."""
    policy = "static-screen:first=0.2,ratio=0.6,bias=1.7,hysteresis=0"
    drawn = level_drawn(policy, ball, distance_m, math.nan, make_view)
    unity = settings_of("unity", policy, ball)
    size_m = unity.types[0].settings["LODGroup.size"]
    bias = float(unity.project["QualitySettings.lodBias"])
    height = size_m * bias / (distance_m * 2.0 * math.tan(math.radians(30.0)))
    heights = [level["LOD.screenRelativeTransitionHeight"] for level in unity.types[0].levels]
    assert next(level for level, at in enumerate(heights) if height >= at) == drawn
    sizes = [level["ScreenSize"] for level in settings_of("unreal", policy, ball).types[0].levels]
    m11 = 1.0 / math.tan(math.radians(30.0))
    screen_size = 2.0 * max(0.5 * m11 * 1080 / 1920, 0.5 * m11) * 1.0 / distance_m
    assert sum(screen_size < at for at in sizes[1:]) == drawn


@pytest.mark.parametrize(
    ("engine", "policy", "message"),
    [
        ("unty", "static-screen", "did you mean unity"),
        ("unity", "funkhouser", "got funkhouser, which has no counterpart there"),
        ("threejs", "pixel-error", "expected a policy that it has settings for, static-distance"),
        ("unity", "static-screen", "expected a scene"),
        ("unity", "static-screen:first=2", "divide first, hysteresis and bias by 2"),
        ("unity", "static-screen:bias=0.05", "multiply bias, first and hysteresis by 2:"),
        ("cesium", "static-distance", "no counterpart"),
    ],
)
def test_what_has_no_counterpart_is_refused(engine: str, policy: str, message: str) -> None:
    """One line says what the engine has instead, or what to do."""
    with pytest.raises(InputError, match=message) as refused:
        settings_of(engine, policy, None)
    assert "\n" not in str(refused.value)


def test_trees_are_refused(make_scene: Callable[..., Scene]) -> None:
    """A hierarchy has no levels to set."""
    tree = make_scene([(0.0, 0.0, 0.0), (0.0, 0.0, 0.0)], parent=[-1, 0])
    with pytest.raises(InputError, match="a tree"):
        settings_of("unity", "static-screen", tree)


@pytest.mark.parametrize("engine", ENGINES)
def test_text_names_every_setting(engine: str, ball: Scene) -> None:
    """Each setting's name and each difference stands in the text."""
    found = settings_of(engine, ENGINES[engine].policies[0], ball)
    text = settings_text(found)
    names = {*found.project, *(name for kind in found.types for name in kind.levels[0])}
    assert [name for name in (*names, *found.differs) if name not in text] == []
