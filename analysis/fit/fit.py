"""Fit a cost model to render logs: everything that `lodbench fit` finds out."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.html_table import html_table
from ...traces.logs.checks.late import explained_by_lag, frames_late, shifted
from ...traces.logs.log_checks import Finding, check_log
from ...traces.logs.log_format import Columns
from ...traces.logs.read_log import read_render_log
from ...traces.logs.render_log import Rejection, RenderLog, TimeName
from .assessment.choose_terms import Candidate, candidate_predictors, choose_terms
from .assessment.collinearity import Collinearity, examine
from .assessment.heldout import SPLITS, HeldOut, hold_out, judge
from .assessment.posterior_predictive import Check, check_predictive
from .assessment.sensitivity import Sensitivity, sensitivity
from .drift import Drift, without_drift
from .estimate import Estimate, Model, estimate
from .fit_frames import Sample, gather
from .sampling.diagnostics import Diagnostics, diagnose
from .sampling.sampler import Progress, SamplerOptions
from .terms import Term, parse_terms, predictors_of

if TYPE_CHECKING:
    import pyarrow as pa

_COLUMNS = ("name", "mean_ms", "sd_ms", "q05_ms", "q50_ms", "q95_ms")

AUTO = "auto"
NO_SPLIT = "none"

_FEWEST_LOGS = 3  # from which the others tell how logs scatter


@dataclass(frozen=True, slots=True)
class FitOptions:
    """What to fit and how.

    Attributes
    ----------
    terms : terms as `terms.parse_terms` reads them, or "auto" for the set with the best score
    model : "student-t", or "gaussian" with a constant scale
    heldout : one of `heldout.SPLITS`, "auto" or "none"
    first_frames : frames at the start of each log that are left out, as `sample.gather` has it
    lag : frames that the target is late by, or None to find it out
    """

    terms: str = AUTO
    model: Model = "student-t"
    heldout: str = AUTO
    first_frames: int | None = None
    sampler: SamplerOptions = field(default_factory=SamplerOptions)
    lag: int | None = None


@dataclass(frozen=True, slots=True)
class Source:
    """A log that was fitted, and the SHA-256 of its file."""

    log: RenderLog
    sha256: str = ""

    @classmethod
    def read(cls, path: Path, mapping: Columns = None, log_format: str | None = None) -> "Source":
        """Read a log, as `read_render_log` does."""
        log = read_render_log(path, mapping, log_format)
        with path.open("rb") as file:
            return cls(log, hashlib.file_digest(file, "sha256").hexdigest())


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Fit:
    """A fitted cost model, and what a statistician would ask of it.

    Attributes
    ----------
    rejected : tuple of Rejection
        Frames that could not be measurements, by reason.
    findings : tuple of Finding
        What to beware of in the logs.
    candidates : tuple of Candidate
        Sets of terms and their scores, if terms were chosen.
    heldout : HeldOut or None
        Error on frames that were held out, if any were.
    transfer : tuple of HeldOut
        Errors on other logs.
    lags : tuple of int
        Frames by which the target is late in each log; they are shifted back.
    lag_explains : tuple of tuple of float
        Share of the target's variance that counts of 0 to 6 rows before explain, of each log.
    drifts : tuple of Drift
        How the machine's speed moved in logs with reference draws; it is divided out.
    heldout_logs : HeldOut or None
        Error on each of three or more logs when it was held out.
    cpu : Fit or None
        The fit of the CPU's time in the same logs, where the target is the GPU's.
    cpu_note : why there is none, where the logs have a time of the CPU
    """

    sources: tuple[Source, ...]
    target: TimeName
    options: FitOptions
    rejected: tuple[Rejection, ...]
    findings: tuple[Finding, ...]
    candidates: tuple[Candidate, ...]
    estimate: Estimate
    diagnostics: Diagnostics
    collinearity: Collinearity
    sensitivity: tuple[Sensitivity, ...]
    checks: tuple[Check, ...]
    heldout: HeldOut | None
    transfer: tuple[HeldOut, ...]
    lags: tuple[int, ...]
    lag_explains: tuple[tuple[float, ...], ...] = ()
    drifts: tuple[Drift, ...] = ()
    heldout_logs: HeldOut | None = None
    cpu: "Fit | None" = None
    cpu_note: str = ""

    @property
    def unfit(self) -> str:
        """Why the model does not predict frames that it was not fitted to; empty if it does."""
        for held in filter(None, (self.heldout, self.heldout_logs)):
            if held.unfit:
                return f"of frames held out by {held.split}, {held.unfit}"
        return "" if self.cpu is None else self.cpu.unfit and f"cpu_ms: {self.cpu.unfit}"

    @property
    def coefficients(self) -> FloatArray:
        """All samples of the coefficients, (S, K), ms per unit."""
        return self.estimate.coefficients_ms

    def __repr__(self) -> str:
        logs = ", ".join(source.log.name for source in self.sources)
        return f"<Fit of {self.target} to {logs}: {', '.join(map(str, self.estimate.terms))}>"

    def to_table(self) -> "pa.Table":
        """Return one row a coefficient: mean, deviation and quantiles, in ms per unit."""
        import pyarrow as pa

        rows = list(zip(*self._rows(), strict=True))
        return pa.table(dict(zip(_COLUMNS, rows, strict=True)))

    def _repr_html_(self) -> str:
        return html_table(repr(self)[1:-1], _COLUMNS, self._rows())

    def _rows(self) -> list[tuple[object, ...]]:
        samples = self.coefficients
        quantiles = np.quantile(samples, (0.05, 0.5, 0.95), axis=0)
        columns = (samples.mean(axis=0), samples.std(axis=0), *quantiles)
        numbers = (column.tolist() for column in columns)
        return list(zip(self.estimate.design.names, *numbers, strict=True))


def fit_logs(
    sources: Sequence[Source],
    target: TimeName,
    options: FitOptions,
    *,
    transfer: Sequence[RenderLog] = (),
    resume: Path | None = None,
    progress: Progress | None = None,
    workers: int = 1,
    scheduler: str | None = None,
) -> Fit:
    """Fit the logs together.

    Raises `InputError` if a log cannot support the fit: its times carry no cost, it lacks a
    predictor, none varies, or frames are too few.

    Parameters
    ----------
    transfer
        Other logs, to be predicted.
    resume
        File that keeps the chain, so that an interrupted run goes on.
    workers, scheduler
        See `hold_out`.
    """
    if options.heldout not in (*SPLITS, AUTO, NO_SPLIT):
        known = ", ".join((*SPLITS, AUTO, NO_SPLIT))
        raise InputError(f"--heldout: expected one of {known}, got {options.heldout}")
    if options.heldout == "logs" and len(sources) < 2:
        raise InputError("--heldout logs: expected two logs or more, got one; use blocks")
    findings = _accepted([source.log for source in sources], target)
    lag_explains = tuple(explained_by_lag(source.log, target) for source in sources)
    lags = tuple(_lag(source.log, target, options) for source in sources)
    steadied = [
        without_drift(shifted(source.log, target, lag), target)
        for source, lag in zip(sources, lags, strict=True)
    ]
    logs = [log for log, _ in steadied]
    sources = [replace(source, log=log) for source, log in zip(sources, logs, strict=True)]
    terms, sample, rejected, candidates = _terms_and_frames(logs, target, options)
    _require_frames(logs, sample, terms)
    kept = None if resume is None else (resume, _identity(sample, terms, options))
    cpu, cpu_note = _cpu(sources, target, options)
    model, sampler = options.model, options.sampler
    sampled = estimate(sample, terms, model, sampler, resume=kept, progress=progress)
    held = held_logs = None
    if options.heldout != NO_SPLIT:
        held = hold_out(
            sample,
            terms,
            model,
            sampler,
            options.heldout,
            workers=workers,
            scheduler=scheduler,
            whole=sampled,
        )
        if len(logs) >= _FEWEST_LOGS and held.split != "logs":
            held_logs = hold_out(sample, terms, model, sampler, "logs")
    scaled = sampled.chain.flat[:, : len(sampled.design.names)]
    rng = np.random.default_rng(sampler.seed)
    return Fit(
        tuple(sources),
        target,
        options,
        rejected,
        findings,
        candidates,
        sampled,
        diagnose(sampled.chain),
        examine(sampled.design, scaled.mean(axis=0)),
        sensitivity(scaled, sampled.posterior.priors),
        check_predictive(sampled.draws, sampled.design, sample.time_ms, rng),
        held,
        tuple(_transfer(sampled, log, target, options) for log in transfer),
        lags,
        lag_explains,
        tuple(drift for _, drift in steadied if drift is not None),
        held_logs,
        cpu,
        cpu_note,
    )


def _cpu(
    sources: Sequence[Source], target: TimeName, options: FitOptions
) -> tuple[Fit | None, str]:
    """Return the fit of the CPU's time of the same frames, or why there is none."""
    if target == "cpu_ms" or any(source.log.cpu_ms is None for source in sources):
        return None, ""
    if target == "frame_ms":
        return None, "cpu_ms is a part of frame_ms here and not charged apart: the CPU costs 0"
    try:
        # The lag that was told is that of another timer.
        return fit_logs(sources, "cpu_ms", replace(options, terms=AUTO, lag=None)), ""
    except InputError as error:
        return None, f"the CPU costs 0: {error}"


def target_of(log: RenderLog) -> TimeName:
    """Return the time to fit where none is asked for: the GPU's, or the frame's if that is unfit.

    Raises `InputError` if neither carries cost, with the reason of each.
    """
    refused = {finding.column: finding.message for finding in check_log(log) if finding.refuse}
    names: tuple[TimeName, ...] = ("gpu_ms", "frame_ms")
    for name in names:
        if name in log.times and name not in refused:
            return name
    why = (
        "; ".join(refused[name] for name in names if name in refused)
        or f"got a log with {', '.join(log.times)}; name it with --target"
    )
    raise InputError(f"{log.name}: expected a gpu_ms or frame_ms that carries cost; {why}")


def _lag(log: RenderLog, target: TimeName, options: FitOptions) -> int:
    if options.lag is None:
        return frames_late(log, target)[0]
    if not 0 <= options.lag < len(log):
        raise InputError(f"--lag: expected 0 to {len(log) - 1} frames, got {options.lag}")
    return options.lag


def _accepted(logs: Sequence[RenderLog], target: TimeName) -> tuple[Finding, ...]:
    """Return what to beware of; raises InputError if a log cannot be fitted."""
    kept: list[Finding] = []
    for log in logs:
        log.time(target)
        for finding in check_log(log):
            if finding.column not in (target, ""):
                continue
            if finding.refuse:
                raise InputError(
                    f"{log.name}: expected a {target} that carries cost; {finding.message}"
                )
            kept.append(finding)
    return tuple(kept)


def _terms_and_frames(
    logs: list[RenderLog], target: TimeName, options: FitOptions
) -> tuple[tuple[Term, ...], Sample, tuple[Rejection, ...], tuple[Candidate, ...]]:
    if options.terms != AUTO:
        terms = parse_terms(options.terms)
        return terms, *gather(logs, predictors_of(terms), target, options.first_frames), ()
    names = candidate_predictors(logs, target)
    sample, _ = gather(logs, names, target, options.first_frames)
    terms, candidates = choose_terms(sample, target)
    return terms, *gather(logs, predictors_of(terms), target, options.first_frames), candidates


def _require_frames(logs: list[RenderLog], sample: Sample, terms: Sequence[Term]) -> None:
    """Raise InputError if one of several logs has too few frames to say anything by itself."""
    if len(logs) == 1:
        return  # which has as many as the fit needs, or is refused there
    # Half of a log may be held out; a base and a roofline's other side come on top of the terms.
    fewest = 2 * (len(terms) + 3)
    counts = np.bincount(sample.series, minlength=len(logs)).tolist()
    for log, count in zip(logs, counts, strict=True):
        if count < fewest:
            raise InputError(
                f"{log.name}: expected at least {fewest} frames that count, got {count}; log for "
                "longer, or leave the log out"
            )


def _identity(sample: Sample, terms: Sequence[Term], options: FitOptions) -> str:
    """Return what a chain is of, so that a chain of something else is not gone on with."""
    digest = hashlib.sha256(sample.predictors.tobytes() + sample.time_ms.tobytes())
    listed = ",".join(map(str, terms))
    sampler = options.sampler
    return f"{digest.hexdigest()} {listed} {options.model} {sampler.walkers} {sampler.seed}"


def _transfer(sampled: Estimate, log: RenderLog, target: TimeName, options: FitOptions) -> HeldOut:
    log, _ = without_drift(shifted(log, target, _lag(log, target, options)), target)
    sample, _ = gather([log], predictors_of(sampled.terms), target, options.first_frames)
    return judge(sampled, sample, log.name)
