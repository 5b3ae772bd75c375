"""What an experiment is: what its paper did and printed, what is measured, and how it is judged."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from .trial import Numbers, Trial

Origin: TypeAlias = Literal["printed", "assumed", "calibrated"]
"""Where a constant is from: the paper's text, a choice of ours, or the figure it should give."""

REPRODUCED = "reproduced"
IN_DIRECTION = "in direction"
_NOT = "not reproduced"


@dataclass(frozen=True, slots=True)
class Constant:
    """A number that decides what an experiment gives.

    Attributes
    ----------
    value : str
        With its unit.
    origin : Origin
    source : str
        Section or figure of the paper, or why it was assumed so.
    """

    value: str
    origin: Origin
    source: str = ""


@dataclass(frozen=True, slots=True)
class Claim:
    """One thing that a paper says, beside what is measured.

    Attributes
    ----------
    claim : str
        In a sentence or less.
    paper, ours : str
        Numbers with units; ``not printed`` where the paper has none or the text has lost it.
    tolerance : str
        How far apart they may be; empty where only the direction is judged.
    verdict : str
        ``reproduced``, ``in direction``, or ``not reproduced:`` and why.
    """

    claim: str
    paper: str
    ours: str
    tolerance: str
    verdict: str

    def __post_init__(self) -> None:
        known = self.verdict in (REPRODUCED, IN_DIRECTION)
        if not known and not self.verdict.startswith(f"{_NOT}: "):
            raise ValueError(f"expected a verdict, with its reason if negative, got {self.verdict}")


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a chart; `printed` ones are the paper's."""

    label: str
    x: Sequence[float]
    y: Sequence[float]
    printed: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Chart:
    """A picture of an experiment.

    Attributes
    ----------
    name : str
        Of its file, within the experiment.
    caption : str
        The sentence that a reader should take from it.
    x, y : str
        What the axes are, with units.
    lines : tuple of Line
    log_x, log_y : bool
    """

    name: str
    caption: str
    x: str
    y: str
    lines: tuple[Line, ...]
    log_x: bool = False
    log_y: bool = False


@dataclass(frozen=True, slots=True)
class Findings:
    """What an experiment gave.

    Attributes
    ----------
    claims : tuple of Claim
    charts : tuple of Chart
    notes : tuple of str
        What the answer depends on, such as a sweep over an assumed constant, in sentences.
    """

    claims: tuple[Claim, ...]
    charts: tuple[Chart, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Experiment:
    """An experiment of a paper.

    Attributes
    ----------
    id : str
        Such as ``gumbau/fig6``.
    title : str
    setting : str
        Scene, path, machine, frames and seeds, in a sentence or two.
    constants : dict of str to Constant
    trials : callable
        Takes whether the experiment is to be done at reduced size; returns its trials.
    judge : callable
        Takes the numbers of the trials by key, and the same; returns the findings.
    """

    id: str
    title: str
    setting: str
    constants: Mapping[str, Constant] = field(default_factory=dict[str, Constant])
    trials: Callable[[bool], Sequence[Trial]]
    judge: Callable[[Mapping[str, Numbers], bool], Findings]


def not_reproduced(why: str) -> str:
    """Return the verdict of what differs from print, with the reason."""
    return f"{_NOT}: {why}"


def verdict_of(holds: bool, why_not: str, *, direction: bool = False) -> str:
    """Return the verdict of something that holds or does not.

    Parameters
    ----------
    why_not
        The reason, if it does not hold.
    direction
        Whether it at least differs from nothing in the direction that the paper says.
    """
    if holds:
        return REPRODUCED
    return IN_DIRECTION if direction else not_reproduced(why_not)


def error_pct(ours: float, paper: float) -> float:
    """Return by how many per cent of the printed number ours differs."""
    return 100.0 * (ours / paper - 1.0) if paper else math.inf
