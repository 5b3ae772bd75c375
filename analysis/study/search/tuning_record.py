"""The result of a search for parameters: records whose fields are the keys of its JSON."""

from dataclasses import dataclass
from typing import Literal

from ..comparison_parts import Keeps, KnobSetting, PolicyResult, Provenance, Sampling, Span
from .space import Axis

SCHEMA = "lodbench.tune/1"


@dataclass(frozen=True, slots=True)
class Trial:
    """A choice of parameters and what training paths said of it.

    Attributes
    ----------
    label : str
    params : dict
        Those that differ from their defaults.
    status : str
        "ok", "refused" by the policy's class, "failed" or "not-applicable".
    reason : str or None
        Why it has no scores.
    paths : int
        Training paths of the last round that it was in; 0 if it was in none.
    keeps : float or None
        Probability of keeping another such path, at its best knob.
    knob : KnobSetting or None
        What its knob was brought to.
    visible_error_px, visible_pops_per_s, work_ms_mean : float or None
        Means over these paths.
    """

    label: str
    params: dict[str, object]
    status: Literal["ok", "refused", "failed", "not-applicable"]
    reason: str | None = None
    paths: int = 0
    keeps: float | None = None
    knob: KnobSetting | None = None
    visible_error_px: float | None = None
    visible_pops_per_s: float | None = None
    work_ms_mean: float | None = None


@dataclass(frozen=True, slots=True)
class Gain:
    """What the parameters that were found change in one metric, on the other paths.

    Attributes
    ----------
    metric : str
    unit : str
    shipped, found : float
        Means over paths.
    difference : float
        Found less shipped: below 0 is better in every metric of the order.
    interval : (low, high)
        90 % interval of the difference over such paths, paired by path (Student's t).
    """

    metric: str
    unit: str
    shipped: float
    found: float
    difference: float
    interval: Span


@dataclass(frozen=True, slots=True)
class Side:
    """The policy with certain parameters, on the paths that the search did not see.

    Attributes
    ----------
    label : str
    params : dict
        With the knob that these paths ask for.
    rank : int or None
        1 or 2; None if it does not surely keep the budget.
    """

    label: str
    params: dict[str, object]
    knob: KnobSetting | None
    keeps_budget: Keeps
    rank: int | None

    @staticmethod
    def of(result: PolicyResult) -> "Side":
        """Return what matters here of a policy that was scored."""
        assert result.keeps_budget is not None, "who is scored is judged by the budget"
        return Side(result.label, result.params, result.knob, result.keeps_budget, result.rank)


@dataclass(frozen=True, slots=True)
class Tuning:
    """Better parameters of a policy, or that none were found; without any wall-clock time.

    Attributes
    ----------
    policy : str
        As the user wrote it: what "shipped" means here.
    over : tuple of Axis
        What was searched.
    trials : tuple of Trial
        The shipped parameters first.
    training, judged : tuple of str
        Names of the paths that were searched on, and of those that the gain was confirmed on.
    warnings : tuple of str
        Why these paths may not tell parameters apart.
    shipped : Side
    found : Side or None
        None where the search ended at the shipped parameters.
    gain : tuple of Gain
        Empty where nothing was found to compare.
    better : bool
        Whether the verdict's order is shown to put the found parameters first.
    answer : str
        In one sentence.
    policy_line : str
        What to give to ``--policy``.
    """

    policy: str
    scene: str
    hardware: str
    budget_ms: float
    miss: float
    visible_px: float
    margin: float
    seed: int
    over: tuple[Axis, ...]
    trials: tuple[Trial, ...]
    training: tuple[str, ...]
    judged: tuple[str, ...]
    sampling: Sampling
    warnings: tuple[str, ...]
    shipped: Side
    found: Side | None
    gain: tuple[Gain, ...]
    better: bool
    answer: str
    policy_line: str
    provenance: Provenance
    schema: Literal["lodbench.tune/1"] = SCHEMA
