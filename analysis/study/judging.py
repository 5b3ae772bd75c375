"""Which replays policies are judged by, and what these are, taken together."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...policies.knob import declared_knob
from ...policies.policy_spec import PolicySpec, is_oracle, parameters
from ..verdict.curve import Curve
from ..verdict.judged import Judged
from .comparison_parts import KnobSetting, PolicyResult
from .replays import Bench, Place, Replays
from .score import Scored
from .tuning import Rotation, Tuned, quantiles_ms

_ORACLE_PATHS, _DRAWN_PATHS = 2, 2
"""An oracle is slow and only shown; the machine's share of doubt is seen on few paths."""


@dataclass(frozen=True, slots=True)
class Judging:
    """Where the replays of a comparison stand.

    Attributes
    ----------
    bench : Bench
    rotation : Rotation
    seeds : tuple of int
        Of the replays on every judged path; the first is that of all others too.
    draws : tuple of int
        Draws of the machine.
    """

    bench: Bench
    rotation: Rotation
    seeds: tuple[int, ...]
    draws: tuple[int, ...]

    @property
    def seed(self) -> int:
        """The first seed."""
        return self.seeds[0]

    def paths_of(self, label: str) -> tuple[int, ...]:
        """Return the judged paths of a policy."""
        oracle = is_oracle(self.bench.specs[label])
        return self.rotation.judged[: _ORACLE_PATHS if oracle else None]

    def as_given(self) -> list[Place]:
        """Return the first replays of the policies that are not tuned."""
        return [
            Place(label, path, self.seed)
            for label in self.bench.specs
            if label not in self.bench.knobs
            for path in self.paths_of(label)
        ]

    def knob_at(self, tuned: Tuned | None, at: int) -> float | None:
        """Return the knob at which a policy is judged on the path of a position."""
        return None if tuned is None else float(tuned.judged[at])

    def places(self, tuned: Mapping[str, Tuned]) -> list[Place]:
        """Return the replays that policies are judged by, on this machine and on others."""
        places: list[Place] = []
        for label in self.bench.specs:
            mine = tuned.get(label)
            places += self._judging(label, mine)
            if not is_oracle(self.bench.specs[label]):
                places += self._drawn(label, mine)
            places.append(Place(label, 0, self.seed, self.knob_at(mine, 0), logged=True))
        return places

    def _judging(self, label: str, tuned: Tuned | None) -> list[Place]:
        return [
            Place(label, path, seed, self.knob_at(tuned, at))
            for at, path in enumerate(self.paths_of(label))
            for seed in self.seeds
        ]

    def _drawn(self, label: str, tuned: Tuned | None) -> list[Place]:
        knob = None if tuned is None else tuned.point.value
        return [
            Place(label, path, self.seed, knob, draw)
            for draw in self.draws
            for path in self.rotation.judged[:_DRAWN_PATHS]
        ]

    def worst(self, replays: Replays, label: str, tuned: Mapping[str, Tuned]) -> Place:
        """Return where a policy did most work of all that it is judged by, to be logged."""
        places = self._judging(label, tuned.get(label))
        return replace(max(places, key=lambda at: replays[at].worst.work_ms), logged=True)

    def outcome(self, replays: Replays, tuned: Mapping[str, Tuned]) -> list[Judged]:
        """Return the policies that were scored, with their runs."""
        scored = [label for label in self.bench.specs if label not in replays.failures]
        return [self._judged(replays, label, tuned.get(label)) for label in scored]

    def curves(self, replays: Replays, tuned: Mapping[str, Tuned]) -> dict[str, Curve]:
        """Return what each tuned policy gives for what, by label."""
        return {
            label: self._curve(replays, label, mine)
            for label, mine in tuned.items()
            if label not in replays.failures
        }

    def unscored(self, replays: Replays) -> list[PolicyResult]:
        """Return the policies that failed or do not apply."""
        return [
            PolicyResult(
                spec.name,
                label,
                spec.params,
                None,
                failure.kind,
                str(failure),
                is_oracle(spec),
            )
            for label, spec in self.bench.specs.items()
            if (failure := replays.failures.get(label)) is not None
        ]

    def _judged(self, replays: Replays, label: str, tuned: Tuned | None) -> Judged:
        spec = self.bench.specs[label]
        places = self._judging(label, tuned)
        width = len(self.seeds)
        runs = tuple(
            tuple(replays[place] for place in places[start : start + width])
            for start in range(0, len(places), width)
        )
        drawn = self._drawn(label, tuned) if not is_oracle(spec) else []
        each = min(_DRAWN_PATHS, len(self.rotation.judged))
        by_draw = tuple(
            tuple(replays[place] for place in drawn[start : start + each])
            for start in range(0, len(drawn), each)
        )
        return Judged(
            spec=self._recommended(label, tuned),
            label=label,
            oracle=is_oracle(spec),
            knob=self._setting(label, tuned),
            runs=runs,
            drawn=by_draw,
            point_ms=self._point_ms(replays, label, tuned, runs),
        )

    def _point_ms(
        self,
        replays: Replays,
        label: str,
        tuned: Tuned | None,
        runs: tuple[tuple[Scored, ...], ...],
    ) -> FloatArray:
        """Return the judged work time by path at the recommended knob; of one path, by seed."""
        if len(self.rotation.judged) == 1:
            places = self._judging(label, tuned)
            return np.array([replays[place].judged_ms for place in places])
        if tuned is not None:
            return quantiles_ms(
                replays, label, [tuned.point.value], self.rotation.training, self.seed
            )[0]
        times = [
            [replays[Place(label, path, seed)].judged_ms for seed in self.seeds]
            for path in self.paths_of(label)
        ]
        return np.exp(np.log(np.array(times)).mean(axis=1))

    def _recommended(self, label: str, tuned: Tuned | None) -> PolicySpec:
        spec = self.bench.specs[label]
        if tuned is None:
            return spec
        name = self.bench.knobs[label].name
        return replace(spec, params=spec.params | {name: tuned.point.value})

    def _setting(self, label: str, tuned: Tuned | None) -> KnobSetting | None:
        if tuned is None:
            return _as_given(self.bench.specs[label])
        return KnobSetting(
            self.bench.knobs[label].name,
            tuned.point.value,
            tuned=True,
            monotone=tuned.point.monotone,
            folds=tuple(tuned.judged.tolist()),
        )

    def _curve(self, replays: Replays, label: str, tuned: Tuned) -> Curve:
        def table(metric: str) -> FloatArray:
            return np.array(
                [
                    [
                        replays[Place(label, path, self.seed, value)].values[metric]
                        for path in self.rotation.scanned
                    ]
                    for value in values
                ],
                dtype=np.float64,
            )

        values = tuned.values.tolist()
        work_ms = quantiles_ms(replays, label, values, self.rotation.scanned, self.seed)
        mean_ms = table("work_ms_mean")
        scored = [
            [replays[Place(label, path, self.seed, value)] for path in self.rotation.scanned]
            for value in values
        ]
        added = {
            name: np.array([[one.added_ms[name] for one in row] for row in scored])
            for name in scored[0][0].added_ms
        }
        return Curve(
            knob=tuned.values,
            p99_ms=work_ms,
            # Where no frame is shown within the window, none weighs there.
            work_ms=np.where(np.isnan(mean_ms), work_ms, mean_ms),
            error_px=np.nan_to_num(table("visible_error_px")),
            pops_per_s=np.nan_to_num(table("visible_pops_per_s")),
            lag_ms=np.nan_to_num(table("lag_ms_mean")),
            added_ms=added,
        )


def _as_given(spec: PolicySpec) -> KnobSetting | None:
    """Return the knob of a policy that is not tuned, None if it has none or it is not known."""
    try:
        knob = declared_knob(spec)
    except InputError:  # a knob that nobody turns may be wrong
        return None
    if knob is None:
        return None
    default = next(each.default for each in parameters(spec.cls) if each.name == knob.name)
    value = spec.params.get(knob.name, default)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return KnobSetting(knob.name, float(value), tuned=False)
