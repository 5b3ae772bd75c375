"""Every bundled scene under every policy that fits it, on the paths of its paper."""

import numpy as np
import pytest

from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.inputs import load_trace
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.scene_catalog import list_bundled_scenes, load_scene
from lodbench.policies.registry import default_policies, parse_policy
from lodbench.sim.replay import ReplayOptions

PATHS = ("walk", "drive", "fly-over", "sudden-turn")


@pytest.mark.slow
@pytest.mark.parametrize("name", list_bundled_scenes())
def test_compare_runs(name: str) -> None:
    """No policy fails, most of one kind fit, and something is drawn on a walk."""
    scene = load_scene(name)
    for path in PATHS if name in ("city", "soda-hall") else PATHS[:1]:
        compared = compare(
            [parse_policy(text) for text in default_policies()],
            scene,
            [load_trace(path, scene).stretch(0.0, 0.6)],
            load_hardware("desktop-assumed"),
            ReplayOptions(budget_ms=16.7),
            CompareSettings(warmup_s=0.05, workers=1, as_shipped=True, seeds=1, draws=0),
        )
        comparison, logs = compared.comparison, compared.logs
        failed = [
            (item.name, item.reason) for item in comparison.policies if item.status == "failed"
        ]
        assert failed == []
        fit = [item.name for item in comparison.policies if item.status == "ok"]
        assert len(fit) >= (4 if not scene.flat else 15)
        assert len(logs) == len(fit)
        if path == "walk":  # others may look away from all there is
            assert max(float(log["drawn"].max()) for log in logs.values()) > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("name", list_bundled_scenes())
def test_paths_are_finite_and_apart(name: str) -> None:
    """The four paths of each scene are four different ones that stay within 1e6 m."""
    scene = load_scene(name)
    traces = [load_trace(path, scene) for path in PATHS]
    for trace in traces:
        assert np.isfinite(trace.position_m).all()
        assert np.abs(trace.position_m).max() < 1e6
    ends = {tuple(trace.position_m[-1].round(3).tolist()) for trace in traces}
    assert len(ends) == 4
