"""Limits on metrics: of a population, for everything or for some policies, scenes and traces."""

from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Literal

from .amount import Amount

Kind = Literal["max", "min", "max_increase", "max_decrease"]
Population = Literal["this-path", "such-paths"]
"""this-path: these very paths under other noise, as a regression is.  such-paths: other paths of
their kind, as a promise is."""


@dataclass(frozen=True, slots=True)
class Limit:
    """One limit on one metric.

    Attributes
    ----------
    metric : str
    kind : Kind
        Relative to the baseline if it ends in increase or decrease.
    amount : Amount
    population : Population
        Of what it is a limit.
    floor : Amount or None
        A change up to this is allowed, however large it is relative to the baseline.
    line : int or None
        Where the file says so.
    """

    metric: str
    kind: Kind
    amount: Amount
    population: Population
    floor: Amount | None = None
    line: int | None = None

    @property
    def upper(self) -> bool:
        """Whether more of the metric breaks the limit."""
        return self.kind in {"max", "max_increase"}

    @property
    def relative(self) -> bool:
        """Whether the limit is on the change from the baseline."""
        return self.kind in {"max_increase", "max_decrease"}

    def describe(self, budget_ms: float, refresh_hz: float) -> str:
        """Return the limit as the user wrote it, and in milliseconds what is in frames."""
        floor = (
            "" if self.floor is None else f", floor {self.floor.describe(budget_ms, refresh_hz)}"
        )
        return f"{self.kind} {self.amount.describe(budget_ms, refresh_hz)}{floor}"


@dataclass(frozen=True, slots=True)
class Rule:
    """Limits by metric, and patterns of the policies, scenes and traces that they are for."""

    limits: dict[str, tuple[Limit, ...]]
    policy: str = "*"
    scene: str = "*"
    trace: str = "*"

    def covers(self, policy: str, scene: str, trace: str) -> bool:
        """Whether the rule is for these names.

        A policy also goes by what is before its colon, a path by what is before its first space:
        which stretch of it is replayed is said behind that.
        """
        return (
            any(fnmatchcase(name, self.policy) for name in (policy, policy.partition(":")[0]))
            and fnmatchcase(scene, self.scene)
            and any(fnmatchcase(name, self.trace) for name in (trace, trace.partition(" ")[0]))
        )


@dataclass(frozen=True, slots=True)
class LimitRules:
    """All rules of a file, in its order; a later one replaces an earlier one, metric by metric."""

    rules: tuple[Rule, ...]
    path: Path | None = None

    def of(self, policy: str, scene: str, trace: str) -> tuple[Limit, ...]:
        """Return the limits for a policy, scene and trace."""
        chosen: dict[str, tuple[Limit, ...]] = {}
        for rule in self.rules:
            if rule.covers(policy, scene, trace):
                chosen |= rule.limits
        return tuple(limit for limits in chosen.values() for limit in limits)

    @property
    def relative(self) -> bool:
        """Whether any limit needs a baseline."""
        return any(
            limit.relative
            for rule in self.rules
            for limits in rule.limits.values()
            for limit in limits
        )
