"""The result of a suite: records whose fields are the keys of ``suite.json``."""

from dataclasses import dataclass
from typing import Literal

from ..comparison_parts import Status

SCHEMA = "lodbench.suite/1"


@dataclass(frozen=True, slots=True)
class Standing:
    """A policy in one cell.

    Attributes
    ----------
    label : str
    status : str
    reason : str or None
        Why it failed or does not apply.
    rank : int or None
        Among those that surely keep the budget; None of the others.
    keeps : float or None
        Probability of keeping the budget on another path of the kind.
    knob : str
        As a command line sets it; empty if the policy has none.
    work_ms_p99, visible_error_px, visible_pops_per_s, work_ms_mean : float or None
        Means over paths; the first is what the budget judges.
    """

    label: str
    status: Status
    reason: str | None
    rank: int | None
    keeps: float | None
    knob: str
    work_ms_p99: float | None
    visible_error_px: float | None
    visible_pops_per_s: float | None
    work_ms_mean: float | None


@dataclass(frozen=True, slots=True)
class CellResult:
    """One comparison of the suite.

    Attributes
    ----------
    paths : tuple of str
        Names.
    answer, warnings : tuple of str
        As the comparison has them.
    hashes : dict of str to str
        Content hashes of scene, paths and hardware, by name.
    standings : tuple of Standing
        In the order of the comparison.
    """

    name: str
    scene: str
    trace: str
    hardware: str
    budget_ms: float
    paths: tuple[str, ...]
    answer: tuple[str, ...]
    warnings: tuple[str, ...]
    hashes: dict[str, str]
    standings: tuple[Standing, ...]


@dataclass(frozen=True, slots=True)
class Leader:
    """A line of the leaderboard.

    Attributes
    ----------
    place : int
        From 1; equals share it.
    submitted : bool
        Whether it is no part of the suite.
    kept : int
        Cells whose budget it surely keeps.
    mean_rank : float or None
        Over these cells; None if there are none.
    failed, not_applicable : int
        Cells in which it broke its contract, or does not fit the scene.
    """

    place: int
    label: str
    submitted: bool
    kept: int
    mean_rank: float | None
    failed: int
    not_applicable: int


@dataclass(frozen=True, slots=True)
class SuiteResult:
    """The leaderboard of a suite, without any wall-clock time.

    Attributes
    ----------
    suite : str
    suite_version : int
    suite_hash : str
        Of the definition: only results with the same can be compared...
    version, code : str
        ...and only where the program was the same too.
    leaderboard : tuple of Leader
        By cells kept, then mean rank, then label.
    cells : tuple of CellResult
    """

    suite: str
    suite_version: int
    suite_hash: str
    command: str
    version: str
    code: str
    leaderboard: tuple[Leader, ...]
    cells: tuple[CellResult, ...]
    schema: Literal["lodbench.suite/1"] = SCHEMA
