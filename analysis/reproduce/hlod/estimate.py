"""R3: how well render time is estimated, with and without the feedback loop (section 6.3)."""

from collections.abc import Sequence

from ..experiment import Chart, Claim, Constant, Experiment, Findings, Line, verdict_of
from ..trial import Numbers, Trial, trial
from .runs import Runs, seeds
from .setting import CONSTANTS, THESIS, mean, spread

_NOISE = 0.15
_CORRELATION = 0.97
_RATES = (0.0, 0.1, 0.2, 0.5, 1.0)
_CORRELATIONS = (0.0, 0.9, 0.97, 0.99)
_RATE = 0.2


def _key(rate: float, correlation: float, seed: int) -> str:
    return f"rate {rate:g}/correlation {correlation:g}/{seed}"


def _run(rate: float, correlation: float, seed: int, reduced: bool) -> Trial:
    arguments = {
        "policy": f"{THESIS},time_rate={rate:g}",
        "path": "walk",
        "seed": seed,
        "frames": 500 if reduced else 700,
        "noise": _NOISE,
        "correlation": correlation,
    }
    return trial(_key(rate, correlation, seed), "hlod.setting:measure", arguments)


def _trials(reduced: bool) -> Sequence[Trial]:
    main = [
        _run(rate, _CORRELATION, seed, reduced) for rate in (0.0, _RATE) for seed in seeds(reduced)
    ]
    if reduced:
        return main
    # One seed will do to see what decides.
    sweep = [_run(rate, c, 0, reduced) for c in _CORRELATIONS for rate in _RATES]
    return list(dict.fromkeys(main + sweep))


def _of(numbers: Runs, rate: float, reduced: bool) -> list[Numbers]:
    return [numbers[_key(rate, _CORRELATION, seed)] for seed in seeds(reduced)]


def _sd_pct(numbers: Runs, rate: float, correlation: float) -> float:
    """Return the spread of the first seed's errors."""
    return numbers[_key(rate, correlation, 0)]["error_sd_pct"]


def _judge(numbers: Runs, reduced: bool) -> Findings:
    without = _of(numbers, 0.0, reduced)
    with_loop = _of(numbers, _RATE, reduced)
    sd_without, sd_with = (mean(runs, "error_sd_pct") for runs in (without, with_loop))
    half = sd_with <= 0.5 * sd_without
    means = f"{mean(without, 'error_mean_pct'):.2f} % and {mean(with_loop, 'error_mean_pct'):.2f} %"
    small = max(abs(mean(runs, "error_mean_pct")) for runs in (without, with_loop)) < 5.0
    claims = (
        Claim(
            "spread of the estimate's error without the loop",
            "15.19 %",
            f"{spread(without, 'error_sd_pct', 2)} %",
            "11 to 19 %, calibrated",
            verdict_of(11.0 <= sd_without <= 19.0, f"the spread is {sd_without:.2f} %"),
        ),
        Claim(
            "the loop's spread over that without",
            "0.26 (3.89 of 15.19 %)",
            f"{sd_with / sd_without:.2f} ({spread(with_loop, 'error_sd_pct', 2)} %)",
            "at most half",
            verdict_of(
                half,
                "with reports two frames late the loop follows no faster",
                direction=sd_with < sd_without,
            ),
        ),
        Claim(
            "mean error without and with the loop",
            "4.39 % and -2.01 %",
            means,
            "within 5 %",
            verdict_of(small, f"the means are {means}"),
        ),
    )
    if reduced:
        return Findings(claims)
    return Findings(claims, (_chart(numbers),), (_note(numbers),))


def _chart(numbers: Runs) -> Chart:
    lines = [
        Line(
            "independent noise" if correlation == 0.0 else f"correlated, {correlation:g}",
            _RATES,
            [_sd_pct(numbers, rate, correlation) for rate in _RATES],
        )
        for correlation in _CORRELATIONS
    ]
    lines.append(Line("printed, without and with", (0.0, _RATE), (15.19, 3.89), True))
    return Chart(
        name="rates",
        caption="The loop helps as far as errors last from frame to frame; noise that does not it "
        "makes worse.",
        x="rate of v_time (0: no loop)",
        y="standard deviation of the error, %",
        lines=tuple(lines),
    )


def _note(numbers: Runs) -> str:
    parts: list[str] = []
    for correlation in _CORRELATIONS:
        spreads = {rate: _sd_pct(numbers, rate, correlation) for rate in _RATES}
        best = min(_RATES[1:], key=spreads.__getitem__)
        parts.append(
            f"{correlation:g}: {spreads[best]:.1f} % at rate {best:g}, {spreads[0.0]:.1f} % without"
        )
    return (
        "What decides is how long errors last, which is not printed.  Best spread by the "
        f"correlation of successive frames' errors: {'; '.join(parts)}.  Printed: 3.89 %."
    )


ESTIMATE = Experiment(
    id="hlod/estimate",
    title="accuracy of the estimated render time (R3, figure 6.4)",
    setting="`city`, the walk, times that stray from the cost model by 15 % with a correlation of "
    "0.97 from frame to frame; the last 350 of 700 frames; 5 seeds.",
    constants={
        **CONSTANTS,
        "noise": Constant(
            "15 %, correlation 0.97", "calibrated", "so that 15.19 % comes out without the loop"
        ),
    },
    trials=_trials,
    judge=_judge,
)
