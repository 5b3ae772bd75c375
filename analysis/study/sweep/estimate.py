"""What a study would take: from a timed sample of its runs."""

import math
import time
from dataclasses import dataclass, replace

from ..axes.blocks import Case
from ..engine.task import Engine, Outcome
from ..results.parts import size_of
from ..results.record import Entry, encode
from ..results.store import ROWS
from ..run import Run
from ..score import Scored
from ..study import Study

FRAMES = 300
"""Of a sampled run; the rest of its path is taken to be like them."""
LONGEST_S = 60.0
"""No run is sampled later than this."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """What a study would take.

    Attributes
    ----------
    runs : int
    sampled, kinds : int
        Runs that were timed, and kinds of runs, a policy in a scene each.
    run_s : float
        Time of all runs one after the other.
    disk_bytes : float
        Of the results.
    """

    runs: int
    sampled: int
    kinds: int
    run_s: float
    disk_bytes: float


def estimate(study: Study, engine: Engine) -> Estimate:
    """Time a run of each policy in each scene, and return what all would take.

    Raises `InputError` as `Study.run_list`, or if the parameters of a policy are refused.
    """
    kinds = list(study.kinds())
    if not kinds:
        study.run_list()  # says why there are none
    # Each twice: the first pays for what a process loads once.
    cases = [case for _, case in kinds]
    tasks = [_shortened(case.run) for case in cases for _ in range(2)]
    found: dict[int, Outcome] = {}
    began_s = time.monotonic()
    with engine:
        for outcome in engine.run(tasks, stop=False):
            if outcome.index % 2:
                found[outcome.index // 2] = outcome
            if time.monotonic() - began_s > LONGEST_S and found:
                break
    times = {at: _whole_run_s(study, cases[at].run, outcome) for at, outcome in found.items()}
    mean_s = sum(times.values()) / len(times)
    by_policy = {cases[at].cells["policy"]: took_s for at, took_s in times.items()}
    run_s = sum(
        count * times.get(at, by_policy.get(case.cells["policy"], mean_s))
        for at, (count, case) in enumerate(kinds)
    )
    disk_bytes = _disk_bytes(study, cases, found)
    return Estimate(len(study), len(found), len(kinds), run_s, disk_bytes)


def _shortened(run: Run) -> Run:
    # Without a warm-up, which so few frames may not outlast.
    options = replace(run.options, frames=FRAMES)
    return replace(run, options=options, warmup_s=0.0, keeps_log=True)


def _whole_run_s(study: Study, run: Run, outcome: Outcome) -> float:
    """Return the time of a run as long as it was asked for."""
    result = outcome.result
    if not isinstance(result, Scored) or result.log is None:
        return outcome.took_s
    trace_s = study.inputs[run.trace].duration_s
    covered_s = 1e-9 * float(result.log["input_ns"][-1])
    longer = trace_s / covered_s if covered_s > 0.0 else 1.0
    return outcome.took_s * max(longer, 1.0)


def _disk_bytes(study: Study, cases: list[Case], found: dict[int, Outcome]) -> float:
    """Return the size of files with a row for each run, from that of a file of the sample."""
    order = sorted(found)
    runs = study.run_list(cases[at] for at in order)
    entries: list[Entry] = []
    for at, index in enumerate(order):
        result = found[index].failure or found[index].result
        entries.append(
            Entry(at, replace(result, log=None) if isinstance(result, Scored) else result)
        )
    empty_bytes = size_of(encode(runs, []))
    row_bytes = (size_of(encode(runs, entries)) - empty_bytes) / len(entries)
    return len(study) * row_bytes + math.ceil(len(study) / ROWS) * empty_bytes
