"""What a verdict says of policies is held against what they do on 200 paths that it has not seen.

A pool of paths is replayed once at every value of every knob.  A study draws its ten paths from it,
reaches the verdict on policies that are tuned on them and on others as typed, and the rest of the
pool answers how often each keeps the budget, and who comes first in the order.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest

from lodbench.analysis.study.comparison_parts import KnobSetting
from lodbench.analysis.study.engine.open_engine import open_engine
from lodbench.analysis.study.paths import load_paths
from lodbench.analysis.study.replays import Place, Replays, make_bench
from lodbench.analysis.study.score import Scored
from lodbench.analysis.study.tuning import rotate
from lodbench.analysis.verdict.criterion import beyond_margin
from lodbench.analysis.verdict.judged import Judged
from lodbench.analysis.verdict.operating_point import operating_point
from lodbench.analysis.verdict.verdict import Terms, order_criteria, reach_verdict
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.policies.knob import declared_knob
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions

LENGTH_S, N = 3.0, 10
BUDGETS_MS = {"walk": 8.0, "trial": 16.0}
KNOBS = {
    "static-screen": np.geomspace(0.2, 1.4, 8),
    "screen-space-error": np.geomspace(12.0, 2.0, 8),
    "feedback": np.linspace(0.6, 1.0, 6),
    "gobbetti": np.linspace(0.7, 1.2, 6),
}
"""From coarse to fine, about where policies begin to miss the budgets."""
BINS = ((0.5, 0.7), (0.7, 0.9), (0.9, 1.01))


@dataclass(frozen=True)
class Rival:
    """A policy in one study: as it was judged there, and its replays on all paths of the pool."""

    judged: Judged
    everywhere: Sequence[Scored]


def replay_pool(kind: str, count: int, policies: Sequence[str]) -> dict[str, list[list[Scored]]]:
    """Return by policy what it does at each value of its knob, on each path of a pool."""
    scene, hardware = load_scene("district"), load_hardware("desktop-assumed")
    paths = load_paths([kind], scene, paths=count, length_s=LENGTH_S, seed=5)
    specs = [parse_policy(name) for name in policies]
    knobs = {spec.label: knob for spec in specs if (knob := declared_knob(spec)) is not None}
    options = ReplayOptions(budget_ms=BUDGETS_MS[kind])
    bench = make_bench(specs, scene, paths, hardware, options, 0.5, knobs=knobs)
    places = {
        name: [[Place(name, path, 0, float(at)) for path in range(count)] for at in KNOBS[name]]
        for name in policies
    }
    with open_engine(bench.inputs) as engine:
        replays = Replays(bench, engine)
        replays.make(place for rows in places.values() for row in rows for place in row)
    assert not replays.failures
    return {name: [[replays[at] for at in row] for row in rows] for name, rows in places.items()}


def rivals_of(
    rng: np.random.Generator,
    pool: dict[str, list[list[Scored]]],
    chosen: Sequence[int],
    budget_ms: float,
) -> list[Rival]:
    """Return a random part of: every policy tuned on the chosen paths, and twice as typed.

    A part, so that the leader is not the same in all studies, and some are near equals.
    """
    found: list[Rival] = []
    sets = rotate(len(chosen), 0).sets
    for name, rows in pool.items():
        p99_ms = np.array([[row[path].judged_ms for path in chosen] for row in rows])
        values = KNOBS[name]
        point = operating_point(values, p99_ms, budget_ms).index
        at = [operating_point(values, p99_ms[:, list(of)], budget_ms).index for of in sets]
        typed = rng.choice(len(rows), 2, replace=False).tolist()
        settings = [(name, point, at)]
        settings += [(f"{name} {values[k]:.3g}", k, [k] * len(chosen)) for k in typed]
        knob = KnobSetting("knob", float(values[point]), tuned=True)
        for label, k, by_path in settings:
            judged = Judged(
                spec=replace(parse_policy(name), label=label),
                label=label,
                oracle=False,
                knob=knob if label == name else None,
                runs=tuple((rows[j][path],) for j, path in zip(by_path, chosen, strict=True)),
                drawn=(),
                point_ms=p99_ms[k],
            )
            found.append(Rival(judged, rows[k]))
    part = rng.permutation(len(found))[: int(rng.integers(2, len(found) + 1))]
    return [found[i] for i in sorted(part.tolist())]


def first_in_truth(rivals: Sequence[Rival], labels: Sequence[str], fresh: Sequence[int]) -> str:
    """Return who comes first in the order on the paths that the study has not seen."""
    left = [
        replace(rival.judged, runs=tuple((rival.everywhere[path],) for path in fresh))
        for rival in rivals
        if rival.judged.label in labels
    ]
    criteria = order_criteria(left, 0.1)
    stays = np.ones(len(left), dtype=np.bool_)
    for criterion in criteria:
        means = criterion.turned().mean(axis=1)
        best = np.where(stays, means, np.inf).min()
        within = beyond_margin(means, best, criterion) <= 0
        stays &= means == best if criterion is criteria[-1] else within
    return left[int(stays.argmax())].label


def studies(kind: str, count: int, number: int, policies: Sequence[str]) -> np.ndarray:
    """Return rows of what (0 keeps, 1 best), said, the share that was true, and of which study."""
    rng = np.random.default_rng(17)
    pool = replay_pool(kind, count, policies)
    rows: list[tuple[float, float, float, float]] = []
    for study in range(number):
        order: list[int] = rng.permutation(count).tolist()
        chosen, fresh = order[:N], order[N:]
        # What replays took is held to other budgets, so that no few knobs decide a bin.
        budget_ms = BUDGETS_MS[kind] * float(np.exp(rng.uniform(-0.15, 0.15)))
        rivals = rivals_of(rng, pool, chosen, budget_ms)
        terms = Terms(budget_ms, 0.1, "such paths", tuple(map(str, chosen)), study)
        verdict = reach_verdict([rival.judged for rival in rivals], [], {}, terms)
        everywhere: dict[str, Sequence[Scored]] = {
            rival.judged.label: rival.everywhere for rival in rivals
        }
        for policy in verdict.policies:
            keeps = policy.keeps_budget
            assert keeps is not None
            assert keeps.probability is not None
            took_ms = np.array([everywhere[policy.label][path].judged_ms for path in fresh])
            rows.append((0.0, keeps.probability, float((took_ms <= budget_ms).mean()), study))
        said = verdict.order.p_best
        if said:
            first = max(said, key=said.__getitem__)
            true = first_in_truth(rivals, list(said), fresh)
            rows.append((1.0, said[first], float(first == true), study))
    return np.array(rows)


@pytest.mark.study
@pytest.mark.slow
def test_what_a_verdict_says_is_true_as_often(*, full_studies: bool) -> None:
    """P(keeps) and P(best) agree with fresh paths in each bin, and are nowhere too sure.

    Whole, a bin of 30 verdicts or more is within three binomial standard errors, and none says 5
    points more than is true.  What one verdict says of several policies is of the same ten paths,
    so verdicts are counted.  A pool of few paths is of a kind of its own: its bins stand further
    off.
    """
    kinds = tuple(BUDGETS_MS) if full_studies else ("walk",)
    policies = tuple(KNOBS) if full_studies else ("static-screen", "feedback")
    size = (230, 400) if full_studies else (30, 60)
    found = [studies(kind, *size, policies) for kind in kinds]
    for kind, rows in zip(kinds, found, strict=True):
        print_bins(kind, rows)
    for at, rows in enumerate(found):
        rows[:, 3] += at * size[1]
    for said, true, verdicts in print_bins("all", np.concatenate(found)):
        if verdicts < 30:
            continue
        error = float(np.sqrt(said * (1.0 - said) / verdicts))
        assert said - true < (0.05 if full_studies else 0.2)
        assert abs(said - true) < (3.0 * error if full_studies else 0.3)


def print_bins(kind: str, rows: np.ndarray) -> list[tuple[float, float, int]]:
    """Print, and return of each bin, the mean said, the share true, and how many verdicts said."""
    found: list[tuple[float, float, int]] = []
    for what, name in enumerate(("P(keeps)", "P(best)")):
        for low, high in BINS:
            inside = rows[(rows[:, 0] == what) & (rows[:, 1] >= low) & (rows[:, 1] < high)]
            if not len(inside):
                continue
            said, true = float(inside[:, 1].mean()), float(inside[:, 2].mean())
            verdicts = len(np.unique(inside[:, 3]))
            found.append((said, true, verdicts))
            ends = f"{low:g} to {min(high, 1.0):g}"
            print(f"| {kind} | {name} | {ends} | {verdicts} | {said:.3f} | {true:.3f} |")
    return found
