"""Pictures compared: FLIP of pictures by hand, and motion told from switches."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from lodbench.analysis.study.inputs import load_trace
from lodbench.base.errors import InputError
from lodbench.models.meshes.geometry import Geometry
from lodbench.models.scene.scene import Scene
from lodbench.models.scenes.calibration import build_calibration_near
from lodbench.policies.protocol import Capabilities
from lodbench.policies.selection import Selection
from lodbench.policies.view import View
from lodbench.render.gl import image_comparison
from lodbench.render.gl.image_comparison import (
    PictureDifference,
    PictureFolder,
    PictureMachine,
    PictureStep,
    compare_pictures,
    mean_flip,
    require_images,
    summarise_pictures,
)
from lodbench.render.gl.opengl_machine import GlMachine
from lodbench.render.gl.recorder import record, recorded_hardware
from lodbench.render.gl.renderer import Renderer
from lodbench.sim.replay import ReplayOptions

STILL_MS, MOVING_MS = 1e-6, 40.0


class Levels:
    """Draws all nodes at the level that each frame's turn is: 0 for finest, 3 for coarsest."""

    capabilities: ClassVar[Capabilities] = Capabilities()

    def __init__(self, by_frame: Sequence[int]) -> None:
        self._by_frame = by_frame

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Need nothing."""

    def select(self, view: View) -> Selection:
        """Draw all at the frame's level."""
        level = float(self._by_frame[view.frame])
        return Selection(view.ids, np.full(len(view), level))


@pytest.fixture(scope="module")
def large() -> tuple[Scene, Geometry]:
    """Return a scene of few large triangles, four levels a type."""
    return build_calibration_near()


@pytest.fixture
def steps(target: Any, large: Any, llvmpipe: Any, stepping: Any, tmp_path: Path) -> Any:
    """Return a function that records levels by frame, and returns the steps that it finds."""
    scene, geometry = large
    renderer = Renderer(target, scene, geometry, instancing=False)
    tour = load_trace("tour", scene)
    hardware = recorded_hardware(llvmpipe, (160, 90))

    def find(by_frame: Sequence[int], step_ms: float, every: int = 1) -> list[PictureStep | None]:
        measuring = GlMachine(renderer, target.device, repeats=1, warmup=1)
        stepped = stepping(measuring, step_ms)
        machine = PictureMachine(stepped, renderer, PictureFolder(tmp_path, every))
        options = ReplayOptions(budget_ms=4.0, frames=len(by_frame))
        path = tour.stretch(20.0, 22.0)
        record(Levels(by_frame), scene, path, hardware, options, machine, measuring, name="levels")
        return [picture.step for picture in machine.compared]

    return find


def test_flip_of_pictures_by_hand() -> None:
    """0 of a picture and itself, near 1 of black and white, more for more, the same both ways."""
    black = np.zeros((32, 48, 3), dtype=np.uint8)
    grey, white = black + np.uint8(60), black + np.uint8(255)
    assert mean_flip(grey, grey.copy()) == 0.0
    assert 0.9 < mean_flip(black, white) <= 1.0
    assert mean_flip(black, white) == pytest.approx(mean_flip(white, black), rel=1e-3)
    assert 0.0 < mean_flip(black, grey) < mean_flip(black, white)
    small = grey.copy()
    small[10:20, 10:20] = 255
    assert 0.0 < mean_flip(grey, small) < mean_flip(grey, white)
    assert compare_pictures(0, 0.0, small, grey).flip == mean_flip(grey, small)


def test_flip_is_that_of_the_paper() -> None:
    """Against FLIP of a pair of colours worked from the paper: without edges, colours alone count.

    In the middle of uniform pictures filters change nothing, so that FLIP is the colour pipeline of
    sections 4.1.2 and 4.1.3: Hunt-adjusted L*a*b*, HyAB, power .7, and the two-part redistribution.
    """
    first, second = np.array((200, 120, 40)), np.array((120, 140, 60))
    uniform = [np.broadcast_to(c, (64, 64, 3)).astype(np.uint8) for c in (first, second)]
    assert mean_flip(uniform[0], uniform[1]) == pytest.approx(
        flip_of_colors(first, second), rel=5e-3
    )


def flip_of_colors(first: Any, second: Any) -> float:
    """Return FLIP's colour difference of two sRGB colours."""

    def hunt(rgb: Any) -> Any:
        c = np.asarray(rgb) / 255.0
        linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
        # Y and chromaticities of linear sRGB, and the white of D65 by the same matrix.
        matrix = np.array(
            (
                (10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794),
                (2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897),
                (1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382),
            )
        )
        ratio = matrix @ linear / (matrix @ np.ones(3))
        f = np.where(ratio > (6 / 29) ** 3, np.cbrt(ratio), ratio / (3 * (6 / 29) ** 2) + 4 / 29)
        lightness = 116.0 * f[1] - 16.0
        chroma = np.array((500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])))
        return lightness, 0.01 * lightness * chroma

    def distance(one: Any, other: Any) -> float:
        hyab = abs(one[0] - other[0]) + float(np.linalg.norm(one[1] - other[1]))
        return hyab**0.7

    most = distance(hunt((0, 255, 0)), hunt((0, 0, 255)))
    gap, knee, top = distance(hunt(first), hunt(second)), 0.4 * most, 0.95
    if gap < knee:
        return top / knee * gap
    return top + (gap - knee) / (most - knee) * (1.0 - top)


def test_under_a_still_camera_all_that_changes_is_the_switch(steps: Any) -> None:
    """Levels held, nothing changes; where levels change, the step is the switch."""
    first, none, switched = steps((0, 0, 3), STILL_MS)
    assert first is None
    assert none == PictureStep(0.0, 0.0, 0.0)
    assert switched.held_change == 0.0
    assert switched.change == switched.switch > 0.0


def test_without_switches_all_that_changes_is_motion(steps: Any) -> None:
    """At one level the picture changes by the camera's step alone."""
    _, moved, _ = steps((0, 0, 0), MOVING_MS)
    assert moved.change == moved.held_change > 0.0
    assert moved.switch == 0.0


def test_motion_is_told_from_switches(steps: Any) -> None:
    """Levels held, a frame changes by what the finer levels alone would change by."""
    plain, switching = steps((0, 0), MOVING_MS)[1], steps((0, 3), MOVING_MS)[1]
    # What comes into view at the edge has no earlier level, and is drawn at the new one.
    assert switching.held_change == pytest.approx(plain.change, rel=0.1)
    assert switching.change > switching.held_change
    assert 0.0 < switching.switch < switching.change + switching.held_change


def test_every_second_frame_sees_the_same_steps(steps: Any) -> None:
    """A step is to the frame just before, whether that one is compared or not."""
    by_frame = (0, 2, 3, 1, 0)
    all_steps, every_other = steps(by_frame, MOVING_MS), steps(by_frame, MOVING_MS, 2)
    assert every_other == all_steps[::2]


def test_means_of_comparisons() -> None:
    """A first frame counts for the pictures, and not for the steps."""
    first = PictureDifference(0, 0.0, 1.0, 0.0, 0.0, 0.1)
    second = PictureDifference(1, 0.1, 0.5, 0.2, 0.1, 0.3, PictureStep(0.4, 0.3, 0.2))
    assert summarise_pictures([first, second]) == {
        "count": 2,
        "ssim_mean": 0.75,
        "ssim_min": 0.5,
        "difference_mean": 0.1,
        "flip_mean": pytest.approx(0.2),
        "switch_flip_mean": 0.2,
    }
    assert "switch_flip_mean" not in summarise_pictures([first])


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """With what to install."""
    found = {"skimage": object(), "flip_evaluator": None}
    monkeypatch.setattr(image_comparison, "find_spec", found.get)
    with pytest.raises(InputError, match=r"expected flip-evaluator, got none; .*lodbench\[gl\]"):
        require_images()
