"""Compare policies: bring each to the same budget, judge all on the same paths, reach a verdict."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...base.content_hash import content_hash
from ...base.errors import InputError, require_real, require_whole
from ...models.machine.hardware import HardwareProfile
from ...models.scene.content import require_content
from ...models.scene.scene import Scene
from ...policies.knob import Knob, declared_knob
from ...policies.policy_spec import PolicySpec
from ...policies.registry import default_policies, require_distinct
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from ...traces.cameras.vary import vary
from ..metrics.measured_frames import require_window
from ..verdict.verdict import Terms, reach_verdict
from .code_hash import package_hash, policy_hash
from .compare_record import make_comparison, make_sampling
from .comparison_folder import Compared
from .engine.limits import DEFAULT_LIMITS, Limits
from .engine.open_engine import open_engine
from .judging import Judging
from .moment_pictures import Meshes, draw_moments, has_one_camera, pictured
from .replays import Bench, Place, Replays, make_bench
from .runs import Progress, choose_draws
from .tuning import Rotation, rotate, tune

if TYPE_CHECKING:
    from .comparison_target import ComparisonTarget

DEFAULT_SCENE, DEFAULT_TRACE, DEFAULT_PATHS = "district", "trial", 10
QUICK_PATHS, QUICK_LENGTH_S = 4, 6.0
"""What a quick comparison has of the default paths."""

AS_SHIPPED = ("static-distance:scale=1", "static-screen:bias=1")
"""Ladders at the values they ship with, beside those that are tuned."""

VARIATIONS = 8
"""Variations of a single path on which knobs are tuned."""
_SEEDS, _SEEDS_OF_ONE_PATH = 2, 5


@dataclass(frozen=True, slots=True, kw_only=True)
class CompareSettings:
    """How to compare.

    Attributes
    ----------
    warmup_s : float
        Seconds at the start of each path that no metric counts.
    miss : float
        Share of time for which a policy may exceed the budget and still keep it.
    margin : float
        Part of the best's value within which another is as good.
    as_shipped : bool
        Whether no policy is tuned.
    seeds : int or None
        Replays of each path under other noise; None for 2, or 5 of a single path.
    draws : int
        Draws of the machine to replay, if the profile has them.
    workers : int
        Processes; 0 for as many as there are processors.  Results do not depend on it.
    policy_limits : Limits
        What a policy may take.
    scheduler : str or None
        Address of a Dask scheduler in place of processes here.
    command : str
        What the provenance says of how to get the result again.
    """

    warmup_s: float = 1.0
    miss: float = 0.01
    margin: float = 0.1
    as_shipped: bool = False
    seeds: int | None = None
    draws: int = 8
    workers: int = 0
    policy_limits: Limits = DEFAULT_LIMITS
    scheduler: str | None = None
    command: str = ""

    def __post_init__(self) -> None:
        require_whole(self.draws, "draws", 0)
        require_whole(self.workers, "workers", 0)
        if self.seeds is not None:
            require_whole(self.seeds, "seeds", 1)
        for name, most in (("miss", 0.5), ("margin", 10.0)):
            value = getattr(self, name)
            require_real(value, name)
            if not 0.0 <= value <= most:
                raise InputError(f"{name}: expected a share from 0 to {most:g}, got {value}")


def compare(
    policies: Sequence[PolicySpec],
    scene: Scene,
    paths: Sequence[CameraTrace],
    hardware: HardwareProfile,
    replay_options: ReplayOptions,
    settings: CompareSettings | None = None,
    *,
    progress: Progress | None = None,
    target: "ComparisonTarget | None" = None,
    meshes: Meshes | None = None,
) -> Compared:
    """Tune, replay and judge policies on paths, and return the comparison with its runs.

    A policy that breaks its contract is reported as failed, and the others are finished.

    Parameters
    ----------
    target
        Where the comparison is to be written.  Runs are kept beside it as they are done; if it
        holds this very comparison, that is returned.
    meshes
        By which worst moments are drawn; without them there are no pictures.

    Raises `InputError` if a policy or path is given twice, parameters are refused, or all of a path
    would be warm-up.
    """
    settings = settings or CompareSettings()
    require_distinct(policies)
    for policy in policies:
        policy.check_parameters()
    require_paths(paths, settings.warmup_s)
    knobs = {} if settings.as_shipped else find_knobs(policies)
    require_content(scene)
    bench, rotation = _bench(policies, scene, paths, hardware, replay_options, settings, knobs)
    study = _study_hash(bench, settings)
    if target is not None and (earlier := target.begin(study)) is not None:
        return earlier
    engine = open_engine(
        bench.inputs,
        workers=settings.workers,
        limits=settings.policy_limits,
        scheduler=settings.scheduler,
    )
    single = len(paths) == 1
    seeds = settings.seeds or (_SEEDS_OF_ONE_PATH if single else _SEEDS)
    first = replay_options.seed
    draws = choose_draws(hardware, settings.draws)
    judging = Judging(bench, rotation, tuple(range(first, first + seeds)), tuple(draws))
    with engine:
        work = None if target is None else target.work
        replays = Replays(bench, engine, progress, work, settings.policy_limits)
        replays.make(judging.as_given())
        tuned = tune(replays, rotation, replay_options.budget_ms, first)
        replays.make(places := judging.places(tuned))
        terms = Terms(
            budget_ms=replay_options.budget_ms,
            margin=settings.margin,
            population="this path" if single else "such paths",
            paths=tuple(path.name for path in paths),
            seed=first,
        )
        verdict = reach_verdict(
            judging.outcome(replays, tuned),
            judging.unscored(replays),
            judging.curves(replays, tuned),
            terms,
        )
        worst: dict[str, Place] = {}
        if meshes is not None and has_one_camera(paths, replay_options):
            labels = pictured(verdict.policies)
            worst = {label: judging.worst(replays, label, tuned) for label in labels}
            replays.make(worst.values())
    sampling = make_sampling(len(paths), seeds, len(draws), knobs, VARIATIONS)
    comparison = make_comparison(
        verdict,
        bench,
        scene,
        paths,
        hardware,
        sampling,
        population=terms.population,
        margin=settings.margin,
        command=settings.command,
    )
    judged = set(places)
    logs = {
        place.policy: log
        for place in replays
        if place.logged and place in judged and (log := replays[place].log) is not None
    }
    pictures: dict[str, bytes] = {}
    if meshes is not None:
        pictures = draw_moments(comparison, replays, worst.values(), scene, meshes)
    return Compared(comparison, logs, replays.to_table(judged), scene, pictures)


def compared_policies() -> tuple[str, ...]:
    """Return the policies of a comparison that names none."""
    return (*default_policies(), *AS_SHIPPED)


def require_paths(paths: Sequence[CameraTrace], warmup_s: float) -> None:
    """Raise `InputError` if there is no path, one has another's name, or is all warm-up."""
    if not paths:
        raise InputError("trace: expected a path or more, got none; name one")
    names = [path.name for path in paths]
    for path in paths:
        if names.count(path.name) > 1:
            raise InputError(f"trace: expected each once, got {path.name} twice; name it once")
        require_window(warmup_s, path.duration_s)


def find_knobs(policies: Iterable[PolicySpec]) -> dict[str, Knob]:
    """Return the knobs of the policies that are to be tuned: those named bare, by label."""
    found: dict[str, Knob] = {}
    for spec in policies:
        bare = not spec.params and spec.made is None
        if bare and (knob := declared_knob(spec)) is not None:
            found[spec.label] = knob
    return found


def _bench(
    policies: Sequence[PolicySpec],
    scene: Scene,
    paths: Sequence[CameraTrace],
    hardware: HardwareProfile,
    options: ReplayOptions,
    settings: CompareSettings,
    knobs: dict[str, Knob],
) -> tuple[Bench, Rotation]:
    """Return what all replays share; variations of a single path stand behind it."""
    every = list(paths)
    if len(paths) == 1 and knobs:
        every += [vary(paths[0], options.seed + 1 + number) for number in range(VARIATIONS)]
    bench = make_bench(
        policies,
        scene,
        every,
        hardware,
        options,
        settings.warmup_s,
        knobs=knobs,
        miss=settings.miss,
    )
    return bench, rotate(len(paths), len(every) - len(paths))


def _study_hash(bench: Bench, settings: CompareSettings) -> str | None:
    """Return the hash of all that a comparison depends on, None if a policy has no content."""
    try:
        policies = [policy_hash(spec) for spec in bench.specs.values()]
    except TypeError:
        return None
    matters = replace(settings, workers=0, scheduler=None, policy_limits=DEFAULT_LIMITS)
    named = (bench.scene, bench.hardware, list(bench.paths), repr(bench.options), repr(matters))
    return content_hash(package_hash(), policies, settings.policy_limits, *named)
