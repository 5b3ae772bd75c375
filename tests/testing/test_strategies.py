"""What is drawn keeps its promises, and shrinks to the simplest of its kind."""

import numpy as np
import pytest
from hypothesis import find, given, settings
from hypothesis import strategies as st

import lodbench.testing
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.policies.selection import find_violation
from lodbench.policies.view import View
from lodbench.testing import hardware_profiles, scenes, traces, views
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.orientation import turn_deg

QUICK = settings(max_examples=60, deadline=None, database=None, derandomize=True)


@QUICK
@given(st.one_of(scenes(), scenes(continuous=True), scenes(objects=3, hierarchy=True)))
def test_no_two_objects_tie(scene: Scene) -> None:
    """No two nodes have the same place, size or importance, so that any order is a strict one."""
    for values in (scene.position_m[:, 0], scene.scale, scene.importance):
        if scene.flat:
            assert len(np.unique(values)) == len(scene)
    assert len(np.unique(scene.position_m, axis=0)) == len(scene)


@QUICK
@given(traces())
def test_traces_keep_their_limits(trace: CameraTrace) -> None:
    """No leg is faster than 10 m/s or turns more than 45 degrees in a tenth of a second."""
    steps_m = np.linalg.norm(np.diff(trace.position_m, axis=0), axis=1)
    assert (steps_m <= 1.0 + 1e-9).all()
    turns = turn_deg(trace.orientation_xyzw[:-1], trace.orientation_xyzw[1:])
    assert (turns <= 45.0 + 1e-9).all()


@QUICK
@given(hardware_profiles(noise=False))
def test_machines_without_noise_have_none(machine: HardwareProfile) -> None:
    """True costs are what is drawn, in every frame."""
    assert machine.gpu_residual.kind == machine.cpu_residual.kind == "none"


@QUICK
@given(views(), st.sampled_from(("full", "static-screen", "feedback", "wimmer")))
def test_policies_can_select_of_a_view(view: View, name: str) -> None:
    """A view has all that a policy asks for, and what it selects of it is valid."""
    policy = parse_policy(name).make()
    policy.reset(view.scene, 5.0)
    assert find_violation(policy.select(view), view.ids, view.scene) is None


@pytest.mark.slow
def test_examples_shrink_to_the_simplest() -> None:
    """The smallest scene is one object, the smallest trace stands, and a machine is plain."""
    scene = find(scenes(), lambda _: True, settings=QUICK)
    assert len(scene) == len(scene.types.names) == len(scene.types.levels.error_m) == 1
    assert len(find(scenes(), lambda s: len(s) >= 3, settings=QUICK)) == 3
    assert len(find(traces(), lambda _: True, settings=QUICK)) == 1
    moved = find(traces(), lambda t: bool(t.position_m[-1, 0] >= 1.0), settings=QUICK)
    assert (moved.position_m[:, 1] == 0.0).all()
    machine = find(hardware_profiles(), lambda _: True, settings=QUICK)
    assert (machine.display.mode, machine.gpu_residual.kind) == ("immediate", "none")


def test_public_names_are_there() -> None:
    """Every name in ``__all__`` can be had, and is sorted by ruff's rule."""
    for name in lodbench.testing.__all__:
        assert getattr(lodbench.testing, name) is not None
