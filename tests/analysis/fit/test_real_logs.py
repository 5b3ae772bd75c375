"""Measured logs: llvmpipe's, and the table that a paper printed."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import nnls

from lodbench.analysis.fit.assessment.heldout import HeldOut, hold_out
from lodbench.analysis.fit.bundled_logs import bundled_log
from lodbench.analysis.fit.estimate import estimate
from lodbench.analysis.fit.fit import FitOptions, Source, fit_logs
from lodbench.analysis.fit.fit_frames import Sample, gather
from lodbench.analysis.fit.fit_table import THESIS
from lodbench.analysis.fit.sampling.sampler import SamplerOptions
from lodbench.analysis.fit.terms import parse_terms, predictors_of
from lodbench.traces.logs.read_log import read_render_log
from lodbench.traces.logs.render_log import RenderLog

TERMS = parse_terms("draw_calls,triangles")


def read(data_dir: Path, name: str) -> RenderLog:
    """Read one of llvmpipe's logs."""
    return read_render_log(data_dir / "logs" / f"llvmpipe-{name}-a.csv")


def frames_of(log: RenderLog) -> Sample:
    """Return the frames that measure frame_ms."""
    return gather([log], predictors_of(TERMS), "frame_ms", None)[0]


def shown(name: str, found: HeldOut) -> None:
    """Print an error beside the thesis's."""
    quantiles = ", ".join(f"{value:.1f}" for value in found.error_pct_quantiles)
    print(
        f"{name}, {found.split}: error {found.error_pct_mean:.2f} % ± {found.error_pct_sd:.2f} %, "
        f"5 to 95 % {quantiles}; 90 % coverage {found.coverage_90:.1%}; {THESIS}"
    )


@pytest.mark.realdata
@pytest.mark.parametrize("name", ["random", "distance"])
def test_held_out_halves_are_predicted(data_dir: Path, name: str):
    """Five folds of blocks of 25 frames: mean error within 3 %, coverage of 80 % or more.

    More than 90 % is covered where intervals allow for slow states that frames of one log share.
    """
    sample = frames_of(read(data_dir, name))
    found = hold_out(sample, TERMS, "student-t", SamplerOptions(), "blocks")
    shown(name, found)
    assert abs(found.error_pct_mean) <= 3.0
    assert 0.80 <= found.coverage_90 <= 0.995
    assert found.reason == ""


@pytest.mark.slow
@pytest.mark.realdata
@pytest.mark.parametrize("name", ["random", "distance"])
def test_first_halves_do_not_predict_second_ones_and_say_why(data_dir: Path, name: str):
    """The second half of each log ran faster for the same counts; the error is reported.

    It is that of non-negative least squares, which like the fit keeps what frames take on average.
    """
    sample = frames_of(read(data_dir, name))
    found = hold_out(sample, TERMS, "student-t", SamplerOptions(), "halves")
    shown(name, found)
    half = len(sample) // 2
    columns = np.column_stack((np.ones(len(sample)), sample.predictors))
    columns /= columns.mean(axis=0)
    costs, _ = nnls(columns[:half], sample.time_ms[:half])
    expected = 100.0 * float((columns[half:] @ costs / sample.time_ms[half:]).mean() - 1.0)
    assert expected > 5.0
    assert found.error_pct_mean == pytest.approx(expected, abs=3.0)
    assert "what the fit leaves open" in found.reason


@pytest.mark.slow
@pytest.mark.realdata
def test_transfer_to_another_log_is_reported_with_its_reason(data_dir: Path):
    """Random views do not tell draws from triangles, and so do not predict other mixtures."""
    options = FitOptions("draw_calls,triangles", heldout="none")
    fit = fit_logs(
        [Source(read(data_dir, "random"))],
        "frame_ms",
        options,
        transfer=[read(data_dir, "distance")],
    )
    (found,) = fit.transfer
    shown("random", found)
    assert found.split == "llvmpipe-distance-a"
    assert abs(found.error_pct_mean) > 3.0
    assert "times the triangles of the fitted ones" in found.reason
    assert "coefficients are too uncertain" in found.reason


@pytest.fixture(scope="module")
def peng() -> Sample:
    """Return the nine rows of Peng's Table 1, which is bundled."""
    path = bundled_log("peng2011")
    assert path is not None
    return gather([read_render_log(path)], ["triangles"], "gpu_ms", None)[0]


def test_the_rows_of_peng_add_up(peng: Sample):
    """Selection, reformation and rendering of a row fill a frame at the rate that is printed."""
    path = bundled_log("peng2011")
    assert path is not None
    rows: Any = np.loadtxt(path, delimiter=",", comments=("#", "instances"))
    assert len(peng) == len(rows) == 9
    total = rows[:, 2] + rows[:, 3] + rows[:, 4]
    assert total == pytest.approx(1e3 / rows[:, 1], rel=0.01)


def test_least_squares_of_peng(peng: Sample):
    """1.738 ms and 29.30 ns a triangle, R² 0.99986."""
    triangles = peng.column("triangles")
    slope, base = np.polyfit(triangles, peng.time_ms, 1)
    residual = peng.time_ms - base - slope * triangles
    r2 = 1.0 - residual.var() / peng.time_ms.var()
    assert (base, 1e6 * slope) == pytest.approx((1.738, 29.30), abs=5e-3)
    assert r2 == pytest.approx(0.99986, abs=1e-5)


def test_the_posterior_of_peng_agrees_with_least_squares(peng: Sample):
    """Means within half a deviation, and deviations those of least squares."""
    terms = parse_terms("triangles")
    found = estimate(peng, terms, "gaussian", SamplerOptions()).coefficients_ms
    mean, spread = found.mean(axis=0), found.std(axis=0)
    assert mean == pytest.approx([1.738, 29.30e-6], abs=float(spread.max()))
    assert abs(mean[1] - 29.30e-6) < 0.5 * spread[1]
    assert spread == pytest.approx([0.13, 0.16e-6], rel=0.35)
    print(f"posterior {mean} ± {spread}")


@pytest.mark.slow
def test_each_row_of_peng_is_predicted_from_the_others(peng: Sample):
    """Left out in turn, to a few per cent."""
    left_out = hold_out(peng, parse_terms("triangles"), "gaussian", SamplerOptions(), "auto")
    shown("peng2011", left_out)
    assert left_out.split == "leave-one-out"
    assert left_out.rows == 9
    assert abs(left_out.error_pct_mean) < 3.0
    assert left_out.error_pct_sd < 8.0
