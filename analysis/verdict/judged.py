"""What a policy is judged by: its runs on every judged path, under every seed."""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ...policies.policy_spec import PolicySpec
from ..study.comparison_parts import KnobSetting
from ..study.score import Scored


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """A policy and its runs.

    Attributes
    ----------
    spec : PolicySpec
        With the knob as recommended.
    label : str
        As the user wrote it.
    oracle : bool
    knob : KnobSetting or None
    runs : tuple of tuple of Scored
        By judged path, then by seed; each path at the knob that was tuned without it.
    drawn : tuple of tuple of Scored
        By draw of the machine, then by path: the first paths on other machines.
    point_ms : (t,) float64
        Work time that the budget judges, at the recommended knob, on every path at hand.
    """

    spec: PolicySpec
    label: str
    oracle: bool
    knob: KnobSetting | None
    runs: tuple[tuple[Scored, ...], ...]
    drawn: tuple[tuple[Scored, ...], ...]
    point_ms: FloatArray

    @property
    def judged_ms(self) -> FloatArray:
        """Work time that the budget judges on each judged path, (n,): geometric mean over seeds."""
        times = np.array([[run.judged_ms for run in seeds] for seeds in self.runs])
        return np.exp(np.log(times).mean(axis=1))

    @property
    def drawn_ms(self) -> FloatArray:
        """Work time that the budget judges on each draw of the machine and path, (D, J)."""
        return np.array([[run.judged_ms for run in paths] for paths in self.drawn])

    def values(self, metric: str) -> FloatArray:
        """Return a metric on each path under each seed, (n, S); NaN where a run has none."""
        found = [[run.values[metric] for run in seeds] for seeds in self.runs]
        return np.array(found, dtype=np.float64)

    def drawn_values(self, metric: str) -> FloatArray:
        """Return a metric on each draw of the machine and path, (D, J)."""
        found = [[run.values[metric] for run in paths] for paths in self.drawn]
        return np.array(found, dtype=np.float64)

    def replicates(self, metric: str) -> FloatArray:
        """Return what is compared between policies: means over seeds by path; of one path, seeds.

        Its length is that of the population's sample: paths, or seeds where there is one path.
        """
        values = self.values(metric)
        return values[0] if len(values) == 1 else values.mean(axis=1)
