"""R1 and R2: how much of what is drawn is drawn at the coarsest level (thesis, section 6.2)."""

from collections.abc import Sequence

from ..experiment import Chart, Claim, Experiment, Findings, Line, verdict_of
from ..trial import Numbers, Trial
from .runs import Runs, of_seeds, runs
from .setting import CONSTANTS, SHARED, THESIS, mean

_SETTING = (
    "`city` ({where}), 30 ms on the assumed machine `thesis-m30-assumed`; 400 frames from where "
    "the roots' share has settled; 5 seeds of noise."
)


def _trials(path: str, *, reduced: bool) -> list[Trial]:
    return [*runs(THESIS, path, reduced=reduced), *runs(SHARED, path, reduced=reduced)]


def _range(numbers: Sequence[Numbers]) -> tuple[float, float]:
    """Return the least and largest share of the coarsest level in any frame, per cent."""
    low = min(one["roots_low"] for one in numbers)
    return 100.0 * low, 100.0 * max(one["roots_high"] for one in numbers)


def _chart(numbers: Runs, path: str, printed: tuple[float, float], caption: str) -> Chart:
    lines = [
        Line(label, list(range(len(one["roots"]))), [100.0 * share for share in one["roots"]])
        for label, policy in (("thesis' own", THESIS), ("unused slices shared", SHARED))
        for one in of_seeds(numbers, policy, path, reduced=True)
    ]
    frames = [0.0, float(len(lines[0].x))]
    lines += [Line(f"printed, {share:.0f} %", frames, [share] * 2, True) for share in printed]
    return Chart(
        name="roots",
        caption=caption,
        x="frame",
        y="hlod0 of nodes drawn, %",
        lines=tuple(lines),
    )


def _claim(numbers: Runs, path: str, printed: tuple[float, float], *, reduced: bool) -> Claim:
    low, high = _range(of_seeds(numbers, THESIS, path, reduced=reduced))
    other = _range(of_seeds(numbers, SHARED, path, reduced=reduced))
    holds = printed[0] - 5.0 <= low and high <= printed[1] + 5.0
    overlaps = low <= printed[1] and high >= printed[0]
    return Claim(
        f"share of hlod0 among nodes drawn, {path}",
        f"{printed[0]:.0f} to {printed[1]:.0f} %",
        f"{low:.0f} to {high:.0f} % (unused slices shared: {other[0]:.0f} to {other[1]:.0f} %)",
        "5 points either side, every frame" + ("; calibrated" if path == "orbit" else ""),
        verdict_of(holds, f"frames range over {low:.0f} to {high:.0f} %", direction=overlaps),
    )


def _judge_fly(numbers: Runs, reduced: bool) -> Findings:
    mine = of_seeds(numbers, THESIS, "orbit", reduced=reduced)
    note = (
        "The match is a calibration: the time of a unit of cost was chosen so that the roots alone "
        f"take 24 of 30 ms; the mean frame here takes {mean(mine, 'ms_mean'):.1f} ms."
    )
    caption = "With the whole city in view nearly all time goes to the coarsest level."
    chart = _chart(numbers, "orbit", (80.0, 90.0), caption)
    return Findings((_claim(numbers, "orbit", (80.0, 90.0), reduced=reduced),), (chart,), (note,))


def _judge_walk(numbers: Runs, reduced: bool) -> Findings:
    claim = _claim(numbers, "walk", (20.0, 45.0), reduced=reduced)
    caption = "On the ground most walls are out of view, and the rest are drawn finer."
    chart = _chart(numbers, "walk", (20.0, 45.0), caption)
    note = (
        "The range goes with the disk: where nodes come late, roots stand in for them "
        "(see the sweep of hlod/toggles)."
    )
    return Findings((claim,), (chart,), (note,))


FLY = Experiment(
    id="hlod/fly",
    title="the whole model in view: detail drawn (R1, figure 6.2)",
    setting=_SETTING.format(where="a circle of 750 m, 450 m high, that looks at its middle"),
    constants=CONSTANTS,
    trials=lambda reduced: _trials("orbit", reduced=reduced),
    judge=_judge_fly,
)

WALK = Experiment(
    id="hlod/walk",
    title="at ground level: detail drawn (R2, figure 6.3)",
    setting=_SETTING.format(where="along the streets at 1.4 m/s"),
    constants=CONSTANTS,
    trials=lambda reduced: _trials("walk", reduced=reduced),
    judge=_judge_walk,
)
