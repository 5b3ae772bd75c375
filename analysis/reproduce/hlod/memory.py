"""R5: memory stays under its bound (thesis, section 6.1)."""

from collections.abc import Sequence

import numpy as np

from ....models.machine.profile_catalog import load_hardware
from ....sim.loader import level_bytes
from ...study.engine.task import Beat
from ..experiment import Chart, Claim, Constant, Experiment, Findings, Line, verdict_of
from ..trial import Numbers, Trial, trial
from .runs import Runs
from .setting import CONSTANTS, THESIS, city, replay_city

_START = 0.16
_PEAK = 93.0
_PEAK_S = 95.0
_RATES_MB_S = (40.0, 100.0, 400.0)
_RATE_MB_S = 100.0
_SAMPLES_PER_S = 5.0  # as the thesis looked


def measure(*, rate_mb_s: float, frames: int, beat: Beat) -> Numbers:
    """Drive, and return the memory held, per cent of the bound, five times a second."""
    scene = city()
    assert load_hardware("thesis-m30-assumed").disk_bytes_per_s == _RATE_MB_S * 1e6
    node_bytes = level_bytes(scene)[scene.finest_row]
    bound_bytes = float(np.ceil(node_bytes[scene.roots]).sum()) / _START
    log, _ = replay_city(
        THESIS,
        "drive",
        frames=frames,
        disk_bytes_per_s=rate_mb_s * 1e6,
        memory_bytes=bound_bytes,
        beat=beat,
    )
    held_pct = 100.0 * log["memory_bytes"] / log.header.memory_bound_bytes
    time_s = log["input_ns"] * 1e-9
    at = np.searchsorted(time_s, np.arange(0.0, time_s[-1], 1.0 / _SAMPLES_PER_S))
    peak = int(np.argmax(held_pct >= 0.99 * held_pct.max()))
    return {
        "time_s": time_s[at].tolist(),
        "held_pct": held_pct[at].tolist(),
        "start_pct": float(held_pct[0]),
        "peak_pct": float(held_pct.max()),
        "peak_s": float(time_s[peak]),
        "after_sd_pct": float(held_pct[peak:].std()),
        "missing": float(log["missing"].max()),
        "bound_gb": bound_bytes / 1e9,
    }


def _trials(reduced: bool) -> Sequence[Trial]:
    rates = (_RATE_MB_S,) if reduced else _RATES_MB_S
    frames = 800 if reduced else 5_000
    return [
        trial(f"{rate:g}", "hlod.memory:measure", {"rate_mb_s": rate, "frames": frames})
        for rate in rates
    ]


def _judge(numbers: Runs, reduced: bool) -> Findings:
    mine = numbers[f"{_RATE_MB_S:g}"]
    start, peak, sd = (mine[name] for name in ("start_pct", "peak_pct", "after_sd_pct"))
    claims = [
        Claim(
            "memory just after the start",
            "16 %",
            f"{start:.1f} %",
            "calibrated",
            verdict_of(abs(start - 16.0) < 0.5, f"it is {start:.1f} %"),
        ),
        Claim(
            "memory never exceeds its bound, and nothing in view is left out",
            "'prevents memory usage from exceeding'",
            f"at most {max(one['peak_pct'] for one in numbers.values()):.2f} %, "
            f"{max(one['missing'] for one in numbers.values()):.0f} left out",
            "100 %",
            verdict_of(
                all(one["peak_pct"] <= 100.0 and not one["missing"] for one in numbers.values()),
                "it did",
            ),
        ),
    ]
    if not reduced:
        full = peak >= 0.9 * _PEAK
        claims.append(
            Claim(
                "it rises to a peak and stays there",
                f"{_PEAK:.0f} % at second {_PEAK_S:.0f}, then 'relatively flat'",
                f"{peak:.1f} % at second {mine['peak_s']:.0f}, then a standard deviation of "
                f"{sd:.1f} points",
                "at least 84 %, 3 points",
                verdict_of(
                    full and sd < 3.0,
                    f"the peak is {peak:.0f} % of a chosen bound, and the deviation {sd:.1f}",
                    direction=sd < 3.0 or full,
                ),
            )
        )
    lines = [Line(f"{key} MB/s", one["time_s"], one["held_pct"]) for key, one in numbers.items()]
    lines.append(Line("printed: start and peak", (0.0, _PEAK_S), (16.0, _PEAK), True))
    chart = Chart(
        name="memory",
        caption="Memory fills as fast as the disk lets it, and stops at its bound.",
        x="seconds of the drive",
        y="memory held, % of the bound",
        lines=tuple(lines),
    )
    reached = "; ".join(
        f"{key} MB/s: {one['peak_pct']:.0f} % at second {one['peak_s']:.0f}"
        for key, one in numbers.items()
    )
    note = (
        f"The bound, {mine['bound_gb']:.1f} GB, is the roots' bytes over 0.16, since neither is "
        "printed: textures count as RGBA with their smaller copies, and the thesis' own figure, "
        "935 bytes a unit of cost, makes the same roots 0.10 GB.  The speed of the disk decides "
        f"when memory is full: {reached}."
    )
    return Findings(tuple(claims), (chart,), (note,))


MEMORY = Experiment(
    id="hlod/memory",
    title="memory management (R5, figure 6.1)",
    setting="`city`, the drive at 14 m/s, nodes with their textures read while driving; 5,000 "
    "frames, looked at five times a second.",
    constants={
        **CONSTANTS,
        "bound of memory": Constant("roots / 0.16", "calibrated", "so that 16 % is held at first"),
    },
    trials=_trials,
    judge=_judge,
)
