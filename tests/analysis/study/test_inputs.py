"""Traces by name or file, placed into a scene."""

from pathlib import Path

import numpy as np
import pytest

from lodbench.analysis.study.inputs import load_trace
from lodbench.base.errors import InputError
from lodbench.models.scene.extent import scene_extent
from lodbench.models.scene.scene import Scene
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.generators.generate import KINDS
from lodbench.traces.cameras.write_trace import write_trace


@pytest.fixture
def walked(tmp_path: Path) -> Path:
    """Return a file whose path goes 2 m in x and 1 m in y, far from the scene."""
    time_s = np.arange(11) / 10.0
    position = np.column_stack((time_s * 2.0 + 500.0, time_s + 300.0, np.full(11, 7.0)))
    orientation = np.tile([0.0, 0.0, 0.0, 1.0], (11, 1))
    path = tmp_path / "walked.csv"
    trace = CameraTrace("walked", time_s, position, orientation, np.zeros(11, dtype=np.bool_))
    write_trace(trace, path, None)
    return path


@pytest.mark.parametrize("name", ["tour", *KINDS])
def test_named_traces_stay_in_the_scene(name: str, small_scene: Scene) -> None:
    """The bundled trace and those of a kind of movement lie over the scene's ground."""
    middle, size = scene_extent(small_scene)
    trace = load_trace(name, small_scene)
    assert (np.abs(trace.position_m[:, :2] - middle[:2]) <= 0.5 * size[:2].max() + 1e-6).all()
    assert (trace.position_m[:, 2] > middle[2] - 0.5 * size[2]).all()


def test_file_is_scaled_to_the_scene(small_scene: Scene, walked: Path) -> None:
    """A path from a file is as long as the scene in one direction, and at eye height."""
    middle, size = scene_extent(small_scene)
    trace = load_trace(str(walked), small_scene, "fit")
    low, high = trace.position_m.min(axis=0), trace.position_m.max(axis=0)
    assert 0.5 * (low + high)[:2] == pytest.approx(middle[:2])
    assert max((high - low)[:2] / size[:2]) == pytest.approx(1.0)
    assert low[2] == pytest.approx(middle[2] - 0.5 * size[2] + 1.65)


def test_small_path_is_not_blown_up_and_large_one_is_shrunk(
    small_scene: Scene, walked: Path, tmp_path: Path
) -> None:
    """By default a path keeps its metres, and its speed, unless it is larger than the scene."""
    _, size = scene_extent(small_scene)
    small = load_trace(str(walked), small_scene)
    assert np.ptp(small.position_m, axis=0)[:2].tolist() == pytest.approx([2.0, 1.0])
    long = tmp_path / "long.csv"
    long.write_text(
        "time_s,x_m,y_m,z_m,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,90000,0,0,0,0,0,1\n", "utf-8"
    )
    shrunk = load_trace(str(long), small_scene)
    assert np.ptp(shrunk.position_m[:, 0]) == pytest.approx(size[0])
    assert "at scale" in shrunk.name


def test_file_is_only_moved_when_asked(small_scene: Scene, walked: Path) -> None:
    """With `center` metres stay metres; with `none` nothing is touched."""
    middle, _ = scene_extent(small_scene)
    centered = load_trace(str(walked), small_scene, "center")
    low, high = centered.position_m.min(axis=0), centered.position_m.max(axis=0)
    assert (high - low)[:2].tolist() == pytest.approx([2.0, 1.0])
    assert 0.5 * (low + high)[:2] == pytest.approx(middle[:2])
    untouched = load_trace(str(walked), small_scene, "none")
    assert untouched.position_m[0].tolist() == [500.0, 300.0, 7.0]


@pytest.mark.parametrize(
    ("spec", "said"),
    [("tuor", "did you mean tour"), ("zzz", "or a file"), ("gone.csv", r"gone\.csv")],
)
def test_unknown_trace_is_refused(spec: str, said: str, small_scene: Scene) -> None:
    """A misspelt name gets the nearest one, a missing file its path."""
    with pytest.raises(InputError, match=said):
        load_trace(spec, small_scene)


def test_unknown_placing_is_refused(small_scene: Scene) -> None:
    """A way of placing that is not known is named with those that are."""
    with pytest.raises(InputError, match="shrink, fit, center, none"):
        load_trace("tour", small_scene, "stretch")
