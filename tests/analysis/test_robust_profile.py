"""The bundled llvmpipe profile can be made again from the logs, and predicts what it says."""

from pathlib import Path

import numpy as np
import pytest

from lodbench.analysis.robust_fit import heldout_errors_pct, robust_nnls
from lodbench.analysis.robust_profile import (
    file_sha256,
    frames_of,
    profile_from_logs,
    residual_model,
)
from lodbench.models.profile_catalog import load_hardware
from lodbench.models.profile_writer import profile_toml
from lodbench.traces.read_log import read_render_log
from lodbench.traces.renderlog import RenderLog

TERMS = ("draw_calls", "triangles")


@pytest.fixture(scope="module")
def logs(data_dir: Path) -> list[RenderLog]:
    """Read the two logs that were measured with one thread."""
    names = ("random", "distance")
    return [read_render_log(data_dir / "logs" / f"llvmpipe-1thread-{name}-a.csv") for name in names]


@pytest.mark.realdata
def test_the_bundled_profile_is_what_the_logs_give(logs: list[RenderLog], data_dir: Path):
    """Fitting the logs again gives the file in the package, draws and all."""
    bundled = load_hardware("llvmpipe")
    files = [data_dir / "logs" / f"{log.name}.csv" for log in logs]
    again = profile_from_logs(
        logs,
        TERMS,
        np.random.default_rng(0),
        name="llvmpipe",
        source="; ".join(f"{file.name} (sha256 {file_sha256(file)})" for file in files),
        date=bundled.provenance.date,
    )
    assert again.provenance == bundled.provenance
    assert again.gpu.linear_ms == pytest.approx(bundled.gpu.linear_ms, rel=1e-3)
    assert again.posterior is not None
    assert bundled.posterior is not None
    assert again.posterior.linear_ms == pytest.approx(bundled.posterior.linear_ms, rel=1e-2)
    assert len(profile_toml(again).splitlines()) == len(profile_toml(bundled).splitlines())


@pytest.mark.realdata
def test_held_out_errors_are_those_in_the_profile(logs: list[RenderLog]):
    """Even frames predict odd ones to 1.2 % ± 10.8 %, one log the other to 10.7 % ± 12.6 %."""
    (x, y), (u, v) = [frames_of(log, TERMS, "frame_ms") for log in logs]
    both_x, both_y = np.vstack([x, u]), np.concatenate([y, v])
    even = robust_nnls(both_x[::2], both_y[::2])
    error = heldout_errors_pct(even, both_x[1::2], both_y[1::2])
    assert (error.mean(), error.std()) == pytest.approx((1.2, 10.8), abs=0.1)
    across = heldout_errors_pct(robust_nnls(x, y), u, v)
    assert (across.mean(), across.std()) == pytest.approx((10.7, 12.6), abs=0.1)


@pytest.mark.realdata
def test_shaded_samples_would_add_nothing(logs: list[RenderLog]):
    """The term that the profile leaves out does not lower the held-out error."""
    spread: list[float] = []
    for terms in (TERMS, (*TERMS, "shaded_samples")):
        parts = [frames_of(log, terms, "frame_ms") for log in logs]
        x, y = np.vstack([part[0] for part in parts]), np.concatenate([part[1] for part in parts])
        spread.append(
            float(heldout_errors_pct(robust_nnls(x[::2], y[::2]), x[1::2], y[1::2]).std())
        )
    assert spread[1] > spread[0]


def test_the_residual_model_recovers_what_made_the_residuals():
    """An autoregression with known correlation, tails and scale is found again."""
    rng = np.random.default_rng(6)
    fresh = rng.standard_t(4, 20_000) * 0.05 * np.sqrt(1.0 - 0.8**2)
    series = np.zeros(20_000)
    for k in range(1, len(series)):
        series[k] = 0.8 * series[k - 1] + fresh[k]
    model = residual_model([series[:10_000], series[10_000:]])
    assert model.correlation == pytest.approx(0.8, abs=0.02)
    assert model.scale == pytest.approx(0.05, rel=0.05)
    assert model.dof == pytest.approx(4.0, rel=0.15)
