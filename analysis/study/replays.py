"""Replays of policies by where they stand: each is made once, whoever asks for it.

A comparison asks in rounds, since which values of a knob are worth a replay is known only from the
replays before.  Folds, curves and areas then share them.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ...base.content_hash import content_hash
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...policies.knob import Knob
from ...policies.policy_spec import PolicySpec
from ...policies.registry import vary_policy
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from .engine.limits import DEFAULT_LIMITS, Limits
from .engine.task import Engine, Failure
from .results.run_list import RunList
from .run import Run
from .runs import Progress
from .score import MISS, Scored

if TYPE_CHECKING:  # they need Arrow, which a study without a folder does not
    import pyarrow as pa

    from .results.record import AxisValue
    from .results.work_folder import WorkFolder


_SEEDS_OF_A_PATH = 1_000_000


def noise_seed(seed: int, path: int) -> int:
    """Return the seed of the noise of a replay on the path of a position.

    No two paths share one: under the same noise their means would err together, and intervals over
    paths, or over seeds on several paths, would be too narrow by up to the root of their number.
    """
    return seed + _SEEDS_OF_A_PATH * path


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """Where a replay stands among those of a comparison.

    Attributes
    ----------
    policy : str
        Label of the policy as it was given.
    path : int
        Position of the path.
    seed : int
        Of the replays on this path, see `noise_seed`.
    knob : float or None
        Value of the policy's knob; None for its own parameters.
    draw : int or None
        Draw of the machine; None for its mean.
    logged : bool
        Whether its frame log is wanted, with the level of each node over time.
    """

    policy: str
    path: int
    seed: int
    knob: float | None = None
    draw: int | None = None
    logged: bool = False


@dataclass(frozen=True, slots=True)
class Bench:
    """What all replays of a comparison share.

    Attributes
    ----------
    inputs : dict of str to object
        Scene, paths and hardware by content hash.
    scene, hardware : str
        Content hashes.
    paths : tuple of str
        Content hashes, by position.
    specs : dict of str to PolicySpec
        By label.
    knobs : dict of str to Knob
        By label, of the policies that have one.
    options : ReplayOptions
        But for seed and draw.
    warmup_s : float
        Seconds at the start of each path that do not count.
    miss : float
        Share of time for which a policy may exceed the budget and still keep it.
    """

    inputs: Mapping[str, Any]
    scene: str
    hardware: str
    paths: tuple[str, ...]
    specs: Mapping[str, PolicySpec]
    knobs: Mapping[str, Knob]
    options: ReplayOptions
    warmup_s: float
    miss: float

    def run_at(self, place: Place) -> Run:
        """Return the run at a place.

        Its policy has the label as given at every value of the knob: it is one policy, whose
        replays may share a process and which fails as a whole.
        """
        spec = self.specs[place.policy]
        if place.knob is not None:
            varied = vary_policy(spec, {self.knobs[place.policy].name: place.knob})
            spec = replace(varied, label=spec.label)
        seed = noise_seed(place.seed, place.path)
        options = replace(self.options, seed=seed, draw=place.draw)
        return Run(
            spec,
            self.scene,
            self.paths[place.path],
            self.hardware,
            options,
            self.warmup_s,
            self.miss,
            keeps_log=place.logged,
            keeps_levels=place.logged,
        )


def make_bench(
    policies: Sequence[PolicySpec],
    scene: Scene,
    paths: Sequence[CameraTrace],
    hardware: HardwareProfile,
    options: ReplayOptions,
    warmup_s: float,
    *,
    knobs: Mapping[str, Knob] | None = None,
    miss: float = MISS,
) -> Bench:
    """Return what replays of these policies on these paths share; without knobs none is turned."""
    hashes = tuple(content_hash(path) for path in paths)
    scene_hash, hardware_hash = content_hash(scene), content_hash(hardware)
    shared = {scene_hash: scene, hardware_hash: hardware}
    return Bench(
        inputs=shared | dict(zip(hashes, paths, strict=True)),
        scene=scene_hash,
        hardware=hardware_hash,
        paths=hashes,
        specs={spec.label: spec for spec in policies},
        knobs=knobs or {},
        options=options,
        warmup_s=warmup_s,
        miss=miss,
    )


class Replays:
    """Makes replays, and keeps what became of them.

    Attributes
    ----------
    bench : Bench
    failures : dict of str to Failure
        By label, the first of each policy that failed or does not apply; it is not replayed again.
    """

    def __init__(
        self,
        bench: Bench,
        engine: Engine,
        progress: Progress | None = None,
        work: "WorkFolder | None" = None,
        limits: Limits | None = None,
    ) -> None:
        self.bench = bench
        self.failures: dict[str, Failure] = {}
        self._engine, self._progress, self._work = engine, progress, work
        self._limits = limits or DEFAULT_LIMITS
        self._scored: dict[Place, Scored] = {}
        self._asked = 0

    def __getitem__(self, place: Place) -> Scored:
        """Return the scores at a place that was asked for."""
        return self._scored[place]

    def __contains__(self, place: Place) -> bool:
        return place in self._scored

    def __iter__(self) -> Iterator[Place]:
        """Yield the places that have scores, in order."""
        places = self._scored
        return iter(sorted(places, key=lambda at: (at.policy, *map(_order, _rest(at)))))

    def to_table(self, judged: Collection[Place]) -> "pa.Table | None":
        """Return a row for each replay, see `results.record.COLUMNS`, and where it stands.

        None where a policy has no content to hash, by which rows are told apart.

        Parameters
        ----------
        judged
            Places of the replays by which policies are judged.
        """
        from .results.record import Entry, encode

        places = [place for place in self if not place.logged]
        axes: dict[str, list[AxisValue]] = {
            "knob": [place.knob for place in places],
            "judged": [place in judged for place in places],
        }
        names = {digest: value.name for digest, value in self.bench.inputs.items()}
        try:
            runs = RunList(tuple(map(self.bench.run_at, places)), names, axes)
        except TypeError:
            return None
        return encode(runs, [Entry(at, self[place]) for at, place in enumerate(places)])

    def make(self, places: Iterable[Place]) -> None:
        """Make the replays that are not made yet, of policies that have not failed.

        Raises `InputError` if the parameters of a policy are refused.
        """
        wanted = list(dict.fromkeys(places))
        wanted = [at for at in wanted if at not in self._scored and at.policy not in self.failures]
        if not wanted:
            return
        runs = list(map(self.bench.run_at, wanted))
        results, missing = self._begin(runs)
        self._asked += len(wanted)
        done = self._asked - len(missing)
        for outcome in self._engine.run([runs[at] for at in missing]):
            at = missing[outcome.index]
            results[at] = outcome.failure or outcome.result
            if self._work is not None:
                self._work.add(at, outcome)
            done += 1
            self._tell(done)
        if self._work is not None and missing:
            self._work.flush()
            self._tell(done)
        self._keep(wanted, results)

    def narrow(self, labels: Collection[str]) -> None:
        """Go on with some policies; what became of the others is forgotten."""
        specs = {label: spec for label, spec in self.bench.specs.items() if label in labels}
        knobs = {label: knob for label, knob in self.bench.knobs.items() if label in labels}
        self.bench = replace(self.bench, specs=specs, knobs=knobs)
        self.failures = {label: why for label, why in self.failures.items() if label in labels}
        self._scored = {at: scored for at, scored in self._scored.items() if at.policy in labels}

    def _begin(self, runs: Sequence[Run]) -> tuple[dict[int, Scored | Failure], list[int]]:
        """Return what an earlier start left of a round, and which of its runs are missing."""
        if self._work is None:
            return {}, list(range(len(runs)))
        names = {digest: value.name for digest, value in self.bench.inputs.items()}
        listed = RunList(tuple(runs), names, stop=True, limits=self._limits, study=self._work.study)
        results = self._work.begin(listed)
        return results, [at for at in listed.wanted(_failed(results)) if at not in results]

    def _tell(self, done: int) -> None:
        """Tell how many replays are done: where they are kept, those that no end can take back."""
        if self._progress is not None:
            durable = done if self._work is None else min(done, self._work.durable)
            self._progress(durable, self._asked)

    def _keep(self, wanted: Sequence[Place], results: Mapping[int, Scored | Failure]) -> None:
        """Take results in the order of their places, whatever the order in which they came."""
        for at, place in enumerate(wanted):
            result = results.get(at)
            if isinstance(result, Failure):
                self.failures.setdefault(place.policy, result)
            elif result is not None:
                self._scored[place] = result


def _failed(results: Mapping[int, Scored | Failure]) -> dict[int, bool]:
    return {at: isinstance(result, Failure) for at, result in results.items()}


def _rest(place: Place) -> tuple[float | None, ...]:
    return place.knob, place.path, place.draw, place.seed, float(place.logged)


def _order(value: float | None) -> tuple[bool, float]:
    return value is not None, value or 0.0
