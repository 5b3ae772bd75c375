"""The result of a validation: records whose fields are the keys of ``validation.json``."""

from dataclasses import dataclass
from typing import Literal

from .time_errors import ErrorSummary

SCHEMA = "lodbench.validate/2"


@dataclass(frozen=True, slots=True)
class Agreement:
    """A metric as measured and as simulated.

    Attributes
    ----------
    measured, again : value of the recording, and of the second, if there was one
    simulated, low, high : value under the profile's mean, and the interval over its draws
    inside : whether the measured value lies in the interval; None where either is missing
    """

    measured: float | None
    again: float | None
    simulated: float | None
    low: float | None
    high: float | None
    inside: bool | None
    unit: str


@dataclass(frozen=True, slots=True)
class Errors:
    """Errors of frame times against those measured.

    Attributes
    ----------
    model : the profile's cost of each recorded frame, from what was drawn in it (open loop)
    v_time : the same, adapted to the frames before
    simulation : the simulated replay at the same moment of the trace (closed loop)
    again : the second recording at the same moment: how far the machine comes from itself
    """

    model: ErrorSummary
    v_time: ErrorSummary
    simulation: ErrorSummary
    again: ErrorSummary | None = None


@dataclass(frozen=True, slots=True)
class PolicyValidation:
    """One policy, recorded and simulated."""

    label: str
    frames_measured: int
    frames_simulated: int
    errors: Errors
    metrics: dict[str, Agreement]


@dataclass(frozen=True, slots=True)
class Rank:
    """Kendall's τ of a metric's values over the policies.

    Attributes
    ----------
    simulated : between simulation and recording
    again : between the two recordings
    """

    simulated: float | None
    again: float | None


@dataclass(frozen=True, slots=True)
class Validation:
    """A validation.

    Attributes
    ----------
    hardware_source : where the profile's costs come from
    measured_on : scenes and traces that it was calibrated on
    log : what the render logs say about themselves
    window_s : the stretch of the path that counts
    all_policies : errors of all frames of all policies together
    inside : share of the metrics with both a value and an interval that are inside
    """

    scene: str
    trace: str
    trace_s: float
    hardware: str
    hardware_source: str
    measured_on: tuple[str, ...]
    budget_ms: float
    seed: int
    window_s: tuple[float, float]
    level: float
    draws: int
    log: dict[str, str]
    policies: tuple[PolicyValidation, ...]
    all_policies: Errors
    inside: float | None
    ranks: dict[str, Rank]
    schema: Literal["lodbench.validate/2"] = SCHEMA
