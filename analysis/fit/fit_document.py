"""A fit as the JSON document ``lodbench.fit/1``."""

from dataclasses import asdict
from typing import Any, cast

import numpy as np

from ...base.arrays import FloatArray
from ...models.machine.profile_file import PER_MS
from .fit import Fit, Source
from .fit_residual import residual_of
from .fit_scatter import scatter_of, variance_share
from .rounding import to_digits
from .sampling.between_logs import ENOUGH_SCENES

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
        "lag_explains": [list(shares) for shares in fit.lag_explains],
        "drift": [asdict(drift) for drift in fit.drifts],
        "occasions": _occasions(fit),
        "between_scenes": _between_scenes(fit),
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
        "variance_share": variance_share(fit),
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
        "heldout_logs": None if fit.heldout_logs is None else asdict(fit.heldout_logs),
        "unfit": fit.unfit,
        "cpu_note": fit.cpu_note,
        "cpu": None if fit.cpu is None else fit_record(fit.cpu),
        "transfer": [asdict(item) for item in fit.transfer],
        "candidates": [asdict(candidate) for candidate in fit.candidates],
    }
    return _rounded(record)


def _occasions(fit: Fit) -> dict[str, Any]:
    """Return how many occasions there are, and the log-sd of the factor that all their times have.

    Of one occasion nothing can be told: the spread is assumed.
    """
    origins = [fit.estimate.sample.origin(place) for place in range(len(fit.sources))]
    count = len({origin.occasion for origin in origins})
    found = scatter_of(fit)
    return {"count": count, "log_sd": found.occasion, "assumed": count < 2}


def _between_scenes(fit: Fit) -> dict[str, Any]:
    """Return how many scenes there are, and the log-sd of each term's factor between scenes."""
    origins = [fit.estimate.sample.origin(place) for place in range(len(fit.sources))]
    count = len({origin.scene for origin in origins})
    found = scatter_of(fit)
    return {"count": count, "log_sd": dict(found.scenes), "assumed": count < ENOUGH_SCENES}


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
    residual = residual_of(fit)
    noise: dict[str, Any] = {
        "model": fit.options.model,
        "reference_ms": reference,
        "scale": _interval(scale_ms),
        "relative_scale": float(scale_ms.mean()) / reference,
        "correlation": residual.correlation,
        "slow_scale": residual.slow_scale,
        "slow_time_s": residual.slow_time_s,
        "spike_share": residual.spike_share,
        "spike_scale": residual.spike_scale,
    }
    if "growth" in names:
        growth = flat[:, names.index("growth")]
        dof = 1.0 / flat[:, names.index("inverse_dof")]
        noise |= {"growth": _spread(growth), "dof": _spread(dof)}
    return noise


def _spread(samples: FloatArray) -> dict[str, float]:
    q05, q50, q95 = np.quantile(samples, (0.05, 0.5, 0.95)).tolist()
    return {"mean": float(samples.mean()), "q05": q05, "q50": q50, "q95": q95}


def _rounded(value: Any) -> Any:
    """Return a record with its numbers rounded."""
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in cast("dict[str, Any]", value).items()}
    if isinstance(value, (list, tuple)):
        return [_rounded(item) for item in cast("list[Any]", value)]
    return to_digits(value, _DIGITS) if isinstance(value, float) else value
