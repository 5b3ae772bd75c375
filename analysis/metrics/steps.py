"""Steps in the visible load, and how a run answers each.

The load is ``full_gpu_ms``: the noise-free GPU time had everything in view been drawn at full
detail.  No decision of a policy changes it, so that every policy is judged at the same steps.
"""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import BoolArray
from .measured_frames import MS_PER_NS, MeasuredFrames

RISE = 1.25
"""A step is a rise of the load by a quarter..."""
RISE_NS = 100_000_000
"""...within 100 ms (6 frames at 60 Hz), to more than the budget.  A lower load asks nothing of
anyone."""
APART_NS = 500_000_000
"""Rises closer than this belong to one step."""
HORIZON_NS = 5_000_000_000
"""Longest response: the slowest controllers that ship act within 4 s."""
HOLD_NS = 250_000_000
"""The budget is regained when it holds this long..."""
HOLD_SHARE = 0.9
"""...in this share of frames..."""
TOLERANCE = 1.1
"""...up to this factor, since measured times scatter by some per cent about any model."""


@dataclass(frozen=True, slots=True)
class Step:
    """One step and the answer to it.

    Attributes
    ----------
    frame : int
        First frame of the rise, counted from the first measured frame.
    time_ms : float
        Simulated time of that frame's input.
    load_before_ms, load_after_ms : float
        Load before the rise and at its highest.
    settle_ms : float
        From the step to the input of the first frame from which the budget holds; if that never
        comes, to the end of the response, a lower bound.
    settled : bool
    overshoot_ratio : float
        Largest work_ms over the budget, from the step until it has held for `HOLD_NS`; at most 1
        if the budget was never exceeded.
    """

    frame: int
    time_ms: float
    load_before_ms: float
    load_after_ms: float
    settle_ms: float
    settled: bool
    overshoot_ratio: float


def find_steps(run: MeasuredFrames) -> tuple[Step, ...]:
    """Return the steps of the visible load in a run, in order.

    A rise in the last `HOLD_NS` of the run is left out: no answer to it can be judged.
    """
    load = run["full_gpu_ms"]
    time_ns = run.input_ns
    reference = np.searchsorted(time_ns, time_ns - RISE_NS, side="right") - 1
    rising = (reference >= 0) & (load >= RISE * load[reference]) & (load > run.header.budget_ms)
    rising &= _can_hold(run)
    frames = np.flatnonzero(rising)
    if not len(frames):
        return ()
    first = np.concatenate(((True,), np.diff(time_ns[frames]) >= APART_NS))
    onset = frames[first]
    top = frames[np.append(np.flatnonzero(first)[1:], len(frames)) - 1]
    end = np.append(onset[1:], len(run))
    horizon = np.searchsorted(time_ns, time_ns[onset] + HORIZON_NS, side="right")
    holds = _holds(run)
    return tuple(
        _answer(run, int(i), int(reference[i]), int(j), int(min(k, h)), holds)
        for i, j, k, h in zip(onset, top, end, horizon, strict=True)
    )


def _can_hold(run: MeasuredFrames) -> BoolArray:
    return run.input_ns + HOLD_NS <= run.input_ns[-1]


def _holds(run: MeasuredFrames) -> BoolArray:
    """Return whether the budget holds from each frame on, (n,)."""
    good = run.work_ms <= TOLERANCE * run.header.budget_ms
    until = np.searchsorted(run.input_ns, run.input_ns + HOLD_NS, side="right")
    count = np.concatenate(((0,), np.cumsum(good)))
    here = np.arange(len(run))
    share = (count[until] - count[here]) / (until - here)
    return good & (share >= HOLD_SHARE) & _can_hold(run)


def _answer(
    run: MeasuredFrames, onset: int, before: int, top: int, end: int, holds: BoolArray
) -> Step:
    settled = bool(holds[onset:end].any())
    last = onset + int(holds[onset:end].argmax()) if settled else end - 1
    start_ns, last_ns = int(run.input_ns[onset]), int(run.input_ns[last])
    held = min(int(np.searchsorted(run.input_ns, last_ns + HOLD_NS, side="right")), end)
    return Step(
        frame=onset,
        time_ms=start_ns * MS_PER_NS,
        load_before_ms=float(run["full_gpu_ms"][before]),
        load_after_ms=float(run["full_gpu_ms"][onset : top + 1].max()),
        settle_ms=(last_ns - start_ns) * MS_PER_NS,
        settled=settled,
        overshoot_ratio=float(run.work_ms[onset:held].max() / run.header.budget_ms),
    )
