"""Tuned policies keep paths that they are judged on apart: in rocks, in a city, in real meshes."""

from pathlib import Path

import numpy as np
import pytest

from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.comparison import Comparison
from lodbench.analysis.study.comparison_parts import knob_text
from lodbench.analysis.study.paths import load_paths
from lodbench.models.layouts.scene_builder import PlacementOptions, build_scene
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.meshes.authored_levels import group_levels
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.mesh_types import MeshUnits, read_types
from lodbench.models.meshes.simplify import ChainOptions
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions

FLAT = ("static-screen", "cluster-cut", "feedback", "funkhouser", "gobbetti", "wimmer")
TREES = (
    *("screen-space-error", "cluster-cut", "hlod-hysteresis", "mason-blake", "maciel", "erikson"),
)
MESHES = ("spot.obj", "cow.obj", "homer.obj", "rocker-arm.obj")
BUDGETS_MS = {"meshes": 5.0, "plaza": 8.0, "city": 10.0}
"""Full detail takes four to nine times as long; the coarsest, two thirds."""


def make_scene(name: str, folder: Path) -> Scene:
    """Return a bundled scene, or 900 objects of four real meshes."""
    if name != "meshes":
        return load_scene(name)
    files = [folder / "meshes" / mesh for mesh in MESHES]
    models = list(read_types(group_levels(files), MeshUnits(), ChainOptions(), Sampling()))
    return build_scene(name, models, PlacementOptions(count=900), np.random.default_rng(0))[0]


def compared(name: str, scene: Scene, policies: tuple[str, ...], paths: int) -> Comparison:
    """Return the comparison of tuned policies, each judged on paths that it was not tuned on."""
    return compare(
        [parse_policy(policy) for policy in policies],
        scene,
        load_paths(["trial"], scene, paths=paths, length_s=6.0, seed=2),
        load_hardware("desktop-assumed"),
        ReplayOptions(budget_ms=BUDGETS_MS[name]),
        CompareSettings(seeds=1, draws=0),
    ).comparison


@pytest.mark.study
@pytest.mark.slow
def test_tuned_policies_keep_paths_judged_apart(data_dir: Path, *, full_studies: bool) -> None:
    """At least 85 % of path × policy keep the budget, of policies at P(keeps) of .9 or more."""
    kept = judged = 0
    for name in BUDGETS_MS if full_studies else ("meshes",):
        policies = TREES if name == "city" else FLAT
        scene, paths = make_scene(name, data_dir), 10
        if not full_studies:
            policies, paths = policies[:3], 5
        found = compared(name, scene, policies, paths)
        assert not found.failed
        full_ms = max(moment.work_ms for moment in found.worst_moments.values())
        print(f"{name}, {found.budget_ms:g} ms, {paths} paths, most work {full_ms:.1f} ms")
        for policy in found.ok:
            keeps, knob = policy.keeps_budget, policy.knob
            assert keeps is not None
            assert keeps.probability is not None
            area = found.curve[policy.label].area_pct
            print(
                f"| {name} | {policy.label} | {knob_text(policy)} | {keeps.probability:.2f} "
                f"| {keeps.kept} of {keeps.paths} | {policy.value_of('visible_error_px'):.2f} "
                f"| {'–' if area is None else f'{area:+.0f} %'} |"
            )
            curve = found.curve[policy.label]
            for at, work_ms, error in zip(
                curve.knob, curve.work_ms, curve.visible_error_px, strict=True
            ):
                print(f"    {knob.name if knob else ''} {at:.4g}: {work_ms:.2f} ms, {error:.2f} px")
            if keeps.probability >= 0.9:
                kept, judged = kept + keeps.kept, judged + keeps.paths
    print(f"kept {kept} of {judged}, {kept / judged:.3f}")
    assert kept >= 0.85 * judged
