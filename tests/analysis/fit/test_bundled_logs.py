"""Bundled logs, and the bundled profiles that were fitted to them."""

import hashlib
from dataclasses import replace

import numpy as np
import pytest

from lodbench.analysis.fit.bundled_logs import bundled_fit, bundled_log, list_logs
from lodbench.analysis.fit.fit import FitOptions, Source, fit_logs
from lodbench.analysis.fit.fitted_profile import profile_of
from lodbench.base.errors import InputError
from lodbench.models.machine.profile_catalog import list_hardware, load_hardware
from lodbench.models.machine.profile_writer import profile_toml
from lodbench.traces.logs.read_log import read_render_log


def fitted() -> list[str]:
    """Return the names of the bundled profiles that a fit wrote."""
    return [name for name in list_hardware() if load_hardware(name).posterior is not None]


def test_what_papers_printed_is_no_log_of_a_profile():
    """Logs that papers printed are found by name, and others are not among them."""
    assert list_logs() == ("peng2011",)
    assert bundled_log("peng2011") is not None
    assert bundled_log("llvmpipe") is None


@pytest.mark.parametrize("name", fitted())
def test_a_fitted_profile_has_its_logs_beside_it(name: str):
    """Under 2 MB, and by their hash the very files that the profile names."""
    logs = bundled_fit(name).logs
    source = load_hardware(name).provenance.source
    assert sum(path.stat().st_size for path in logs) < 2_000_000
    for path in logs:
        digest = hashlib.sha256(path.read_bytes()).hexdigest()[:12]
        assert f"{path.stem} (sha256 {digest})" in source


@pytest.mark.parametrize("name", fitted())
def test_a_fitted_profile_says_what_it_was_measured_on(name: str):
    """Scene and trace, date, driver and processor are those of the log's header."""
    header = dict(read_render_log(bundled_fit(name).logs[0]).header)
    said = load_hardware(name).provenance
    assert f"{header['scene']} along {header['trace']}" in said.measured_on
    assert said.date == header["date"]
    assert said.renderer == "; ".join(header[key] for key in ("renderer", "driver", "processor"))


def test_an_unknown_name_suggests_the_nearest():
    """A misspelt name lists what there is and the likeliest; a published profile has no log."""
    with pytest.raises(InputError, match=r"one of llvmpipe, got lvmpipe; did you mean llvmpipe\?"):
        bundled_fit("lvmpipe")
    with pytest.raises(InputError, match="got geforce2go-2002; name one"):
        bundled_fit("geforce2go-2002")


@pytest.mark.slow
@pytest.mark.parametrize("name", fitted())
def test_the_bundled_profile_is_what_its_logs_give(name: str):
    """Fitting again gives the file, and where sums are rounded otherwise the same posterior.

    The chain of another processor parts from this one at the first proposal that rounding decides.
    """
    asked, bundled = bundled_fit(name), load_hardware(name)
    sources = [
        Source(read_render_log(path), hashlib.sha256(path.read_bytes()).hexdigest())
        for path in asked.logs
    ]
    fit = fit_logs(sources, asked.target, FitOptions(asked.terms, heldout="none"))
    again = profile_of(fit, name)
    assert again.provenance == bundled.provenance
    # A log knows the size of its pictures; how they reach a screen is chosen.
    assert replace(again.display, mode=bundled.display.mode) == bundled.display
    assert again.gpu_residual.scale == pytest.approx(bundled.gpu_residual.scale, rel=0.05)
    assert again.posterior is not None
    assert bundled.posterior is not None
    spread = fit.coefficients.std(axis=0)
    used = np.flatnonzero(bundled.gpu.linear_ms)
    assert abs(again.gpu.base_ms - bundled.gpu.base_ms) < 0.2 * spread[0]
    assert (np.abs(again.gpu.linear_ms - bundled.gpu.linear_ms)[used] < 0.2 * spread[1:]).all()
    drawn, before = again.posterior.linear_ms[:, used], bundled.posterior.linear_ms[:, used]
    assert (np.abs(drawn.mean(axis=0) - before.mean(axis=0)) < 0.6 * spread[1:]).all()
    assert len(profile_toml(again).splitlines()) == len(profile_toml(bundled).splitlines())
