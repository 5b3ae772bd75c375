"""A hardware profile from a fit: what `compare --hardware` replays."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.predictors import CPU_PREDICTORS, GPU_PREDICTORS, LEVEL_PREDICTORS
from ...models.machine.cost import CostModel, CpuCostModel
from ...models.machine.hardware import Display, HardwareProfile, Posterior, Provenance
from ...models.machine.knee import Knee
from ...models.machine.residual import Residual
from ...traces.logs.render_log import RenderLog, TimeName
from .design import BASE, ROOFLINE
from .fit import Fit, Source
from .fit_residual import residual_of
from .fit_scatter import identification_of, scatter_of
from .rounding import to_digits
from .terms import Term

_DRAWS = 64
_MACHINE = ("renderer", "gpu", "driver", "processor")  # of a log's header
_CALIBRATION = "calibration"  # policy in the header of what `lodbench record --calibrate` writes
_DIGITS = 6  # fewer would blur the sum of coefficients that are only known together


def require_for_profile(terms: Sequence[Term], target: TimeName) -> None:
    """Raise InputError if a profile, and so the simulator, has no place for a term."""
    linear = CPU_PREDICTORS if target == "cpu_ms" else GPU_PREDICTORS
    for term in terms:
        geometry, pixels = term.predictors[:-1], term.predictors[-1]
        if term.kind == "knee":
            good = target != "cpu_ms" and pixels in GPU_PREDICTORS
            wanted = f"knees of {', '.join(GPU_PREDICTORS)}"
        elif term.kind == "roofline" and target != "cpu_ms":
            good = set(geometry) <= set(LEVEL_PREDICTORS) and pixels == "shaded_samples"
            wanted = f"max(…,shaded_samples) over {', '.join(LEVEL_PREDICTORS)}"
        else:
            good = term.kind == "linear" and pixels in linear
            wanted = f"single predictors among {', '.join(linear)}"
        if not good:
            raise InputError(
                f"--out: expected terms that a profile of {target} can hold, {wanted}, got {term}; "
                "leave it out, or leave --out out"
            )


def profile_of(
    fit: Fit, name: str, *, date: str = "", onto: HardwareProfile | None = None
) -> HardwareProfile:
    """Return the profile of a fitted log.

    Coefficients are posterior means, and the draws are thinned samples.  A fitted ``frame_ms`` or
    ``gpu_ms`` becomes cost of the GPU, a ``cpu_ms`` cost of the CPU.  What the log does not tell is
    that of `onto`; without one, the other processor costs nothing, which means "not measured", and
    the display, memory and disk are the defaults.

    Raises
    ------
    InputError
        As `require_for_profile`.
    """
    require_for_profile(fit.estimate.terms, fit.target)
    residual = residual_of(fit)
    before = onto or HardwareProfile(
        name, Provenance(""), CostModel.of(0.0, {}), CpuCostModel.of(0.0, {})
    )
    before = replace(
        before,
        name=name,
        provenance=_provenance(fit, date, onto),
        display=_display(fit, before.display),
    )
    mean = [to_digits(value, _DIGITS) for value in fit.coefficients.mean(axis=0).tolist()]
    coefficients = dict(zip(fit.estimate.design.names, mean, strict=True))
    base = coefficients.pop(BASE)
    if fit.target == "cpu_ms":
        return replace(before, cpu=CpuCostModel.of(base, coefficients), cpu_residual=residual)
    sides = [key for key in coefficients if key.startswith(ROOFLINE)]
    roofline = {key.removeprefix(ROOFLINE): coefficients.pop(key) for key in sides}
    knees = [
        Knee(term.predictors[0], term.at, coefficients.pop(str(term)))
        for term in fit.estimate.terms
        if term.kind == "knee"
    ]
    whole = replace(
        before,
        gpu=CostModel.of(base, coefficients, roofline, knees),
        gpu_residual=residual,
        posterior=_posterior(fit, residual),
        frames_in_flight=1 if fit.target == "frame_ms" else before.frames_in_flight,
        scatter=scatter_of(fit),
        identification=identification_of(fit),
    )
    if fit.cpu is None:
        return whole
    cpu = profile_of(fit.cpu, name, onto=whole)
    return replace(whole, cpu=cpu.cpu, cpu_residual=cpu.cpu_residual)


def _posterior(fit: Fit, residual: Residual) -> Posterior:
    """Return thinned samples as draws; a draw's noise is larger as its likelihood's scale is."""
    estimate = fit.estimate
    names, draws = estimate.design.names, estimate.chain.thinned(_DRAWS)
    slopes = draws[:, : len(names)] / estimate.design.unit
    scale: FloatArray = np.exp(draws[:, estimate.chain.names.index("log_scale")])
    mean_scale = float(
        np.exp(estimate.chain.flat[:, estimate.chain.names.index("log_scale")]).mean()
    )
    linear, roofline = np.zeros((2, len(draws), len(GPU_PREDICTORS)))
    knees = [str(term) for term in estimate.terms if term.kind == "knee"]
    knee = np.zeros((len(draws), len(knees)))
    for place, name in enumerate(names[1:], 1):
        if name in knees:
            knee[:, knees.index(name)] = _all_rounded(slopes[:, place])
            continue
        into = roofline if name.startswith(ROOFLINE) else linear
        into[:, GPU_PREDICTORS.index(name.removeprefix(ROOFLINE))] = _all_rounded(slopes[:, place])
    return Posterior(
        _all_rounded(slopes[:, 0]),
        linear,
        _all_rounded(residual.scale * scale / mean_scale),
        None if estimate.design.linear else roofline,
        knee if knees else None,
    )


def _provenance(fit: Fit, date: str, onto: HardwareProfile | None) -> Provenance:
    estimate, header = fit.estimate, dict(fit.sources[0].log.header)
    drawn = [what for source in fit.sources if (what := _measured_on(source.log))]
    rest = f"; the rest is that of {onto.name}" if onto else ""
    method = (
        f"emcee: posterior means of {fit.target} on {', '.join(map(str, estimate.terms))}, "
        f"{fit.options.model}, {len(estimate.sample)} frames worth "
        f"{estimate.rows_worth:.0f} independent ones{rest}"
    )
    return Provenance(
        source="; ".join(map(_described, fit.sources)),
        renderer="; ".join(header[key] for key in _MACHINE if key in header),
        date=date or header.get("date", ""),
        method=method,
        assumed=onto is not None and onto.provenance.assumed,
        measured_on=tuple(dict.fromkeys((*(onto.provenance.measured_on if onto else ()), *drawn))),
    )


def _described(source: Source) -> str:
    """Return the name of a log, the hash of its file, and what was drawn."""
    digest = f" (sha256 {source.sha256[:12]})" if source.sha256 else ""
    drawn = _measured_on(source.log)
    policy = dict(source.log.header).get("policy")
    what = _CALIBRATION if policy == _CALIBRATION else "replay"
    return source.log.name + digest + (f", {what} of {drawn}" if drawn else "")


def _measured_on(log: RenderLog) -> str:
    """Return ``SCENE along TRACE``, or nothing if the log does not say both."""
    header = dict(log.header)
    return f"{header['scene']} along {header['trace']}" if {"scene", "trace"} <= set(header) else ""


def _display(fit: Fit, before: Display) -> Display:
    """Return a display of the size that was drawn, where the log says it."""
    resolution = dict(fit.sources[0].log.header).get("resolution", "")
    width, _, height = resolution.partition("x")
    if not (width.isdecimal() and height.isdecimal() and int(width) and int(height)):
        return before
    return replace(before, width_px=int(width), height_px=int(height))


def _all_rounded(values: FloatArray) -> FloatArray:
    return np.array([to_digits(value, _DIGITS) for value in values.tolist()])
