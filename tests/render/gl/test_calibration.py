"""Calibration: its frames spread the predictors so that a fit can tell their costs apart."""

from collections.abc import Callable, Mapping
from dataclasses import astuple, replace
from typing import Any

import numpy as np
import pytest
import trimesh

from lodbench.analysis.validation.recording_summary import IDENTIFIED, condition
from lodbench.models.meshes.geometry import LevelMesh
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.render.gl.calibration import Calibration
from lodbench.render.gl.draw_list import Picture
from lodbench.render.gl.opengl_machine import COUNTED, GlMachine
from lodbench.render.gl.recorder import Recording, record, recorded_hardware
from lodbench.render.gl.renderer import Renderer, Timing
from lodbench.render.gl.shuffled_programme import drawing_order, record_programme
from lodbench.sim.replay import ReplayOptions

FRAMES = 120
PREDICTORS = (
    "draw_calls",
    "triangles",
    "rasterized_triangles",
    "framebuffer_pixels",
    "state_changes",
)
COUNTS = (*PREDICTORS, "bytes_uploaded", "vertices", "shaded_samples", "vertex_shader_invocations")
Columns = Mapping[str, Any]


def ball(subdivisions: int) -> LevelMesh:
    """Return a ball of 20 · 4^subdivisions triangles."""
    mesh: Any = trimesh.creation.icosphere(subdivisions=subdivisions)
    start = np.array((0, len(mesh.faces)))
    return LevelMesh(mesh.vertices, mesh.vertex_normals, mesh.faces, start)


@pytest.fixture(scope="module")
def recorded(drawing: Any, make_trace: Any, llvmpipe: Any) -> Callable[..., Recording]:
    """Return a function that records a walk through 300 balls of two types."""
    rng = np.random.default_rng(7)
    chains = [[ball(n) for n in (3, 2, 1, 0)], [ball(2), ball(0)]]
    position_m = rng.uniform((-25, -3, -80), (25, 3, -3), (300, 3))
    made = drawing(position_m, chains, kind=rng.integers(0, 2, 300), scale=0.7)
    renderer, device = made.renderer(), made.target.device
    trace = make_trace([(0.0, 0.0, 0.0), (0.0, 0.0, -40.0)], time_s=[0.0, FRAMES * 0.02])
    hardware = recorded_hardware(llvmpipe, (160, 90))

    def walk(seed: int, frames: int, policy: str | None = None, **more: Any) -> Recording:
        machine = GlMachine(renderer, device, repeats=1, warmup=1)
        options = ReplayOptions(budget_ms=5.0, seed=seed, frames=frames)
        if policy is None:
            where = (made.scene, trace, hardware, options, machine)
            return record_programme(*where, name="it", **more)
        made_policy = parse_policy(policy).make()
        return record(
            made_policy, made.scene, trace, hardware, options, machine, machine, name="a walk"
        )

    return walk


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_design_of_a_fit_is_well_posed(recorded: Any, seed: int) -> None:
    """Small errors of the times do not become large ones of the costs."""
    assert condition(recorded(seed, FRAMES).columns) < 40.0


class Counting:
    """In place of a machine that measures: counts, and draws nothing."""

    doubt = None

    def __init__(self, renderer: Renderer) -> None:
        self.renderer, self.counted = renderer, list[tuple[float, ...]]()

    def measure(self, picture: Picture, expected: tuple[float, ...]) -> float:
        """Count."""
        frame = self.renderer.prepare(picture)
        self.counted.append((*astuple(self.renderer.count(frame)), 0.0, *expected))
        return 0.0

    def rows(self) -> dict[str, Any]:
        """Return the counts."""
        return dict(zip(COUNTED, np.array(self.counted).T, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_costs_are_told_apart_on_plaza(
    target: Any, plaza: Any, tour: Any, llvmpipe: Any, seed: int
) -> None:
    """As the guide has it: errors come back in costs 14 times as large at most."""
    scene, geometry = plaza
    counting: Any = Counting(Renderer(target, scene, geometry, instancing=False))
    options = ReplayOptions(budget_ms=5.0, seed=seed, frames=400)
    hardware = recorded_hardware(llvmpipe, (160, 90))
    found = record_programme(scene, tour, hardware, options, counting, name="it")
    assert 10.0 < condition(found.columns) < 14.0


def test_a_policy_leaves_it_singular(recorded: Any) -> None:
    """Its frames are all of one size, so that the base is not told from the pixels."""
    assert condition(recorded(0, 30, "static-screen").columns) > 1e6


def test_the_condition_of_a_design_by_hand() -> None:
    """Of ones and one predictor that is 0 or 2 by turns, the eigenvalues are as 3 ± √5."""
    ones = np.ones(4)
    columns = dict.fromkeys(IDENTIFIED, ones) | {"triangles": np.array((0.0, 8.0, 0.0, 8.0))}
    assert condition(columns) > 1e6  # four columns of ones
    turns = np.linalg.svd(np.column_stack((ones, [0.0, 2.0, 0.0, 2.0])))[1]
    assert turns[0] ** 2 / turns[1] ** 2 == pytest.approx((3 + 5**0.5) / (3 - 5**0.5))


def test_each_predictor_swings(recorded: Any) -> None:
    """By a factor of three at least from the low frames to the high."""
    columns = recorded(0, FRAMES).columns
    for name in PREDICTORS:
        low, high = np.quantile(columns[name], (0.05, 0.95))
        assert high > 3.0 * low
    assert 0.2 < np.mean(columns["bytes_uploaded"] > 0.0) < 0.8


def test_the_same_seed_draws_the_same_frames(recorded: Any) -> None:
    """Whatever they took; another seed draws others."""
    first, again, other = (recorded(seed, 24).columns for seed in (3, 3, 4))
    for name in (*COUNTS, "drawn_at"):
        assert first[name].tolist() == again[name].tolist()
    assert first["triangles"].tolist() != other["triangles"].tolist()


def test_each_frame_is_drawn_twice_apart_and_told_in_the_order_of_the_path(recorded: Any) -> None:
    """All frames once before any again; the rows of a frame hold the same but for their times."""
    found = recorded(5, 30)
    columns = found.columns
    assert len(found.frames) == 30
    assert columns["pass"].tolist() == [0.0, 1.0] * 30
    assert (np.diff(columns["trace_s"][::2]) > 0.0).all()
    first, again = columns["drawn_at"][::2], columns["drawn_at"][1::2]
    assert sorted(first) == list(range(30))
    assert sorted(again) == list(range(30, 60))
    for name in (*COUNTS, "trace_s", "x_m"):
        assert columns[name][::2].tolist() == columns[name][1::2].tolist()
    assert columns["triangles"][::2].tolist() == found.frames["triangles"].tolist()
    assert columns["frame_ms"][::2].tolist() != columns["frame_ms"][1::2].tolist()


def test_a_second_pass_that_is_stopped_leaves_the_first(recorded: Any) -> None:
    """When the first pass is over its log is told, in the order of the path."""
    kept: list[Recording] = []

    def stop(found: Recording) -> None:
        kept.append(found)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        recorded(5, 30, on_pass=stop)
    whole, first = recorded(5, 30).columns, kept[0].columns
    assert first["pass"].tolist() == [0.0] * 30
    for name in (*COUNTS, "trace_s", "drawn_at"):
        assert first[name].tolist() == whole[name][::2].tolist()


def test_the_order_of_drawing_tells_nothing_of_the_path() -> None:
    """Correlation of places with frames is that of chance, in each pass and between the two."""
    order = drawing_order(1_000, 0).reshape(2, 1_000)
    assert (np.sort(order, axis=1) == np.arange(1_000)).all()
    assert abs(np.corrcoef(order, np.arange(1_000))[np.triu_indices(3, 1)]).max() < 0.1


def test_each_row_has_the_times_of_its_own_drawing(
    drawing: Any, cube: Any, make_trace: Any, llvmpipe: Any
) -> None:
    """On a clock that counts drawings, a row's time is its place in their order."""
    made = drawing([(0.0, 0.0, -10.0)], [[cube()]])
    renderer = made.renderer()
    real, drawn = renderer.draw, list[int]()

    def draw(frame: Any, *, counting: bool = False) -> Timing:
        drawn.append(len(drawn))
        return replace(real(frame, counting=counting), frame_ms=float(len(drawn)))

    renderer.draw = draw
    machine = GlMachine(renderer, made.target.device, repeats=1, warmup=1)
    options, hardware = (
        ReplayOptions(budget_ms=5.0, frames=20),
        recorded_hardware(llvmpipe, (64, 36)),
    )
    found = record_programme(made.scene, make_trace(), hardware, options, machine, name="it")
    warmup = 1
    assert found.columns["frame_ms"].tolist() == (found.columns["drawn_at"] + 1 + warmup).tolist()


def test_levels_of_continuous_types_are_their_knots(
    make_scene: Callable[..., Scene], make_levels: Any, make_view: Any
) -> None:
    """A renderer has meshes of knots only, so that nothing between two is asked for."""
    levels = make_levels([(1000.0, 250.0, 50.0)], continuous=True)
    scene = make_scene([(x, 0.0, -30.0) for x in range(-10, 11)], levels=levels)
    programme, seen = Calibration(0), set[float]()
    programme.reset(scene, 10.0)
    for frame in range(240):
        seen |= set(programme.select(make_view(scene, frame=frame)).detail.tolist())
    assert seen == {1.0, 0.25, 0.05}
