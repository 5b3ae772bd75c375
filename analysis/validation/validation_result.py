"""The result of a validation: records whose fields are the keys of ``validation.json``."""

from dataclasses import dataclass, field
from typing import Literal

SCHEMA = "lodbench.validate/3"


@dataclass(frozen=True, slots=True)
class ErrorSummary:
    """Prediction over measurement minus one, in per cent.

    Attributes
    ----------
    frames : frames compared
    mean_pct, sd_pct : mean and sample standard deviation
    p05_pct, p50_pct, p95_pct : percentiles, linear interpolation
    """

    frames: int
    mean_pct: float
    sd_pct: float
    p05_pct: float
    p50_pct: float
    p95_pct: float


@dataclass(frozen=True, slots=True)
class Errors:
    """Errors of frame times against those of the first recording.

    Attributes
    ----------
    model : the profile's cost of each recorded frame, from what was drawn in it (open loop)
    v_time : the same, adapted to the frames before
    simulation : the simulated replay at the same moment of the path (closed loop)
    again : the second recording at the same moment
    repeat : the same, with what was drawn in each divided out by the model
    noise_pct : sd of `repeat` over the root of 2: what one recording owes to the machine alone
    excess : sd of `model` over `noise_pct`; 1 where the model misses nothing but noise
    """

    model: ErrorSummary
    v_time: ErrorSummary
    simulation: ErrorSummary
    again: ErrorSummary | None = None
    repeat: ErrorSummary | None = None
    noise_pct: float | None = None
    excess: float | None = None


@dataclass(frozen=True, slots=True)
class DetailError:
    """How the model's error goes with the level of detail.

    Attributes
    ----------
    share : (low, high)
        5th and 95th percentile of the share of the full triangles in view that were drawn.
    slope_pct : float or None
        Change of the error from nothing drawn to all, by least squares; None where the share stays
        within 2 %.
    quarters_pct : four floats
        Mean error in each quarter of the frames, that of the coarsest first.
    """

    share: tuple[float, float]
    slope_pct: float | None
    quarters_pct: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Agreement:
    """A metric as measured and as simulated.

    Attributes
    ----------
    measured, again : value of the recording, and of the second, if there was one
    simulated : median over the replicates
    low, high : where one recording of this path lies with a probability of `Validation.level`
    inside : whether the measured value lies in the interval; None where either is missing
    counted : whether it is among the cells whose share inside is given, see `COUNTED`
    """

    measured: float | None
    again: float | None
    simulated: float | None
    low: float | None
    high: float | None
    inside: bool | None
    counted: bool
    unit: str


@dataclass(frozen=True, slots=True)
class Decision:
    """A question about a policy that is answered yes or no, simulated and measured.

    Attributes
    ----------
    probability : share of the replicates that say yes
    decided : "yes" or "no" where at least nine in ten say so, else "undecided"
    measured : what the recordings say; None where two of them differ
    as_measured : whether what is decided is what was measured; None where either is open
    """

    probability: float
    decided: Literal["yes", "no", "undecided"]
    measured: bool | None
    as_measured: bool | None


@dataclass(frozen=True, slots=True)
class PolicyValidation:
    """One policy, recorded and simulated.

    Attributes
    ----------
    corrected : Errors or None
        As `errors`, of times over those of the reference drawing beside them; None without one.
    cost_ratio : float or None
        Median of measured over predicted time of a frame; None where the model has no cost,
        or frames overlap.
    judged_ms : tuple of float
        Work time by which the budget is judged, of each recording.
    keeps_budget, first : Decision
        Whether it keeps the budget, and whether it is first or equal to the first.
    """

    label: str
    frames_measured: int
    frames_simulated: int
    errors: Errors
    corrected: Errors | None
    detail: DetailError | None
    cost_ratio: float | None
    judged_ms: tuple[float, ...]
    keeps_budget: Decision
    first: Decision
    metrics: dict[str, Agreement]


@dataclass(frozen=True, slots=True)
class Rank:
    """Kendall's τ of a metric over the pairs of policies that recordings tell apart.

    Attributes
    ----------
    simulated : of the mean over the replicates, against the recordings; None without a pair
    low, high : where τ of one replicate lies, at `Validation.level`
    apart, pairs : pairs that the recordings tell apart, of how many
    again : between the two recordings, over all pairs
    """

    simulated: float | None
    low: float | None
    high: float | None
    apart: int
    pairs: int
    again: float | None


@dataclass(frozen=True, slots=True)
class Drift:
    """How the machine's own speed changed, seen in a drawing that is always the same.

    Attributes
    ----------
    sd_pct : standard deviation of its time, over its median
    low_pct, high_pct : 5th and 95th percentile of its time over its median, less 100 %
    """

    sd_pct: float
    low_pct: float
    high_pct: float


@dataclass(frozen=True, slots=True)
class Inside:
    """How many of the counted metrics lie in their intervals, pooled and by metric (inside, of)."""

    inside: int
    counted: int
    by_metric: dict[str, tuple[int, int]]

    @property
    def share(self) -> float | None:
        """Share inside; None where nothing counts."""
        return self.inside / self.counted if self.counted else None


@dataclass(frozen=True, slots=True)
class Decided:
    """How many decisions agree: cases of policy × path that recordings do not leave open.

    Attributes
    ----------
    asked : cases
    undecided : of them, those that the simulation leaves open
    as_measured : of the decided, those that are as measured
    far_undecided : undecided although the measured time is more than 25 % off the budget
    """

    asked: int
    undecided: int
    as_measured: int
    far_undecided: int = 0


@dataclass(frozen=True, slots=True)
class MachineFactor:
    """How the machine's costs stand to the profile's, whatever is drawn.

    Attributes
    ----------
    factor : median over policies and paths of measured over predicted
    low, high : its least and largest over policies and paths
    scatter_pct : standard deviation of its logarithm over them
    another : whether the profile is that of another machine
    """

    factor: float
    low: float
    high: float
    scatter_pct: float
    another: bool


@dataclass(frozen=True, slots=True)
class Case:
    """What was validated on one path through one scene.

    Attributes
    ----------
    log : what the render logs say about themselves
    window_s : the stretch of the path that counts
    frames_in_flight : frames that were drawn before the first was waited for
    drift : of the reference drawing; None where the recordings have none
    failed : why policies have no result, by label
    all_policies, all_corrected : errors of all frames of all policies together
    first_measured, first_simulated : who leads the order; simulated, in most replicates
    """

    scene: str
    trace: str
    trace_s: float
    budget_ms: float
    seed: int
    window_s: tuple[float, float]
    frames_in_flight: int
    log: dict[str, str]
    drift: Drift | None
    policies: tuple[PolicyValidation, ...]
    failed: dict[str, str]
    all_policies: Errors | None
    all_corrected: Errors | None
    first_measured: str | None
    first_simulated: str | None
    inside: Inside
    ranks: dict[str, Rank]


@dataclass(frozen=True, slots=True)
class Pooled:
    """All cases together.

    Attributes
    ----------
    ranks : by metric, over the pairs of all paths that recordings tell apart
    keeps_budget, first : decisions of all policies on all paths
    machine : None where no policy has a result
    """

    errors: Errors | None
    corrected: Errors | None
    inside: Inside
    ranks: dict[str, Rank]
    keeps_budget: Decided
    first: Decided
    machine: MachineFactor | None


@dataclass(frozen=True, slots=True)
class Validation:
    """A validation.

    Attributes
    ----------
    hardware_source : where the profile's costs come from
    measured_on : scenes and traces that it was calibrated on
    level : probability of the intervals: of one more recording of the same path
    replicates, draws : simulated recordings of each policy, under how many machine draws
    answer : what the numbers come to, in sentences
    """

    hardware: str
    hardware_source: str
    measured_on: tuple[str, ...]
    level: float
    replicates: int
    draws: int
    cases: tuple[Case, ...]
    pooled: Pooled
    answer: tuple[str, ...] = field(default=())
    schema: Literal["lodbench.validate/3"] = SCHEMA
