"""What a metric is: one function of a run's frames, with its unit, direction, group and source."""

from collections.abc import Callable
from dataclasses import dataclass
from inspect import cleandoc
from typing import Literal

from .measured_frames import MeasuredFrames

Better = Literal["lower", "higher"]
Group = Literal["budget", "stability", "lag", "flicker", "quality", "work"]
GROUPS: tuple[Group, ...] = ("budget", "stability", "lag", "flicker", "quality", "work")

Function = Callable[[MeasuredFrames], float | None]


@dataclass(frozen=True, slots=True)
class Metric:
    """A metric, called with a run.

    Attributes
    ----------
    id : str
    group : one of `GROUPS`
    unit : str
        "fraction" lies in [0, 1], "ratio" is any other dimensionless number.
    better : "lower" or "higher"
    definition, source : str
        The two parts of its function's docstring.
    function : callable
        Returns None where the run cannot have the metric.
    """

    id: str
    group: Group
    unit: str
    better: Better
    definition: str
    source: str
    function: Function

    def __call__(self, run: MeasuredFrames) -> float | None:
        """Return the metric of a run, or None where the run cannot have it."""
        return self.function(run)


def metric(group: Group, unit: str, better: Better) -> Callable[[Function], Metric]:
    """Make the function below a `Metric` whose id is the function's name.

    The docstring's first paragraphs are the definition; the one that begins with ``Source:`` is the
    source.
    """

    def record(function: Function) -> Metric:
        definition, mark, source = cleandoc(function.__doc__ or "").partition("\n\nSource: ")
        assert mark, "a metric's docstring says where the definition comes from"
        return Metric(
            id=function.__name__,
            group=group,
            unit=unit,
            better=better,
            definition=" ".join(definition.split()),
            source=" ".join(source.split()),
            function=function,
        )

    return record
