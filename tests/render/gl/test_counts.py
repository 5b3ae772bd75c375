"""The renderer's counts: by hand, against the simulator's, and of samples against pixels."""

from typing import Any

import numpy as np
import pytest

from lodbench.policies.registry import parse_policy
from lodbench.render.gl.draw_list import Counts
from lodbench.render.gl.opengl_machine import GlMachine
from lodbench.render.gl.recorder import record, recorded_hardware
from lodbench.render.gl.renderer import Renderer
from lodbench.sim.replay import ReplayOptions

INSTANCE_BYTES, BONE_BYTES, MATRIX_BYTES = 32, 8 * 48, 64


@pytest.mark.parametrize(("instancing", "calls"), [(False, 7), (True, 4)])
def test_counts_by_hand(drawing: Any, cube: Any, quad: Any, instancing: bool, calls: int) -> None:
    """Three cubes of two parts (one at the coarse level of one), and two skinned squares."""
    made = drawing(
        [(x, 0.0, -9.0) for x in (-4.0, -2.0, 0.0, 2.0, 4.0)],
        [[cube(parts=(4, 8)), cube()], [quad()]],
        kind=[0, 1, 0, 1, 0],
        skinned=[[False, False], [True]],
        textured=0.5,
    )
    renderer = made.renderer(instancing=instancing)
    frame = renderer.prepare(made.picture(level=np.array([0, 0, 1, 0, 0]), size_px=(32, 48)))
    uploaded = MATRIX_BYTES + 5 * INSTANCE_BYTES + 2 * BONE_BYTES
    # Half of a cube's triangles are textured by the table: of two parts the one of four has room.
    assert renderer.count(frame) == Counts(
        draw_calls=calls,
        vertices=3 * 24 + 2 * 4,
        triangles=3 * 12 + 2 * 2,
        skinned_vertices=2 * 4,
        textured_triangles=2 * 4,
        state_changes=2,
        framebuffer_pixels=32 * 48,
        instance_bytes=uploaded,
        bytes_uploaded=0,
    )


@pytest.mark.parametrize("instancing", [False, True])
def test_mixed_objects_change_state_as_often_as_they_are_drawn(
    drawing: Any, cube: Any, quad: Any, covered: Any, instancing: bool
) -> None:
    """Sorted, four cubes and four squares change it twice; in the order 0 5 2 7 4 1 6 3, always."""
    made = drawing(
        [(2.0 * x, 0.0, -20.0) for x in range(-4, 4)], [[cube()], [quad()]], kind=[0, 1] * 4
    )
    renderer = made.renderer(instancing=instancing)
    by_type, mixed = (made.picture(mixed=mixed, upload_bytes=7) for mixed in (False, True))
    counts = [renderer.count(renderer.prepare(picture)) for picture in (by_type, mixed)]
    assert [count.state_changes for count in counts] == [2, 8]
    assert [count.draw_calls for count in counts] == [2 if instancing else 8, 8]
    assert [count.bytes_uploaded for count in counts] == [7, 7]
    assert (renderer.picture(by_type) == renderer.picture(mixed)).all()


def test_samples_of_a_cube(drawing: Any, cube: Any, covered: Any) -> None:
    """Each of its pixels once, or twice where a back side was drawn before the front hid it."""
    turn = np.array((1.0, 2.0, 3.0, 4.0)) / 30**0.5
    made = drawing([(0.3, 0.2, -4.0)], [[cube()]], orientation_xyzw=turn)
    renderer = made.renderer()
    samples = renderer.draw(renderer.prepare(made.picture())).shaded_samples
    pixels = covered(renderer.picture(made.picture())).sum()
    assert pixels <= samples <= 2 * pixels


def test_samples_of_a_square_are_its_pixels(drawing: Any, quad: Any, covered: Any) -> None:
    """Two triangles share a diagonal, and no pixel of it is shaded twice; hidden ones are not."""
    made = drawing([(0.0, 0.0, -3.0), (0.0, 0.0, -4.0)], [[quad()]])
    renderer = made.renderer()
    near, both = (made.picture(ids=ids) for ids in ([0], [0, 1]))
    samples = renderer.draw(renderer.prepare(near)).shaded_samples
    assert samples == covered(renderer.picture(near)).sum()
    assert renderer.draw(renderer.prepare(both)).shaded_samples == samples


@pytest.mark.parametrize("instancing", [False, True])
def test_renderer_and_simulator_count_alike(
    target: Any, plaza: Any, tour: Any, llvmpipe: Any, stepping: Any, instancing: bool
) -> None:
    """In every frame of a replay; instanced, fewer calls draw the same triangles."""
    scene, geometry = plaza
    hardware = recorded_hardware(llvmpipe, (160, 90))
    renderer = Renderer(target, scene, geometry, instancing=instancing)
    measuring = GlMachine(renderer, target.device, repeats=1, warmup=1)
    machine = stepping(measuring, 4_000.0)
    policy = parse_policy("static-screen").make()
    options = ReplayOptions(budget_ms=10.0, frames=4)
    found = record(policy, scene, tour, hardware, options, machine, measuring, name="by size")
    log, columns = found.frames, found.columns
    assert log["drawn"].min() > 20
    for name in ("vertices", "triangles", "skinned_vertices", "textured_triangles"):
        assert columns[name].tolist() == log[name].tolist()
    assert columns["state_changes"].tolist() == log["state_changes"].tolist()
    assert (columns["framebuffer_pixels"] == 160 * 90).all()
    assert (columns["shaded_samples"] <= 160 * 90 * log["drawn"]).all()
    calls = columns["draw_calls"]
    assert (calls < log["draw_calls"]).all() if instancing else (calls == log["draw_calls"]).all()
