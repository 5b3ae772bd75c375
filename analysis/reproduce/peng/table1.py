"""Table 1: what selection, reformation and rendering take for 32 to 8,192 characters."""

from collections.abc import Mapping, Sequence

import numpy as np

from ..experiment import Chart, Claim, Constant, Experiment, Findings, Line, error_pct, verdict_of
from ..trial import Numbers, Trial, trial
from .crowds import PIPELINE
from .printed import TABLE_1, Row
from .stages import Stages, fit, fit_stages

_RENDERING_PCT, _RENDERING_MEAN_PCT = 12.0, 5.0
_FPS_PCT, _FPS_LEFT_OUT_PCT = 5.0, 7.0
_STAGE_PCT = 15.0
_SUM_PCT = 0.1
_REDUCED = (32, 512, 2_048)


def table1_trials(reduced: bool) -> list[Trial]:
    """Return one trial a row; `peng/fig5` has the same ones."""
    return [
        trial(
            f"crowd-{row.instances}",
            "peng.crowds:with_triangles",
            {"instances": row.instances, "triangles": row.triangles},
        )
        for row in table1_rows(reduced)
    ]


def table1_rows(reduced: bool) -> Sequence[Row]:
    """Return the rows that are measured."""
    return [row for row in TABLE_1 if not reduced or row.instances in _REDUCED]


def _judge(numbers: Mapping[str, Numbers], reduced: bool) -> Findings:
    rows = table1_rows(reduced)
    measured = [numbers[f"crowd-{row.instances}"] for row in rows]
    fps = [1e3 / one["frame_ms"] for one in measured]
    without = {row.instances: fit_stages(row.instances) for row in TABLE_1}
    claims = (
        _serial_claim(),
        _rendering_claim(without),
        _fps_claim("in sample (calibrated), simulated", rows, fps, _FPS_PCT),
        _fps_claim("each row left out", TABLE_1, _left_out_fps(without), _FPS_LEFT_OUT_PCT),
        _stages_claim(without),
        _rest_claim(measured),
    )
    found = ", ".join(
        f"{one['vertices']:,} for {row.instances:,}"
        for row, one in zip(rows, measured, strict=True)
    )
    notes = (
        (
            "N is not printed: it was searched for until as many triangles were drawn as are "
            f"printed ({found} characters).  So triangles match by calibration, and times test "
            "costs alone."
        ),
        _selection_note(),
    )
    return Findings(claims, (_chart(rows, fps, without),), notes)


def _left_out_fps(without: Mapping[int, Stages]) -> list[float]:
    return [1e3 / without[row.instances].frame_ms(row.instances, row.triangles) for row in TABLE_1]


def _serial_claim() -> Claim:
    worst = max(abs(error_pct(1e3 / row.frame_ms, row.fps)) for row in TABLE_1)
    return Claim(
        "selection, reformation, animation and rendering follow one another",
        "a frame is the sum of its columns",
        f"1000 / sum is within {worst:.2f} % of the printed frames a second, nine rows",
        f"{_SUM_PCT:g} %",
        verdict_of(worst <= _SUM_PCT, "something overlaps, or is missing from the columns"),
    )


def _rendering_claim(without: Mapping[int, Stages]) -> Claim:
    errors = [
        error_pct(without[row.instances].rendering_ms(row.triangles), row.rendering_ms)
        for row in TABLE_1
    ]
    worst, mean = np.abs(errors).max(), np.abs(errors).mean()
    holds = worst <= _RENDERING_PCT and mean <= _RENDERING_MEAN_PCT
    return Claim(
        "rendering is a base and so much a triangle, each row left out and predicted",
        f"{TABLE_1[0].rendering_ms:g} to {TABLE_1[-1].rendering_ms:g} ms",
        f"within {worst:.1f} %, mean {mean:.1f} %",
        f"{_RENDERING_PCT:g} %, mean {_RENDERING_MEAN_PCT:g} %",
        verdict_of(bool(holds), "rendering does not go with triangles alone"),
    )


def _fps_claim(how: str, rows: Sequence[Row], fps: Sequence[float], tolerance: float) -> Claim:
    errors = [error_pct(ours, row.fps) for ours, row in zip(fps, rows, strict=True)]
    at = int(np.abs(errors).argmax())
    return Claim(
        f"frames a second, {how}",
        f"{rows[0].fps:g} to {rows[-1].fps:g}",
        f"{fps[0]:.0f} to {fps[-1]:.1f}; worst {errors[at]:+.1f} % at {rows[at].instances:,}",
        f"{tolerance:g} %",
        verdict_of(abs(errors[at]) <= tolerance, "three straight lines are too few for the table"),
    )


def _stages_claim(without: Mapping[int, Stages]) -> Claim:
    selection = [
        error_pct(without[row.instances].selection_ms(row.instances), row.selection_ms)
        for row in TABLE_1
    ]
    reformation = [
        error_pct(
            without[row.instances].reformation_ms(row.instances, row.triangles),
            row.reformation_ms,
        )
        for row in TABLE_1
    ]
    worst = float(np.abs(selection).max()), float(np.abs(reformation).max())
    return Claim(
        "selection rises with each doubling of the crowd, reformation with triangles and "
        "characters, each row left out and predicted",
        "0.28 to 0.58 ms, 0.084 to 3.08 ms",
        f"selection within {worst[0]:.1f} %, reformation within {worst[1]:.1f} %",
        f"{_STAGE_PCT:g} %",
        verdict_of(max(worst) <= _STAGE_PCT, "one of them follows another law"),
    )


def _rest_claim(measured: Sequence[Numbers]) -> Claim:
    same = all(one["first_ms"] == one["last_ms"] for one in measured)
    share = max(abs(one["first_ms"] / one["last_ms"] - 1.0) for one in measured)
    return Claim(
        "every frame selects and reforms every character, so that a camera at rest saves nothing",
        "in series, in each frame",
        f"later frames at rest differ from the first by {share:.1e} of its time",
        "1e-9",
        verdict_of(same or share <= 1e-9, "later frames cost something else"),
    )


def _selection_note() -> str:
    instances = np.array([float(row.instances) for row in TABLE_1])
    ms = np.array([row.selection_ms for row in TABLE_1])
    errors = [
        float(np.abs(terms @ fit((np.ones(len(ms)), terms[:, 1]), ms.tolist()) / ms - 1.0).max())
        for terms in (
            np.stack((np.ones(len(ms)), instances), 1),
            np.stack((np.ones(len(ms)), np.log2(instances)), 1),
        )
    ]
    return (
        "How selection grows decides frames a second at both ends: a line in the number of "
        f"characters misses the printed selection times by up to {1e2 * errors[0]:.0f} %, a line "
        f"in its logarithm by up to {1e2 * errors[1]:.0f} %."
    )


def _chart(rows: Sequence[Row], fps: Sequence[float], without: Mapping[int, Stages]) -> Chart:
    everyone = [float(row.instances) for row in TABLE_1]
    return Chart(
        name="fps",
        caption="Frames a second of nine crowds: three stages in series, a few straight lines, "
        "come within a few per cent of all that is printed.",
        x="characters",
        y="frames a second",
        lines=(
            Line("printed", everyone, [row.fps for row in TABLE_1], printed=True),
            Line("simulated", [float(row.instances) for row in rows], fps),
            Line("each row left out", everyone, _left_out_fps(without)),
        ),
        log_x=True,
        log_y=True,
    )


_FITTED = "fitted to Table 1"

TABLE1 = Experiment(
    id="peng/table1",
    title="Frame times of crowds of 32 to 8,192 characters",
    setting=f"crowd-32 to crowd-8192 under peng with N in vertices, a camera beyond a corner that "
    f"sees all of them, machine {PIPELINE}, four frames at rest.",
    constants={
        "alpha": Constant("3", "printed", "section 6.2"),
        "vertices and triangles of a character": Constant("1,642 and 2,620", "printed", "6.1"),
        "N": Constant("see the note", "calibrated", "so that triangles are those printed"),
        "base and a triangle of rendering": Constant("1.494 ms, 30.2 ns", "calibrated", _FITTED),
        "base and a doubling of selection": Constant("0.124 ms, 0.031 ms", "calibrated", _FITTED),
        "base, a triangle and a character of reformation": Constant(
            "0.049 ms, 0.82 ns, 174 ns", "calibrated", _FITTED
        ),
        "camera": Constant("8 m beyond a corner, 6 m up, 12 degrees down", "assumed"),
    },
    trials=table1_trials,
    judge=_judge,
)
