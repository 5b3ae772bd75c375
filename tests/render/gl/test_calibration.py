"""Calibration: its frames spread the predictors so that a fit can tell their costs apart."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
import trimesh

from lodbench.models.meshes.geometry import LevelMesh
from lodbench.models.scene.scene import Scene
from lodbench.policies.protocol import Policy
from lodbench.policies.registry import parse_policy
from lodbench.render.gl.calibration import Calibration
from lodbench.render.gl.opengl_machine import GlMachine
from lodbench.render.gl.recorder import record, recorded_hardware
from lodbench.sim.replay import ReplayOptions

FRAMES = 120
PREDICTORS = ("draw_calls", "triangles", "rasterized_triangles", "framebuffer_pixels")
COUNTS = (*PREDICTORS, "vertices", "state_changes", "shaded_samples")
Columns = Mapping[str, Any]


def ball(subdivisions: int) -> LevelMesh:
    """Return a ball of 20 · 4^subdivisions triangles."""
    mesh: Any = trimesh.creation.icosphere(subdivisions=subdivisions)
    start = np.array((0, len(mesh.faces)))
    return LevelMesh(mesh.vertices, mesh.vertex_normals, mesh.faces, start)


@pytest.fixture(scope="module")
def recorded(drawing: Any, make_trace: Any, llvmpipe: Any) -> Callable[[Policy, int], Columns]:
    """Return a function that records a walk through 300 balls of two types."""
    rng = np.random.default_rng(7)
    chains = [[ball(n) for n in (3, 2, 1, 0)], [ball(2), ball(0)]]
    position_m = rng.uniform((-25, -3, -80), (25, 3, -3), (300, 3))
    made = drawing(position_m, chains, kind=rng.integers(0, 2, 300), scale=0.7)
    renderer, device = made.renderer(), made.target.device
    trace = make_trace([(0.0, 0.0, 0.0), (0.0, 0.0, -40.0)], time_s=[0.0, FRAMES * 0.02])
    hardware = recorded_hardware(llvmpipe, (160, 90))

    def walk(policy: Policy, frames: int) -> Columns:
        machine = GlMachine(renderer, device, repeats=1, warmup=1, step_ms=20.0)
        options = ReplayOptions(budget_ms=5.0, frames=frames)
        found = record(
            policy, made.scene, trace, hardware, options, machine, machine, name="a walk"
        )
        return found.columns

    return walk


def condition(columns: Columns) -> float:
    """Return the condition number of the design of a fit with a base, its columns scaled."""
    design = np.column_stack(
        [np.ones(len(columns["triangles"])), *(columns[p] for p in PREDICTORS)]
    )
    return float(np.linalg.cond(design / np.linalg.norm(design, axis=0)))


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_design_of_a_fit_is_well_posed(recorded: Any, seed: int) -> None:
    """Small errors of the times do not become large ones of the costs."""
    assert condition(recorded(Calibration(seed), FRAMES)) < 30.0


def test_a_policy_leaves_it_singular(recorded: Any) -> None:
    """Its frames are all of one size, so that the base is not told from the pixels."""
    assert condition(recorded(parse_policy("static-screen").make(), 30)) > 1e6


def test_each_predictor_swings(recorded: Any) -> None:
    """By a factor of three at least from the low frames to the high."""
    columns = recorded(Calibration(0), FRAMES)
    for name in PREDICTORS:
        low, high = np.quantile(columns[name], (0.05, 0.95))
        assert high > 3.0 * low


def test_the_same_seed_draws_the_same_frames(recorded: Any) -> None:
    """Whatever they took; another seed draws others."""
    first, again, other = (recorded(Calibration(seed), 40) for seed in (3, 3, 4))
    for name in COUNTS:
        assert first[name].tolist() == again[name].tolist()
    assert first["triangles"].tolist() != other["triangles"].tolist()


def test_one_programme_can_be_drawn_twice(recorded: Any) -> None:
    """A reset begins it anew."""
    programme = Calibration(5)
    first, again = (recorded(programme, 20)["triangles"].tolist() for _ in range(2))
    assert first == again


def test_levels_of_continuous_types_are_their_knots(
    make_scene: Callable[..., Scene], make_levels: Any, make_view: Any
) -> None:
    """A renderer has meshes of knots only, so that nothing between two is asked for."""
    levels = make_levels([(1000.0, 250.0, 50.0)], continuous=True)
    scene = make_scene([(x, 0.0, -30.0) for x in range(-10, 11)], levels=levels)
    programme, seen = Calibration(0), set[float]()
    programme.reset(scene, 10.0)
    for frame in range(60):
        seen |= set(programme.select(make_view(scene, frame=frame)).detail.tolist())
    assert seen == {1.0, 0.25, 0.05}
