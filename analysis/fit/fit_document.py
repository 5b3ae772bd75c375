"""A fit as the JSON document ``lodbench.fit/1``."""

from dataclasses import asdict
from typing import Any, cast

import numpy as np

from ...base.arrays import FloatArray
from ...models.machine.profile_file import PER_MS
from .fit import Fit, Source
from .noise import residual_model

_DIGITS = 6  # of every number; more would differ from machine to machine


def fit_record(fit: Fit) -> dict[str, Any]:
    """Return the record that is printed as JSON, and that tables are made from."""
    estimate, coefficients = fit.estimate, fit.coefficients
    names = estimate.design.names
    record = {
        "schema": "lodbench.fit/1",
        "log": ", ".join(source.log.name for source in fit.sources),
        "logs": [_source(fit, source, place) for place, source in enumerate(fit.sources)],
        "target": fit.target,
        "terms": [str(term) for term in estimate.terms],
        "model": fit.options.model,
        "rows": len(estimate.sample),
        "rows_rejected": sum(rejection.count for rejection in fit.rejected),
        "rejected": {rejection.reason: rejection.count for rejection in fit.rejected},
        "likelihood": estimate.likelihood_is,
        "rows_worth": estimate.rows_worth,
        "lag_frames": list(fit.lags),
        "findings": [str(finding) for finding in fit.findings],
        "coefficients": {
            name: _interval(samples)
            | {
                "prior_contraction": prior.contraction,
                "prior_shift_sd": prior.shift_sd,
                "informed": prior.informed,
            }
            for name, samples, prior in zip(names, coefficients.T, fit.sensitivity, strict=True)
        },
        "noise": _noise(fit),
        "priors": list(estimate.posterior.priors.describe(fit.options.model)),
        "diagnostics": asdict(fit.diagnostics) | {"doubt": fit.diagnostics.doubt},
        "predictive_checks": [asdict(check) for check in fit.checks],
        "condition_number": fit.collinearity.condition_number,
        "collinear": [
            {
                "columns": list(group.names),
                "condition_index": group.condition_index,
                "combination": group.combination,
                **_interval(coefficients[:, list(map(names.index, group.names))] @ group.ratio),
            }
            for group in fit.collinearity.groups
        ],
        "heldout": None if fit.heldout is None else asdict(fit.heldout),
        "transfer": [asdict(item) for item in fit.transfer],
        "candidates": [asdict(candidate) for candidate in fit.candidates],
    }
    return _rounded(record)


def _source(fit: Fit, source: Source, place: int) -> dict[str, Any]:
    return {
        "name": source.log.name,
        "format": source.log.format,
        "sha256": source.sha256,
        "rows": int(np.sum(fit.estimate.sample.series == place)),
        "notes": list(source.log.notes),
        "warnings": list(source.log.warnings),
        "header": dict(source.log.header),
    }


def _interval(samples_ms: FloatArray) -> dict[str, Any]:
    """Return a time's posterior, in the largest unit in which its mean is at least 1."""
    mean_ms = float(samples_ms.mean())
    unit = next((unit for unit in ("ms", "us") if mean_ms * PER_MS[unit] >= 1.0), "ns")
    samples = samples_ms * PER_MS[unit]
    spread = _spread(samples)
    return {"mean": spread.pop("mean"), "sd": float(samples.std()), **spread, "unit": unit}


def _noise(fit: Fit) -> dict[str, Any]:
    """Return the noise's posterior, and its correlation from frame to frame."""
    estimate = fit.estimate
    names, flat = estimate.chain.names, estimate.chain.flat
    reference = estimate.posterior.priors.mean_ms
    scale_ms: FloatArray = np.exp(flat[:, names.index("log_scale")])
    noise: dict[str, Any] = {
        "model": fit.options.model,
        "reference_ms": reference,
        "scale": _interval(scale_ms),
        "relative_scale": float(scale_ms.mean()) / reference,
        "correlation": residual_model(relative_residuals(fit)).correlation,
    }
    if "growth" in names:
        growth = flat[:, names.index("growth")]
        dof = 1.0 / flat[:, names.index("inverse_dof")]
        noise |= {"growth": _spread(growth), "dof": _spread(dof)}
    return noise


def _spread(samples: FloatArray) -> dict[str, float]:
    q05, q50, q95 = np.quantile(samples, (0.05, 0.5, 0.95)).tolist()
    return {"mean": float(samples.mean()), "q05": q05, "q50": q50, "q95": q95}


def relative_residuals(fit: Fit) -> list[FloatArray]:
    """Return residuals over the posterior mean of the time, a series of frames for each log."""
    estimate = fit.estimate
    width = len(estimate.design.names)
    mean = estimate.design.mean(estimate.chain.flat[:, :width].mean(axis=0)[np.newaxis])[0]
    residual = estimate.sample.time_ms / mean - 1.0
    return [residual[estimate.sample.series == log] for log in range(len(fit.sources))]


def _rounded(value: Any) -> Any:
    """Return a record with its numbers rounded."""
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in cast("dict[str, Any]", value).items()}
    if isinstance(value, (list, tuple)):
        return [_rounded(item) for item in cast("list[Any]", value)]
    return float(f"{value:.{_DIGITS}g}") if isinstance(value, float) else value
