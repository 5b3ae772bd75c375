"""What a comparison is made of: records whose fields are keys of ``comparison.json``."""

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from ...models.scene.rig import Eyes
from ..metrics.metric import Better
from ..metrics.steps import Step

Status = Literal["ok", "failed", "not-applicable"]
Span: TypeAlias = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Score:
    """A metric of one policy.

    Attributes
    ----------
    value : float or None
        Mean over paths, each the mean over its seeds; of extremes the worst of all.  None where no
        run has the metric.
    this_path, such_paths, with_machine : (low, high) or None
        90 % intervals of that mean: of these very paths under other noise, of paths of this kind,
        and of such paths on other machines of the profile's draws.  None where the runs cannot
        tell: extremes have none.
    enough : bool
        Whether the runs are enough for `such_paths` to cover what it says.
    needed : int or None
        How many paths would be.
    """

    value: float | None
    this_path: Span | None
    such_paths: Span | None
    with_machine: Span | None
    enough: bool
    needed: int | None
    unit: str
    better: Better


@dataclass(frozen=True, slots=True)
class KnobSetting:
    """The parameter that trades picture for time, as it was set.

    Attributes
    ----------
    name : str
    value : float or str
    tuned : bool
        Whether it was brought to the budget; else it is as shipped or as typed.
    monotone : bool
        Whether the time grew with the knob in all replays.
    folds : tuple of float
        The value at which each path was judged, tuned on the others.
    """

    name: str
    value: float | str
    tuned: bool
    monotone: bool = True
    folds: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Keeps:
    """Whether a policy keeps the budget: its work time at the quantile 1 − miss is within it.

    Attributes
    ----------
    probability : float or None
        That it keeps another path of the kind, or of a single path another replay; None where
        a single replay says nothing of others.
    kept, paths : int
        Of the judged paths, how many it kept; each was judged at a knob tuned on others.
    low, high : float
        90 % exact bound (Clopper-Pearson) of the share of paths kept.
    work_ms : float
        Geometric mean over paths of the work time at that quantile.
    with_machine : float or None
        `probability` on another machine of the profile's draws, which hold what its fit leaves
        open and its scatter between occasions and scenes; None where it has no draws.
    """

    probability: float | None
    kept: int
    paths: int
    low: float
    high: float
    work_ms: float
    with_machine: float | None = None


@dataclass(frozen=True, slots=True)
class PolicyResult:
    """What became of one policy.

    Attributes
    ----------
    label : str
        What the user wrote, which tells policies of one name apart.
    params : dict
        Those that differ from their defaults, the knob's value among them.
    reason : str or None
        Why it failed or does not apply.
    rank : int or None
        From 1 among those that keep the budget; None of the others and of oracles.
    leader : str or None
        The policy that its rank is named after: those of the rank are not shown to be worse.
    behind_by : str or None
        The metric that puts its rank behind the one before; None of the first.
    same_as : str or None
        The policy that did the same in every run.
    metrics : dict of str to Score
        By metric id; empty unless the status is ok.
    steps : tuple of Step
        Answers to the steps in visible load on the first path.
    """

    name: str
    label: str
    params: dict[str, object]
    knob: KnobSetting | None
    status: Status
    reason: str | None
    oracle: bool
    keeps_budget: Keeps | None = None
    rank: int | None = None
    leader: str | None = None
    behind_by: str | None = None
    same_as: str | None = None
    metrics: dict[str, Score] = field(default_factory=dict[str, Score])
    steps: tuple[Step, ...] = ()

    def value_of(self, metric: str) -> float | None:
        """Return the value of a metric, or None if there is none."""
        score = self.metrics.get(metric)
        return None if score is None else score.value


@dataclass(frozen=True, slots=True)
class Conditions:
    """Under which conditions the replays ran, beside scene, paths and hardware.

    Attributes
    ----------
    fovy_of : str
        How the field of view stands to what the paths state; empty where none states one.
    players : int
        Who share the screen.
    """

    display: str
    refresh_hz: float
    frames_in_flight: int
    pacing: str
    latency_limit: int
    width_px: int
    height_px: int
    fovy_deg: float
    crossfade_ms: float
    measurement_delay: int
    nodes: int
    hardware_source: str
    hardware_assumed: bool
    fovy_of: str = ""
    eyes: Eyes | None = None
    players: int = 1


@dataclass(frozen=True, slots=True)
class Sampling:
    """How intervals and probabilities were made.

    Attributes
    ----------
    level : float
        Of intervals.
    seeds : int
        Replays of each path under other noise.
    draws : int
        Draws of the machine: of its fit and its scatter; 0 if the profile has neither.
    tuned_on : str
        What knobs were tuned on.
    """

    level: float
    seeds: int
    draws: int
    tuned_on: str


@dataclass(frozen=True, slots=True)
class Curve:
    """What a policy gives for what as its knob turns: means over the paths.

    Attributes
    ----------
    knob : tuple of float
        From coarse to fine.
    work_ms : tuple of float
        Geometric mean over paths of the work time at the quantile 1 − miss.
    visible_error_px, pops_per_s, lag_ms : tuple of float
        Of `visible_error_px`, `visible_pops_per_s` and `lag_ms_mean`.
    work_span, visible_error_span : tuple of (low, high)
        Intervals over such paths; empty for a single path.
    area_pct : float or None
        Mean per cent by which its picture error at equal work is above that of the first of the
        ranking, over the work that both reach; None where they reach none in common.
    """

    knob: tuple[float, ...]
    work_ms: tuple[float, ...]
    visible_error_px: tuple[float, ...]
    pops_per_s: tuple[float, ...]
    lag_ms: tuple[float, ...]
    work_span: tuple[Span, ...] = ()
    visible_error_span: tuple[Span, ...] = ()
    area_pct: float | None = None


@dataclass(frozen=True, slots=True)
class Chances:
    """How sure an order is, by label of each policy that keeps the budget.

    Attributes
    ----------
    p_best : dict of str to float
        Probability of being the best in the mean over such paths, or over replays of one.
    p_near_best : dict of str to float
        Probability of being within the margin of the best.
    regret : dict of str to float
        Expected distance from the best, in the metric's unit.
    """

    p_best: dict[str, float]
    p_near_best: dict[str, float]
    regret: dict[str, float]


@dataclass(frozen=True, slots=True)
class LeastMiss:
    """Who comes nearest to the budget where nobody keeps it, and by what factor it is exceeded."""

    label: str
    ratio: float


@dataclass(frozen=True, slots=True)
class Elsewhere:
    """Who ranks first at another budget, read off the curves.

    Attributes
    ----------
    refresh_hz, budget_ms : float
    first : tuple of str
        Labels that share the first rank, the leader first; empty where no curve reaches it.
    misses : tuple of str
        Labels whose curve does not reach that budget.
    """

    refresh_hz: float
    budget_ms: float
    first: tuple[str, ...]
    misses: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Costlier:
    """Who ranks first with a cost that nobody measured, read off curves of runs priced again.

    Attributes
    ----------
    cost : str
        In words that follow "with".
    stands : bool
        Whether the leader of the first rank stays in it.
    first : tuple of str
        Labels that share the first rank, the leader first; empty where no curve keeps the budget.
    misses : tuple of str
        Labels whose curve does not reach the budget.
    """

    cost: str
    stands: bool
    first: tuple[str, ...]
    misses: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Robustness:
    """Over what the first rank stands, read off the curves.

    Attributes
    ----------
    leader : str
        Leader of the first rank among the policies that have a curve.
    speed : (low, high)
        Range of the machine's speed, as a factor within 0.5 to 2, over which it stays first.
    budgets : tuple of Elsewhere
        At 30, 60, 90 and 120 Hz.
    costs : tuple of Costlier
        With each cost that was tried; empty where frame logs do not count what it is of.
    """

    leader: str
    speed: Span
    budgets: tuple[Elsewhere, ...]
    costs: tuple[Costlier, ...] = ()


@dataclass(frozen=True, slots=True)
class Provenance:
    """What made the result.

    Attributes
    ----------
    command, version : str
    code : str
        Hash of the sources that decide what a run results in.
    hashes : dict of str to str
        Content of scene, paths and hardware, by name.
    settings : str
        Hash of what the verdict was reached by: budget, miss, visible, margin, warm-up, and which
        paths in which order.  Answers of two comparisons are about the same question if it is one.
    """

    command: str
    version: str
    code: str
    hashes: dict[str, str]
    settings: str


@dataclass(frozen=True, slots=True)
class UnitCosts:
    """What one of each predictor costs in the mean machine: ms by predictor, of both sides."""

    gpu: dict[str, float] = field(default_factory=dict[str, float])
    cpu: dict[str, float] = field(default_factory=dict[str, float])


def knob_text(policy: PolicyResult) -> str:
    """Return a policy's knob as a command line sets it, empty if it has none."""
    knob = policy.knob
    if knob is None:
        return ""
    value = f"{knob.value:g}" if isinstance(knob.value, float) else knob.value
    return f"{knob.name}={value}"
