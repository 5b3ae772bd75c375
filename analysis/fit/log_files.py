"""Read and fit from Python: logs are bundled names, files, or what was read from them."""

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TypeAlias

from ...base.errors import InputError, text_of
from ...traces.logs.read_log import read_render_log
from ...traces.logs.render_log import RenderLog, TimeName
from .bundled_logs import bundled_log
from .estimate import Model
from .fit import Fit, FitOptions, Source, fit_logs, target_of
from .sampling.sampler import SamplerOptions

LogLike: TypeAlias = str | PathLike[str] | RenderLog


def log_path(name_or_path: str | PathLike[str]) -> Path:
    """Return the file of a log: that of a bundled one by its name, or the path itself.

    Raises `InputError` if it is neither a string nor a path.
    """
    spec = text_of(name_or_path, "log", RenderLog)
    return bundled_log(spec) or Path(spec)


def read_log(
    name_or_path: LogLike,
    mapping: Mapping[str, str] | None = None,
    log_format: str | None = None,
) -> RenderLog:
    """Read a measured render log: a bundled one by its name, or a file; a log is returned as it is.

    Parameters
    ----------
    mapping
        Columns by the names of `RenderLog`: ``{"gpu_ms": "GPUTime", "triangles": "Prims"}``.
    log_format
        A name that ``lodbench list formats`` shows, or ``file.py:NAME``; None recognises it.

    Raises `InputError` if the format is not known, the file breaks it, or it has no column to map.
    """
    if not isinstance(name_or_path, RenderLog):
        return read_render_log(log_path(name_or_path), mapping, log_format)
    if mapping or log_format:
        message = "expected no mapping or format for a log that was read"
        raise InputError(f"log: {message}, got {name_or_path!r}; give its file")
    return name_or_path


def fit(
    logs: LogLike | Sequence[LogLike],
    *,
    target: TimeName | None = None,
    terms: str = "auto",
    model: Model = "student-t",
    heldout: str = "auto",
    predict: LogLike | Sequence[LogLike] = (),
    first_frames: int | None = None,
    lag: int | None = None,
    walkers: int = 32,
    max_steps: int = 20_000,
    seed: int = 0,
    resume: str | Path | None = None,
    workers: int = 1,
    scheduler: str | None = None,
) -> Fit:
    """Fit a cost model to render logs together, as `lodbench fit` does.

    Parameters
    ----------
    target
        The time to explain; None for the GPU's, or the frame's if that is unfit.
    terms
        Predictors such as ``draw_calls,triangles``, or ``auto`` for the best set.
    predict
        Other logs, to be predicted from the fit.
    lag
        Frames by which the time is late in the logs; None to find it out.
    resume
        File that keeps the chain, so that an interrupted run goes on.
    workers, scheduler
        Processes, or the address of a Dask scheduler, for the fits of ``leave-one-out``.

    Raises `InputError` if there is no log, or one cannot be read or cannot support the fit.
    """
    if not (given := _several(logs)):
        raise InputError("logs: expected one or more, got none")
    sources = [
        Source(log) if isinstance(log, RenderLog) else Source.read(log_path(log)) for log in given
    ]
    return fit_logs(
        sources,
        target or target_of(sources[0].log),
        FitOptions(
            terms, model, heldout, first_frames, SamplerOptions(walkers, max_steps, seed), lag
        ),
        transfer=[read_log(log) for log in _several(predict)],
        resume=None if resume is None else Path(resume),
        workers=workers,
        scheduler=scheduler,
    )


def _several(logs: LogLike | Sequence[LogLike]) -> Sequence[LogLike]:
    return logs if isinstance(logs, Sequence) and not isinstance(logs, str) else [logs]
