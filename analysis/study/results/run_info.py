"""How long runs took and how much memory they had: beside the results, and no part of them.

The same study has the same results on every machine, and another ``run-info.json`` each time.
"""

import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from ....base.errors import InputError
from ....base.files.strict_json import encode_record, read_json
from ....base.files.whole_file import write_whole
from ..engine.task import Outcome

RUN_INFO = "run-info.json"
_SCHEMA = "lodbench.run-info/1"


@dataclass(slots=True)
class PolicyInfo:
    """What the runs of one policy took.

    Attributes
    ----------
    runs : int
    run_s, slowest_run_s : float
        Wall time of all runs, and of the slowest.
    peak_bytes : int
        Most memory that a process of the policy had.
    """

    runs: int = 0
    run_s: float = 0.0
    slowest_run_s: float = 0.0
    peak_bytes: int = 0


@dataclass(slots=True)
class RunInfo:
    """What a study took, all starts together.

    Attributes
    ----------
    study : str
        Its hash.
    starts : int
        How often it was started.
    wall_s : float
        From each start to its end, or to its last result if it was killed.
    policies : dict of str to PolicyInfo
        By label.
    """

    study: str
    starts: int = 0
    wall_s: float = 0.0
    policies: dict[str, PolicyInfo] = field(default_factory=dict[str, PolicyInfo])
    schema: Literal["lodbench.run-info/1"] = _SCHEMA


class Stopwatch:
    """Adds what a start of a study takes to what earlier ones took."""

    def __init__(self, folder: Path, study: str) -> None:
        self._info = _read(folder, study)
        self._info.starts += 1
        self._earlier_s, self._began_s = self._info.wall_s, time.monotonic()

    def add(self, owner: str, outcome: Outcome) -> None:
        """Count a run."""
        info = self._info.policies.setdefault(owner, PolicyInfo())
        info.runs += 1
        info.run_s += outcome.took_s
        info.slowest_run_s = max(info.slowest_run_s, outcome.took_s)
        info.peak_bytes = max(info.peak_bytes, outcome.peak_bytes)

    def write(self, folder: Path) -> None:
        """Write ``run-info.json``; raises `InputError` as `write_whole`."""
        self._info.wall_s = self._earlier_s + time.monotonic() - self._began_s
        self._info.policies = dict(sorted(self._info.policies.items()))
        write_whole(folder / RUN_INFO, encode_record(self._info))


def _read(folder: Path, study: str) -> RunInfo:
    with suppress(InputError):  # there is none yet, or it is damaged: nothing depends on it
        info = read_json(folder / RUN_INFO, RunInfo, _SCHEMA, "")
        if info.study == study:
            return info
    return RunInfo(study)
