"""Two policies that are equal but for chance are seldom put into different ranks."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from lodbench.analysis.study.inputs import adjust_machine
from lodbench.analysis.study.paths import load_paths
from lodbench.analysis.study.replays import noise_seed
from lodbench.analysis.study.score import Scored, World, score
from lodbench.analysis.verdict.judged import Judged
from lodbench.analysis.verdict.ranking import ranking
from lodbench.analysis.verdict.verdict import order_criteria
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.policies.policy_spec import PolicySpec
from lodbench.policies.registry import specs_of
from lodbench.policies.selection import Selection
from lodbench.policies.thresholds.static_screen import StaticScreen
from lodbench.policies.view import View
from lodbench.sim.replay import ReplayOptions

BIAS, BUDGET_MS, LENGTH_S, N, STUDIES = 0.4, 60.0, 5.0, 10, 200


class Dithered(StaticScreen):
    """Its bias is off by up to 1 % each frame, by a stream of its own."""

    def __init__(self, stream: int) -> None:
        super().__init__(bias=BIAS)
        self.stream = stream

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Begin the stream."""
        super().reset(scene, budget_ms)
        self._rng = np.random.default_rng((self.stream, 1))

    def select(self, view: View) -> Selection:
        """Turn the knob a little."""
        return self.select_biased(view, self.bias * self._rng.uniform(0.99, 1.01))


def replay_pool(kind: str, count: int) -> dict[str, list[Scored]]:
    """Return the plain policy and its twin on the same paths, under the same noise of llvmpipe."""
    scene = load_scene("district")
    hardware = adjust_machine(load_hardware("llvmpipe"), "vsync", 60.0, None)
    found: dict[str, list[Scored]] = {"plain": [], "twin": []}
    for at, path in enumerate(load_paths([kind], scene, paths=count, length_s=LENGTH_S, seed=8)):
        options = ReplayOptions(budget_ms=BUDGET_MS, seed=noise_seed(1, at))
        world = World(scene, path, hardware, options, 1.0)
        for name, policy in (("plain", StaticScreen(bias=BIAS)), ("twin", Dithered(at))):
            (spec,) = specs_of({name: policy})
            found[name].append(score(world, spec, keeps_log=False, beat=lambda _: None))
    return found


def judged(spec: PolicySpec, runs: Sequence[Scored]) -> Judged:
    """Return a policy as it was judged on paths, once each."""
    return Judged(
        spec=spec,
        label=spec.label,
        oracle=False,
        knob=None,
        runs=tuple((run,) for run in runs),
        drawn=(),
        point_ms=np.array([run.judged_ms for run in runs]),
    )


@pytest.mark.study
@pytest.mark.slow
def test_twins_share_a_rank(*, full_studies: bool) -> None:
    """In at most 5 % of studies of ten paths each, one twin is put behind the other."""
    (plain,) = specs_of({"plain": StaticScreen(bias=BIAS)})
    rng = np.random.default_rng(11)
    for kind in ("walk", "drive") if full_studies else ("walk",):
        pool = replay_pool(kind, 100 if full_studies else 14)
        apart = 0
        for _ in range(STUDIES):
            chosen: list[int] = rng.permutation(len(pool["plain"]))[:N].tolist()
            pair = [
                judged(replace(plain, label=name), [runs[path] for path in chosen])
                for name, runs in pool.items()
            ]
            labels = [one.label for one in pair]
            apart += len(ranking(labels, order_criteria(pair, 0.1))) > 1
        print(f"{kind}: twins in different ranks in {apart} of {STUDIES} studies")
        assert apart <= 0.05 * STUDIES
