"""`lodbench fit`: a hardware profile from measured render logs, with its uncertainty."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..base.errors import InputError
from .shared.progress import progress_bar

if TYPE_CHECKING:  # numpy and what needs it are loaded by the command
    from ..traces.logs.render_log import TimeName


def fit(
    logs: Annotated[
        list[str] | None,
        typer.Argument(metavar="LOG…", help="Render logs, fitted together; or peng2011, bundled."),
    ] = None,
    *,
    bundled: Annotated[
        str | None,
        typer.Option(
            metavar="PROFILE",
            help="Instead of LOG, what this bundled profile was fitted to, with its settings.",
        ),
    ] = None,
    target: Annotated[
        str | None,
        typer.Option(help="gpu_ms, cpu_ms or frame_ms; else gpu_ms, or frame_ms if that is unfit."),
    ] = None,
    terms: Annotated[
        str | None,
        typer.Option(
            help="Predictors, as in draw_calls,triangles; also a*b and max(triangles,"
            "shaded_samples).  auto, the default: the set that predicts held-out frames best."
        ),
    ] = None,
    mapping: Annotated[
        str, typer.Option("--map", help="Columns by name: gpu_ms=GPUTime,triangles=Prims.")
    ] = "",
    log_format: Annotated[
        str | None, typer.Option("--format", help="Format of the logs; else their content decides.")
    ] = None,
    model: Annotated[
        str, typer.Option(help="student-t, or gaussian of constant scale.")
    ] = "student-t",
    walkers: Annotated[int, typer.Option(min=4, help="Walkers of the ensemble.")] = 32,
    steps: Annotated[int, typer.Option(min=20, help="Steps at most.")] = 20_000,
    seed: Annotated[int, typer.Option(min=0, help="Same seed, same posterior.")] = 0,
    heldout: Annotated[
        str,
        typer.Option(
            help="blocks, halves, interleaved, leave-one-out or none; auto: blocks, or each frame "
            "in turn where there are few."
        ),
    ] = "auto",
    predict: Annotated[
        list[str] | None,
        typer.Option(metavar="LOG", help="Another log to predict from the fit; may be repeated."),
    ] = None,
    first_frames: Annotated[
        int | None,
        typer.Option(
            min=0,
            help="Frames at the start of each log that are left out; else 3, or none where the "
            "header says `rows: averages`.",
        ),
    ] = None,
    resume: Annotated[
        Path | None, typer.Option(help="Keep the chain in this .npz, and go on from it.")
    ] = None,
    strict: Annotated[
        bool,
        typer.Option("--strict", help="Exit with 1 if the chain is too short, and write nothing."),
    ] = False,
    plots: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write trace.png and corner.png.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="PROFILE.toml", help="Write the hardware profile.")
    ] = None,
    onto: Annotated[
        str | None,
        typer.Option(
            metavar="PROFILE", help="Where the profile's other parts come from: CPU, display, disk."
        ),
    ] = None,
    date: Annotated[str, typer.Option(help="Date of the measurement, for the profile.")] = "",
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON document.")] = False,
) -> None:
    """Fit a cost model to measured render logs: a hardware profile.

    Prints the posterior of its coefficients, what a statistician would ask of it, and the error on
    frames that were held out.
    """
    from ..analysis.fit.fit import FitOptions, Source, fit_logs, target_of
    from ..analysis.fit.fit_document import fit_record
    from ..analysis.fit.log_files import log_path
    from ..analysis.fit.sampling.sampler import SamplerOptions
    from ..models.machine.profile_catalog import load_hardware

    paths, terms, target = _asked(logs or [], bundled, terms, target)
    options = FitOptions(
        terms,
        _one_of("--model", model, ("student-t", "gaussian")),
        heldout,
        first_frames,
        SamplerOptions(walkers, steps, seed),
    )
    pairs = _pairs(mapping)
    sources = [Source.read(path, pairs or None, log_format) for path in paths]
    others = [Source.read(log_path(name), pairs or None, log_format).log for name in predict or ()]
    time: TimeName = (
        target_of(sources[0].log)
        if target is None
        else _one_of("--target", target, ("gpu_ms", "frame_ms", "cpu_ms"))
    )
    before = None if onto is None else load_hardware(onto)
    _check_outputs(terms, time, out, plots)
    with progress_bar("sample") as progress:
        found = fit_logs(
            sources,
            time,
            options,
            transfer=others,
            resume=resume,
            progress=progress,
        )
    record = fit_record(found)
    _print(record, as_json=as_json)
    doubt = found.diagnostics.doubt
    if doubt:
        print(f"warning: {doubt}: intervals are not to be trusted; raise --steps", file=sys.stderr)
    if doubt and strict:
        raise typer.Exit(1)
    if out is not None:
        from ..analysis.fit.fitted_profile import profile_of
        from ..models.machine.profile_writer import write_profile

        write_profile(profile_of(found, out.stem, date=date, onto=before), out)
    if plots is not None:
        from ..analysis.fit.plots import write_plots

        write_plots(found.estimate.chain, plots)


def _asked(
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
    found = bundled_fit(bundled)
    terms = found.terms if terms is None else terms
    return list(found.logs), terms, found.target if target is None else target


def _one_of(option: str, value: str, known: tuple[Any, ...]) -> Any:
    if value not in known:
        raise InputError(f"{option}: expected one of {', '.join(known)}, got {value}; name one")
    return value


def _pairs(text: str) -> dict[str, str]:
    """Return the columns that ``name=COLUMN,name=COLUMN`` maps."""
    pairs = [item.partition("=") for item in filter(None, text.split(","))]
    for name, equals, column in pairs:
        if not (name.strip() and equals and column.strip()):
            raise InputError(f"--map: expected name=COLUMN,name=COLUMN, got {text}")
    return {name.strip(): column.strip() for name, _, column in pairs}


def _check_outputs(terms: str, target: "TimeName", out: Path | None, plots: Path | None) -> None:
    """Refuse, before the work, what could not be written after it."""
    from ..analysis.fit.fitted_profile import require_for_profile
    from ..analysis.fit.plots import require_plots
    from ..analysis.fit.terms import parse_terms

    if plots is not None:
        require_plots()
    if out is None:
        return
    if terms != "auto":
        require_for_profile(parse_terms(terms), target)
    if out.suffix != ".toml" or out.is_dir() or not out.parent.is_dir():
        raise InputError(
            "expected a .toml file in a folder that exists; name such a path", path=out
        )


def _print(record: dict[str, Any], *, as_json: bool) -> None:
    if as_json:
        print(json.dumps(record, ensure_ascii=False))
        return
    from rich.console import Console

    from ..analysis.fit.fit_table import print_fit

    # A pipe has no width of its own.
    width = None if sys.stdout.isatty() else 120
    print_fit(record, Console(width=width, highlight=False, soft_wrap=False))
