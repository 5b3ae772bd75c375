"""`lodbench compare`: replay policies in one world and score them on the same footing."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..base.errors import InputError
from .shared.progress import progress_bar

if TYPE_CHECKING:  # numpy and what needs it are loaded by the command
    from ..analysis.study.comparison import Comparison
    from ..models.machine.hardware import HardwareProfile
    from ..sim.faults import Faults

Text = str | None


def compare(
    *,
    scene: Annotated[str, typer.Option(help="A bundled scene, or a scene file.")] = "plaza",
    trace: Annotated[
        str,
        typer.Option(help="`tour`, a kind of movement (`list traces`), or FILE, FILE#SELECTOR."),
    ] = "tour",
    hardware: Annotated[
        str, typer.Option(help="A bundled profile, or a TOML file.")
    ] = "desktop-assumed",
    policy: Annotated[
        list[str] | None,
        typer.Option(
            help="NAME, NAME:key=value,key=value, or file.py:Class; may be repeated. "
            "Without it, every registered policy."
        ),
    ] = None,
    budget_ms: Annotated[
        float | None, typer.Option(help="Time a frame may take; else one refresh of the display.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Same seed, same results.")] = 0,
    frames: Annotated[
        int | None, typer.Option(help="Frames to replay; else as long as the trace lasts.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Write report.html, comparison.json and frames/POLICY.parquet. "
            "Only a folder that compare wrote is replaced.",
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON document.")] = False,
    wide: Annotated[
        bool, typer.Option("--wide", help="Print every metric with its interval.")
    ] = False,
    warmup: Annotated[int, typer.Option(help="Frames at the start that do not count.")] = 30,
    workers: Annotated[
        int, typer.Option(help="Processes; 0 for one a processor.  Results are the same.")
    ] = 0,
    draws: Annotated[
        int, typer.Option(help="Posterior draws of the cost model to replay, if there are any.")
    ] = 16,
    resamples: Annotated[int, typer.Option(help="Bootstrap resamples.")] = 200,
    place: Annotated[
        str,
        typer.Option(
            help="How a trace's file is put into the scene: shrink (centred, scaled down if "
            "larger), fit (scaled to fill it), center or none."
        ),
    ] = "shrink",
    display: Annotated[
        Text, typer.Option(help="immediate, vsync, mailbox or vrr; else the profile's.")
    ] = None,
    refresh_hz: Annotated[
        float | None, typer.Option(help="Refresh rate; else the profile's.")
    ] = None,
    frames_in_flight: Annotated[
        int | None, typer.Option(help="1 to 4; else the profile's.")
    ] = None,
    fovy_deg: Annotated[float, typer.Option(help="Vertical field of view.")] = 60.0,
    crossfade_ms: Annotated[
        float, typer.Option(help="Time for which a switched node is drawn at both levels.")
    ] = 0.0,
    measurement_delay: Annotated[
        int, typer.Option(help="Frames after completion until a policy learns a frame's time.")
    ] = 0,
    faults: Annotated[
        str,
        typer.Option(help="Faulty timers: missing=SHARE,zero=SHARE,stale=SHARE,saturated_ms=MS."),
    ] = "",
) -> None:
    """Compare policies on a camera trace: budget, lag, flicker, quality, and which beats which."""
    from ..analysis.study import compare as analysis
    from ..analysis.study.comparison_folder import check_target, write_results
    from ..analysis.study.inputs import load_trace
    from ..models.machine.profile_catalog import load_hardware
    from ..models.scene.scene_catalog import load_scene
    from ..policies.registry import default_policies, parse_policy
    from ..sim.replay import ReplayOptions
    from .shared.scene_output import opening

    if out is not None:
        check_target(out)
    profile = _adjusted(load_hardware(hardware), display, refresh_hz, frames_in_flight)
    with opening(scene):
        loaded = load_scene(scene)
    with progress_bar("replay") as progress:
        comparison, logs = analysis.compare(
            [parse_policy(text) for text in policy or default_policies()],
            loaded,
            load_trace(trace, loaded, place),
            profile,
            ReplayOptions(
                budget_ms=1e3 / profile.display.refresh_hz if budget_ms is None else budget_ms,
                seed=seed,
                frames=frames,
                fovy_deg=fovy_deg,
                crossfade_ms=crossfade_ms,
                measurement_delay=measurement_delay,
                faults=_parse_faults(faults),
            ),
            analysis.CompareOptions(
                warmup=warmup, resamples=resamples, draws=draws, workers=workers
            ),
            progress=progress,
        )
    if out is not None:
        write_results(out, comparison, logs)
    _print(comparison, as_json=as_json, wide=wide)
    if out is not None and not as_json:
        print(f"report: {out / 'report.html'}")
    if comparison.failed:
        raise typer.Exit(1)


def _adjusted(
    profile: "HardwareProfile",
    display: str | None,
    refresh_hz: float | None,
    frames_in_flight: int | None,
) -> "HardwareProfile":
    """Return the profile with what the user wants otherwise."""
    from dataclasses import replace
    from typing import Any

    wanted: dict[str, Any] = {"mode": display, "refresh_hz": refresh_hz}
    changes = {key: value for key, value in wanted.items() if value is not None}
    if refresh_hz is not None and refresh_hz > 0.0:  # a slower display's range goes with it
        changes["vrr_min_hz"] = min(profile.display.vrr_min_hz, refresh_hz)
    in_flight = profile.frames_in_flight if frames_in_flight is None else frames_in_flight
    screen = replace(profile.display, **changes)
    return replace(profile, display=screen, frames_in_flight=in_flight)


def _parse_faults(text: str) -> "Faults":
    """Return the faults that ``kind=number,kind=number`` names."""
    from dataclasses import fields

    from ..sim.faults import Faults

    kinds = [field.name for field in fields(Faults)]
    numbers: dict[str, float] = {}
    for item in filter(None, text.split(",")):
        kind, _, number = item.partition("=")
        try:
            numbers[kind] = float(number)
        except ValueError:
            kind = ""
        if kind not in kinds:
            raise InputError(
                f"--faults: expected KIND=NUMBER with a kind of {', '.join(kinds)}, got {item}"
            )
    return Faults(**numbers)


def _print(comparison: "Comparison", *, as_json: bool, wide: bool) -> None:
    if as_json:
        from ..analysis.study.comparison import encode_comparison

        print(encode_comparison(comparison).decode(), end="")
        return
    from rich.console import Console

    from ..analysis.report.terminal_table import print_comparison

    # A pipe has no width of its own.
    width = None if sys.stdout.isatty() else 160 if wide else 100
    print_comparison(comparison, Console(width=width, highlight=False), wide=wide)
