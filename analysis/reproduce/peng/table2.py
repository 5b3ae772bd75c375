"""Table 2: how reformation grows with triangles and characters."""

from collections.abc import Mapping, Sequence

import numpy as np

from ....base.arrays import FloatArray
from ..experiment import Chart, Claim, Constant, Experiment, Findings, Line, verdict_of
from ..trial import Numbers, Trial
from .printed import TABLE_1, TABLE_2
from .stages import fit_reformation

_TOLERANCE_PCT = 5.0


def _trials(_reduced: bool) -> list[Trial]:
    # Printed numbers alone.
    return []


def _predict(coefficients: FloatArray) -> FloatArray:
    terms = [(1.0, float(row.triangles), float(row.instances)) for row in TABLE_2]
    return np.array(terms) @ coefficients


def _errors(ms: FloatArray, *, ratios: bool) -> FloatArray:
    """Return errors of times, or of their ratios to 2,048 characters, in per cent."""
    printed = np.array([row.reformation_ms for row in TABLE_2])
    if ratios:
        ms, printed = ms / ms[0], printed / printed[0]
    return 100.0 * (ms / printed - 1.0)


def _judge(_numbers: Mapping[str, Numbers], _reduced: bool) -> Findings:
    itself = _predict(fit_reformation(TABLE_2))
    alone = _predict(fit_reformation(TABLE_2, characters=False))
    table_1 = _predict(fit_reformation(TABLE_1))
    left_out = np.array(
        [
            _predict(fit_reformation([*TABLE_2[:row], *TABLE_2[row + 1 :]]))[row]
            for row in range(len(TABLE_2))
        ]
    )
    proportional = np.array([float(row.triangles) for row in TABLE_2])
    claims = (
        _claim(
            "ratios, by triangles and characters fitted to it (calibrated)",
            _errors(itself, ratios=True),
        ),
        _claim("times, each row left out and predicted", _errors(left_out, ratios=False)),
        _claim("times, predicted from Table 1", _errors(table_1, ratios=False)),
        _claim(
            "ratios, predicted from Table 1",
            _errors(table_1, ratios=True),
            "the tables print 0.89 and 0.95 ms for the same 2,048 characters, which all ratios "
            "stand on",
        ),
        _claim(
            'ratios, by triangles alone: "the linear relation"',
            _errors(proportional, ratios=True),
            "characters cost something of their own, too",
        ),
    )
    short = float(_errors(alone, ratios=False)[-1])
    at_largest = float(_errors(proportional, ratios=True)[-1])
    notes = (
        (
            f"A base and triangles alone, fitted to this table, are {-short:.1f} % short at 32,768 "
            f"characters; in proportion to triangles, {-at_largest:.1f} %."
        ),
    )
    return Findings(claims, (_chart(itself, table_1, proportional),), notes)


def _claim(what: str, errors: FloatArray, why: str = "more is at work than these terms") -> Claim:
    worst = float(np.abs(errors).max())
    holds = worst <= _TOLERANCE_PCT
    return Claim(
        f"reformation of 2,048 to 32,768 characters: {what}",
        "1.00, 1.84, 3.24, 5.49, 11.02" if "ratios" in what else "0.95 to 10.47 ms",
        ", ".join(f"{error:+.1f} %" for error in errors),
        f"{_TOLERANCE_PCT:g} %",
        verdict_of(holds, why, direction=worst <= 3.0 * _TOLERANCE_PCT and "alone" in what),
    )


def _chart(itself: FloatArray, table_1: FloatArray, triangles: FloatArray) -> Chart:
    instances = [float(row.instances) for row in TABLE_2]
    ratios = (itself / itself[0], table_1 / table_1[0], triangles / triangles[0])
    labels = ("triangles and characters", "the same, from Table 1", "triangles alone")
    lines: Sequence[Line] = [
        Line(label, instances, ratio.tolist()) for label, ratio in zip(labels, ratios, strict=True)
    ]
    printed = [row.reformation_ms / TABLE_2[0].reformation_ms for row in TABLE_2]
    return Chart(
        name="ratios",
        caption="Reformation over that of 2,048 characters: triangles alone fall short of the "
        "largest crowds, characters make up for it.",
        x="characters",
        y="times that of 2,048",
        lines=(Line("printed", instances, printed, printed=True), *lines),
        log_x=True,
        log_y=True,
    )


TABLE2 = Experiment(
    id="peng/table2",
    title="Scaling of reformation",
    setting="The printed times against a base, so much a triangle and so much a character; nothing "
    "is simulated.",
    constants={
        "base, a triangle, a character": Constant(
            "0.083 ms, 0.94 ns, 138 ns", "calibrated", "three numbers fitted to five rows"
        )
    },
    trials=_trials,
    judge=_judge,
)
