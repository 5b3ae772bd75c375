"""`lodbench fit`: a hardware profile from measured render logs, with its uncertainty."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from typer import Argument, Exit, Option

from ..base.errors import InputError
from .shared import options
from .shared.columns import Mapping, parse_columns
from .shared.progress import progress_bar
from .shared.terminal import table_console

if TYPE_CHECKING:  # numpy and what needs it are loaded by the command
    from ..analysis.fit.fit import Source
    from ..traces.logs.render_log import TimeName

Logs = Annotated[
    list[str] | None,
    Argument(metavar="LOG…", help="Render logs, as occasions and scenes; or peng2011, bundled."),
]
Bundled = Annotated[
    str | None,
    Option(
        metavar="PROFILE",
        help="Instead of LOG, what this bundled profile was fitted to, with its settings.",
    ),
]
Target = Annotated[
    str | None,
    Option(help="gpu_ms, cpu_ms or frame_ms; else gpu_ms, or frame_ms if that is unfit."),
]
Terms = Annotated[
    str | None,
    Option(
        help="Predictors, as in draw_calls,triangles; also a*b and max(triangles,"
        "shaded_samples) and knee(triangles,158000).  auto, the default: the set that predicts "
        "held-out frames best."
    ),
]
LogFormat = Annotated[
    str | None, Option("--format", help="Format of the logs; else their content decides.")
]
NoiseModel = Annotated[str, Option(help="student-t, or gaussian of constant scale.")]
Walkers = Annotated[int, Option(min=4, help="Walkers of the ensemble.")]
Steps = Annotated[int, Option(min=20, help="Steps at most.")]
ChainSeed = Annotated[int, Option(min=0, help="Same seed, same posterior.")]
HeldOut = Annotated[
    str,
    Option(
        help="blocks, logs, halves, interleaved, leave-one-out or none; auto: five folds of "
        "blocks, and of three logs or more each in turn; or each frame where there are few."
    ),
]
FitWorkers = Annotated[
    int, Option(help="Processes for leave-one-out; 0 for one a processor.  Results are the same.")
]
Predict = Annotated[
    list[str] | None,
    Option(metavar="LOG", help="Another log to predict from the fit; may be repeated."),
]
Lag = Annotated[
    str, Option(metavar="auto|K", help="Frames that the target is late by; auto tries 0 to 6.")
]
Join = Annotated[
    str | None,
    Option(metavar="COUNTERS", help="A log with the counts of the same run, joined by time."),
]
FirstFrames = Annotated[
    int | None,
    Option(
        min=0,
        help="Frames at the start of each log that are left out; else 3, or none where the header "
        "says `rows: averages`.",
    ),
]
Resume = Annotated[Path | None, Option(help="Keep the chain in this .npz, and go on from it.")]
Strict = Annotated[
    bool, Option("--strict", help="Exit with 1 if the chain is too short, and write nothing.")
]
Plots = Annotated[Path | None, Option(metavar="DIR", help="Write trace.png and corner.png.")]
Out = Annotated[Path | None, Option(metavar="PROFILE.toml", help="Write the hardware profile.")]
Onto = Annotated[
    str | None,
    Option(
        metavar="PROFILE", help="Where the profile's other parts come from: CPU, display, disk."
    ),
]
Anyway = Annotated[
    bool, Option("--anyway", help="Write a profile though it does not predict held-out frames.")
]
Date = Annotated[str, Option(help="Date of the measurement, for the profile.")]


def fit(
    logs: Logs = None,
    *,
    bundled: Bundled = None,
    target: Target = None,
    terms: Terms = None,
    mapping: Mapping = "",
    join: Join = None,
    lag: Lag = "auto",
    log_format: LogFormat = None,
    model: NoiseModel = "student-t",
    walkers: Walkers = 32,
    steps: Steps = 20_000,
    seed: ChainSeed = 0,
    heldout: HeldOut = "auto",
    workers: FitWorkers = 0,
    scheduler: options.Scheduler = None,
    predict: Predict = None,
    first_frames: FirstFrames = None,
    resume: Resume = None,
    strict: Strict = False,
    plots: Plots = None,
    out: Out = None,
    onto: Onto = None,
    date: Date = "",
    anyway: Anyway = False,
    as_json: options.AsJson = False,
) -> None:
    """Fit a cost model to measured render logs: a hardware profile.

    Prints the posterior of its coefficients, what a statistician would ask of it, and the error on
    frames that were held out.
    """
    from ..analysis.fit.fit import FitOptions, Source, fit_logs, target_of
    from ..analysis.fit.fit_document import fit_record
    from ..analysis.fit.fit_table import print_fit
    from ..analysis.fit.log_files import log_path
    from ..analysis.fit.sampling.sampler import SamplerOptions
    from ..models.machine.profile_catalog import load_hardware

    paths, terms, target = _choose_logs(logs or [], bundled, terms, target)
    noise = _one_of("--model", model, ("student-t", "gaussian"))
    sampler = SamplerOptions(walkers, steps, seed)
    settings = FitOptions(terms, noise, heldout, first_frames, sampler, _frames(lag))
    columns = parse_columns(mapping) or None
    sources = _read_sources(paths, columns, log_format, join)
    if target is None:
        target = target_of(sources[0].log)
    time: TimeName = _one_of("--target", target, ("gpu_ms", "frame_ms", "cpu_ms"))
    base = None if onto is None else load_hardware(onto)
    _check_outputs(terms, time, out, plots, resume)
    transfer = [Source.read(log_path(name), columns, log_format).log for name in predict or ()]
    with progress_bar("sample", "steps") as progress:
        result = fit_logs(
            sources,
            time,
            settings,
            transfer=transfer,
            resume=resume,
            progress=progress,
            workers=workers,
            scheduler=scheduler,
        )
    record = fit_record(result)
    if as_json:
        print(json.dumps(record, ensure_ascii=False))
    else:
        print_fit(record, table_console(120))
    doubt = result.diagnostics.doubt
    if doubt:
        print(f"warning: {doubt}: intervals are not to be trusted; raise --steps", file=sys.stderr)
    if doubt and strict:
        raise Exit(1)
    if out is not None and result.unfit and not anyway:
        print(
            f"error: {out}: not written, since {result.unfit}; --anyway writes it", file=sys.stderr
        )
        raise Exit(1)
    if out is not None:
        from ..analysis.fit.fitted_profile import profile_of
        from ..models.machine.profile_writer import write_profile

        write_profile(profile_of(result, out.stem, date=date, onto=base), out)
    if plots is not None:
        from ..analysis.fit.plots import write_plots

        write_plots(result.estimate.chain, plots)


def _choose_logs(
    logs: list[str], bundled: str | None, terms: str | None, target: str | None
) -> tuple[list[Path], str, str | None]:
    """Return the files to fit, the terms and the target: those given, else the bundled ones."""
    from ..analysis.fit.bundled_logs import bundled_fit
    from ..analysis.fit.log_files import log_path

    if bool(logs) is (bundled is not None):
        got = "both" if logs else "neither"
        raise InputError(f"fit: expected LOG… or --bundled PROFILE, got {got}; give one")
    if bundled is None:
        return [log_path(name) for name in logs], "auto" if terms is None else terms, target
    usual = bundled_fit(bundled)
    terms = usual.terms if terms is None else terms
    return list(usual.logs), terms, usual.target if target is None else target


def _one_of(option: str, value: str, known: tuple[Any, ...]) -> Any:
    if value not in known:
        raise InputError(f"{option}: expected one of {', '.join(known)}, got {value}; name one")
    return value


def _frames(lag: str) -> int | None:
    if lag == "auto":
        return None
    if not lag.isdecimal():
        raise InputError(f"--lag: expected auto or a number of frames, got {lag}")
    return int(lag)


def _read_sources(
    paths: list[Path], columns: dict[str, str] | None, log_format: str | None, join: str | None
) -> "list[Source]":
    """Read the logs; with `join`, the first one's times and the other's counts.

    Mapped columns may be of either of the two: each is looked for where it stands.
    """
    from ..analysis.fit.fit import Source
    from ..analysis.fit.log_files import log_path
    from ..traces.logs.join_logs import join_by_time

    if join is None:
        return [Source.read(path, columns, log_format) for path in paths]
    if len(paths) != 1:
        raise InputError(f"--join: expected one LOG to join to, got {len(paths)}; fit them apart")
    times = Source.read(paths[0], None, log_format)
    counts = Source.read(log_path(join), columns)
    digest = f"{times.sha256}+{counts.sha256}"
    return [Source(join_by_time(times.log, counts.log), digest)]


def _check_outputs(
    terms: str,
    target: "TimeName",
    out: Path | None,
    plots: Path | None,
    resume: Path | None,
) -> None:
    """Refuse, before the work, what could not be written after it."""
    from ..analysis.fit.fitted_profile import require_for_profile
    from ..analysis.fit.plots import require_plots
    from ..analysis.fit.terms import parse_terms
    from ..base.files.writable import found_above, require_file_writable, require_writable

    if plots is not None:
        require_plots()
        require_writable(found_above(plots / "trace.png"))
    if resume is not None:
        require_file_writable(resume)
    if out is None:
        return
    if terms != "auto":
        require_for_profile(parse_terms(terms), target)
    if out.suffix != ".toml" or out.is_dir() or not out.parent.is_dir():
        raise InputError(
            "expected a .toml file in a folder that exists; name such a path", path=out
        )
    require_file_writable(out)
