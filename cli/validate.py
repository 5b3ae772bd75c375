"""`lodbench validate`: record policies on a real renderer, simulate the same, and compare."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from ..base.errors import InputError
from .shared.progress import progress_bar

POLICIES = (
    "full",
    "static-distance",
    "static-screen",
    "feedback",
    "lodmanager",
    "funkhouser",
    "gobbetti",
)
"""Policies of different kinds: none, by distance, by size, from measured times, from a model."""


def validate(
    *,
    scene: Annotated[
        str, typer.Option(help="A bundled scene, or a scene file with meshes.")
    ] = "market",
    trace: Annotated[
        str,
        typer.Option(help="`tour`, a kind of movement (`list traces`), or FILE, FILE#SELECTOR."),
    ] = "drive",
    hardware: Annotated[
        str, typer.Option(help="The profile to be tested: bundled, or a TOML file.")
    ] = "llvmpipe",
    policy: Annotated[
        list[str] | None,
        typer.Option(
            help="NAME, NAME:key=value,key=value, or file.py:Class; may be repeated.  Without it, "
            f"{', '.join(POLICIES)}."
        ),
    ] = None,
    recorded: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Take the recordings that an earlier validate wrote there, with its scene, trace, "
            "budget and size; how they were drawn is theirs.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Write report.html, validation.json, and logs recorded and simulated.",
        ),
    ] = None,
    budget_ms: Annotated[
        float | None, typer.Option(help="Time a frame may take; else one refresh of the display.")
    ] = None,
    size: Annotated[
        str | None, typer.Option(help="WIDTHxHEIGHT of the picture; else the profile's.")
    ] = None,
    seconds: Annotated[float, typer.Option(help="How much of the trace, from its start.")] = 10.0,
    passes: Annotated[
        int, typer.Option(help="Recordings of each policy; a second shows the machine's own noise.")
    ] = 2,
    repeats: Annotated[
        int, typer.Option(help="Times that each frame is drawn; the median counts.")
    ] = 3,
    warmup: Annotated[int, typer.Option(help="Frames at the start that do not count.")] = 30,
    draws: Annotated[int, typer.Option(help="Posterior draws to simulate.")] = 16,
    resamples: Annotated[int, typer.Option(help="Bootstrap resamples.")] = 200,
    workers: Annotated[
        int, typer.Option(help="Processes that simulate; 0 for one a processor.")
    ] = 0,
    backend: Annotated[str, typer.Option(help="egl, off screen, or window.")] = "egl",
    instancing: Annotated[
        bool, typer.Option("--instancing", help="Draw all instances of a level at once.")
    ] = False,
    threads: Annotated[
        int, typer.Option(help="Threads of llvmpipe beside the caller's; 0 is the quietest.")
    ] = 0,
    seed: Annotated[int, typer.Option(help="Seed of the simulated noise.")] = 0,
    place: Annotated[
        str, typer.Option(help="shrink, fit, center or none, as for compare.")
    ] = "shrink",
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON document.")] = False,
) -> None:
    """Compare simulated with measured: errors of frame times, metrics, and order of policies."""
    from ..analysis.study.compare import CompareOptions
    from ..analysis.study.inputs import load_trace
    from ..analysis.validation import replays as run
    from ..analysis.validation import validation_folder as output
    from ..analysis.validation.recordings import RecordOptions, conditions, require_recordable
    from ..analysis.validation.validate import require_other_frames, require_priced
    from ..analysis.validation.validate import validate as compare_sides
    from ..analysis.validation.validation_result import encode
    from ..models.machine.profile_catalog import load_hardware
    from ..models.scene.scene_catalog import open_scene
    from ..render.gl.recorder import recorded_hardware
    from ..sim.replay import ReplayOptions
    from .record import parse_size
    from .shared.scene_output import opening

    labels = list(policy or POLICIES)
    if len(set(labels)) < len(labels):
        raise InputError("--policy: expected each once, got one twice; name it once")
    if out is not None:
        output.check_folder(out)
        if recorded is not None and recorded.absolute() in out.absolute().parents:
            raise InputError("expected a folder beside the recordings, got one in them", path=out)
    profile = load_hardware(hardware)
    display = profile.display
    wanted = (display.width_px, display.height_px) if size is None else parse_size(size)
    profile = recorded_hardware(profile, wanted)
    with opening(scene):
        opened = open_scene(scene)
    path = run.cut_trace(load_trace(trace, opened.scene, place), seconds)
    require_other_frames(profile, opened.scene.name, path.name)
    require_priced(profile)
    require_recordable(labels, opened.scene)
    scoring = CompareOptions(warmup=warmup, resamples=resamples, draws=draws, workers=workers)
    options = ReplayOptions(
        budget_ms=1e3 / display.refresh_hz if budget_ms is None else budget_ms, seed=seed
    )
    if recorded is None:
        how = RecordOptions(
            backend=backend, instancing=instancing, repeats=repeats, threads=threads
        )
        with progress_bar("record") as progress:
            found = run.record_all(labels, opened, path, profile, options, how, passes, progress)
    else:
        wanted = conditions(opened.scene, path, profile, options)
        found = output.read_recordings(recorded, labels, wanted)
    measured = {
        label: tuple(map(run.measured_of, recordings)) for label, recordings in found.items()
    }
    comparison, pairs = run.simulate_all(labels, opened, path, profile, options, scoring, measured)
    log = {k: v for k, v in found[labels[0]][0].header.items() if k != "policy"}
    validation = compare_sides(comparison, pairs, profile, log)
    if out is not None:
        output.write_validation(out, validation, pairs, found if recorded is None else recorded)
    if as_json:
        print(encode(validation).decode(), end="")
        return
    from rich.console import Console

    from ..analysis.validation.validation_table import print_validation

    width = None if sys.stdout.isatty() else 120  # a pipe has no width of its own
    print_validation(validation, Console(width=width, highlight=False))
    if out is not None:
        print(f"report: {out / 'report.html'}")
