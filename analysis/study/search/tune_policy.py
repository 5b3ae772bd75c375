"""Better parameters of a policy: searched on some paths, confirmed on others.

The best of many trials looks better than it is on the paths that chose it.  What is told as gain
is measured on paths that took no part in the choice, on the same ones with the shipped parameters,
each side brought to the budget by its knob.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ....base.errors import InputError, PolicyError, require_whole
from ....models.machine.hardware import HardwareProfile
from ....models.scene.scene import Scene
from ....policies.knob import Knob, declared_knob
from ....policies.policy_spec import PolicySpec, is_oracle
from ....policies.registry import policy_text
from ....sim.replay import ReplayOptions
from ....traces.cameras.camera_trace import CameraTrace
from ...verdict.answer import ORDER
from ...verdict.judged import Judged
from ...verdict.keeping import p_keeps
from ...verdict.scores import LEVEL
from ...verdict.warnings import find_warnings
from ..compare import CompareSettings, require_paths
from ..compare_record import make_provenance
from ..comparison_parts import Sampling
from ..engine.open_engine import open_engine
from ..engine.task import Failure
from ..replays import Bench, Replays, make_bench
from ..runs import Progress
from .confirmation import SEEDS, answer, confirm, find_gains, is_better
from .drawn_paths import Paths
from .halving import Tried, halve, refused
from .space import find_axes, scatter
from .tuning_record import Side, Trial, Tuning

TRIALS = 24
"""Choices of parameters that are tried, beside the shipped one."""


def tune_policy(
    spec: PolicySpec,
    over: Sequence[str],
    scene: Scene,
    paths: Paths,
    hardware: HardwareProfile,
    options: ReplayOptions,
    settings: CompareSettings | None = None,
    *,
    trials: int = TRIALS,
    progress: Progress | None = None,
) -> Tuning:
    """Search parameters of a policy for the verdict's order; return what was found, and its gain.

    Raises `InputError` if a parameter cannot be searched, the policy does not fit the scene, or
    there are too few paths; `PolicyError` if the policy breaks its contract as shipped.

    Parameters
    ----------
    over
        Parameters, each ``name`` or ``name=low:high``; none for all that have a range.
    settings
        Of them `seeds`, `draws` and `as_shipped` do not matter here.
    """
    settings = settings or CompareSettings()
    require_whole(trials, "trials", 1)
    _require_tunable(spec, paths, settings)
    knob = declared_knob(spec)
    axes = find_axes(spec, over, None if knob is None else knob.name)
    specs = scatter(spec, axes, trials, options.seed)
    bench = _bench(specs, scene, (*paths.judged, *paths.training), hardware, options, settings)
    engine = open_engine(
        bench.inputs,
        workers=settings.workers,
        limits=settings.policy_limits,
        scheduler=settings.scheduler,
    )
    with engine:
        replays = Replays(bench, engine, progress, limits=settings.policy_limits)
        searched = _search(replays, spec.label, paths, settings.margin)
    shipped, found = searched.sides[spec.label], searched.sides.get(searched.best)
    found = None if searched.best == spec.label else found
    judged = searched.judged
    gain = () if found is None else find_gains(judged[spec.label], judged[found.label])
    better = found is not None and is_better(shipped, found, judged)
    winner = found if found is not None and better else shipped
    judged_names = tuple(path.name for path in paths.judged)
    return Tuning(
        policy=spec.label,
        scene=scene.name,
        hardware=hardware.name,
        budget_ms=options.budget_ms,
        miss=settings.miss,
        visible_px=options.visible_px,
        margin=settings.margin,
        seed=options.seed,
        over=axes,
        trials=tuple(_trial(one, searched, options.budget_ms) for one in specs),
        training=tuple(path.name for path in paths.training),
        judged=judged_names,
        sampling=Sampling(
            LEVEL, SEEDS, 0, "knobs were tuned on other paths than they are judged on"
        ),
        warnings=find_warnings(
            judged_names,
            [seeds[0].footing for seeds in judged[spec.label].runs],
            options.budget_ms,
            [shipped.rank is not None],
        ),
        shipped=shipped,
        found=found,
        gain=gain,
        better=better,
        answer=answer(shipped, found, gain, better=better),
        policy_line=policy_text(spec.name, winner.params),
        provenance=make_provenance(bench, settings.margin, settings.command),
    )


@dataclass(frozen=True, slots=True)
class _Searched:
    """What became of all trials.

    Attributes
    ----------
    best : str
        Label of the best on training paths.
    tried : dict of str to Tried
        By label, of those with scores.
    refused, failures : dict
        By label, of the others.
    sides : dict of str to Side
        The policy as shipped and the best, on the paths that judge, unless it failed there.
    judged : dict of str to Judged
        Their runs.
    """

    best: str
    tried: Mapping[str, Tried]
    refused: Mapping[str, str]
    failures: Mapping[str, Failure]
    sides: Mapping[str, Side]
    judged: Mapping[str, Judged]


def _search(replays: Replays, shipped: str, paths: Paths, margin: float) -> _Searched:
    """Search on the training paths, which stand behind those that judge, and judge the best."""
    count = len(paths.judged)
    training = range(count, count + len(paths.training))
    reasons = refused(replays, shipped, training[0], replays.bench.options.seed)
    tried, best = halve(replays, shipped, training, margin)
    _require_scored(replays, shipped)
    failures = replays.failures
    replays.narrow({shipped, best})
    verdict, judged = confirm(replays, [path.name for path in paths.judged], margin)
    _require_scored(replays, shipped)
    sides = {one.label: Side.of(one) for one in verdict.policies if one.label in judged}
    return _Searched(best, tried, reasons, failures | replays.failures, sides, judged)


def _require_tunable(spec: PolicySpec, paths: Paths, settings: CompareSettings) -> None:
    """Raise `InputError` if the policy is an oracle, or the paths are too few or too short."""
    if is_oracle(spec):
        raise InputError(f"tune {spec.name}: expected a policy, got an oracle; name another")
    require_paths((*paths.judged, *paths.training), settings.warmup_s)
    for few in (paths.training, paths.judged):
        if len(few) < 2:
            raise InputError(f"paths: expected 2 or more, got {len(few)}; ask for more")


def _bench(
    specs: Sequence[PolicySpec],
    scene: Scene,
    paths: Sequence[CameraTrace],
    hardware: HardwareProfile,
    options: ReplayOptions,
    settings: CompareSettings,
) -> Bench:
    """Return what all replays share; a knob may depend on the parameters that are tried."""
    knobs: dict[str, Knob] = {}
    for spec in specs:
        if (knob := declared_knob(spec)) is not None:
            knobs[spec.label] = knob
    return make_bench(
        specs,
        scene,
        paths,
        hardware,
        options,
        settings.warmup_s,
        knobs=knobs,
        miss=settings.miss,
    )


def _require_scored(replays: Replays, label: str) -> None:
    """Raise what became of the policy as shipped, if that is no score."""
    failure = replays.failures.get(label)
    if failure is None:
        return
    if failure.kind == "not-applicable":
        raise InputError(f"policy {label}: {failure.reason}; name another policy or scene")
    raise PolicyError(label, failure.frame, failure.reason)


def _trial(spec: PolicySpec, searched: _Searched, budget_ms: float) -> Trial:
    """Return the record of a trial."""
    label = spec.label
    if label in searched.refused:
        return Trial(label, spec.params, "refused", searched.refused[label])
    if (failure := searched.failures.get(label)) is not None:
        return Trial(label, spec.params, failure.kind, str(failure))
    judged = searched.tried[label].judged
    _, error, pops, _, work = (_mean(judged, name) for name in ORDER)
    return Trial(
        label=label,
        params=spec.params,
        status="ok",
        paths=searched.tried[label].paths,
        keeps=p_keeps(judged.point_ms, budget_ms),
        knob=judged.knob,
        visible_error_px=error,
        visible_pops_per_s=pops,
        work_ms_mean=work,
    )


def _mean(judged: Judged, metric: str) -> float | None:
    values = judged.values(metric)
    return None if np.isnan(values).all() else float(np.nanmean(values))
