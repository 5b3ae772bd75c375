"""`lodbench record`: replay a trace on a real renderer, and write a render log."""

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from ..base.errors import InputError
from .shared.progress import progress_bar


def record(
    *,
    scene: Annotated[
        str, typer.Option(help="A bundled scene, or a scene file with meshes.")
    ] = "plaza",
    trace: Annotated[
        str,
        typer.Option(help="`tour`, a kind of movement (`list traces`), or FILE, FILE#SELECTOR."),
    ] = "tour",
    policy: Annotated[
        str | None, typer.Option(help="NAME, NAME:key=value,key=value, or file.py:Class.")
    ] = None,
    calibrate: Annotated[
        bool,
        typer.Option(
            "--calibrate",
            help="Instead of a policy, draw what spreads the predictors of a fit: random levels, "
            "swings, levels by size, shares of the objects, sizes of the picture.",
        ),
    ] = False,
    out: Annotated[Path, typer.Option(metavar="LOG", help="Render log, .parquet or .csv.")],
    frame_log: Annotated[
        Path | None,
        typer.Option(metavar="FILE.parquet", help="Also write a frame log, as compare does."),
    ] = None,
    images: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Write pictures beside full detail, and images.csv with SSIM."
        ),
    ] = None,
    image_every: Annotated[int, typer.Option(help="Frames from picture to picture.")] = 30,
    backend: Annotated[str, typer.Option(help="egl, off screen, or window.")] = "egl",
    size: Annotated[str, typer.Option(help="WIDTHxHEIGHT of the picture.")] = "1280x720",
    instancing: Annotated[
        bool,
        typer.Option(
            "--instancing", help="Draw all instances of a level at once, not each on its own."
        ),
    ] = False,
    hardware: Annotated[
        str, typer.Option(help="Profile that predictive policies go by.")
    ] = "llvmpipe",
    budget_ms: Annotated[
        float | None, typer.Option(help="Time a frame may take; else one refresh of the display.")
    ] = None,
    frames: Annotated[
        int | None,
        typer.Option(help="Frames; else as long as the trace lasts, or 1200 to calibrate."),
    ] = None,
    repeats: Annotated[
        int, typer.Option(help="Times that each frame is drawn; the median counts.")
    ] = 5,
    threads: Annotated[
        int, typer.Option(help="Threads of llvmpipe beside the caller's; 0 is the quietest.")
    ] = 0,
    seed: Annotated[int, typer.Option(help="Seed of --calibrate.")] = 0,
    place: Annotated[
        str, typer.Option(help="shrink, fit, center or none, as for compare.")
    ] = "shrink",
    fovy_deg: Annotated[float, typer.Option(help="Vertical field of view.")] = 60.0,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON document.")] = False,
) -> None:
    """Draw a replay with OpenGL, the policy in closed loop, and log what frames hold and take."""
    from ..analysis.study.inputs import load_trace
    from ..analysis.validation.image_folder import image_folder
    from ..analysis.validation.recordings import RecordOptions, open_recorder, summary_of
    from ..models.machine.profile_catalog import load_hardware
    from ..models.scene.scene_catalog import open_scene
    from ..render.gl.recorder import recorded_hardware
    from ..sim.frame_log_file import write_frame_log
    from ..sim.replay import ReplayOptions
    from ..traces.logs.log_writer import check_log_path, write_log
    from .shared.scene_output import opening

    check_log_path(out)
    if frame_log is not None:
        check_log_path(frame_log, (".parquet",))
        if frame_log.resolve() == out.resolve():
            raise InputError("--frame-log: expected another file than --out, got the same")
    for file in (out, frame_log):
        if images is not None and file is not None:
            _require_apart(file.resolve(), images.resolve())
    if (policy is None) is not calibrate:
        got = "both" if calibrate else "neither"
        raise InputError(f"record: expected --policy or --calibrate, got {got}; give one")
    profile = recorded_hardware(load_hardware(hardware), parse_size(size))
    with opening(scene):
        opened = open_scene(scene)
    path = load_trace(trace, opened.scene, place)
    options = ReplayOptions(
        budget_ms=1e3 / profile.display.refresh_hz if budget_ms is None else budget_ms,
        seed=seed,
        frames=frames,
        fovy_deg=fovy_deg,
    )
    how = RecordOptions(backend=backend, instancing=instancing, repeats=repeats, threads=threads)
    with (
        image_folder(images, image_every) as pictures,
        open_recorder(opened, how, parse_size(size)) as recorder,
        progress_bar("record") as progress,
    ):
        found = recorder.record(
            policy, path, profile, options, pictures=pictures, progress=progress
        )
        if pictures is not None:
            pictures.write_table(found)
        write_log(out, found.columns, found.header)
        if frame_log is not None:
            write_frame_log(frame_log, found.frames)
    _print(summary_of(found), as_json=as_json)


def _require_apart(file: Path, images: Path) -> None:
    """Refuse a log inside the folder of pictures, which is replaced as a whole."""
    if images == file or images in file.parents:
        raise InputError(
            "expected a log outside of the folder of pictures, got one in it; name another",
            path=file,
        )


def parse_size(text: str) -> tuple[int, int]:
    """Return width and height of ``WIDTHxHEIGHT``; raises InputError for anything else."""
    width, _, height = text.partition("x")
    if all(
        side.isascii() and side.isdecimal() and 16 <= int(side) <= 16384 for side in (width, height)
    ):
        return int(width), int(height)
    raise InputError(f"--size: expected WIDTHxHEIGHT from 16x16 to 16384x16384, got {text}")


def _print(summary: dict[str, Any], *, as_json: bool) -> None:
    if as_json:
        print(json.dumps(summary, ensure_ascii=False))
        return
    means, log = summary["means"], summary["log"]
    print(f"{log['renderer']}, {log['driver']}, {log['resolution']}, {log['date']}")
    print(
        f"{summary['frames']} frames of {summary['frame_ms_mean']:.3g} ms, "
        f"sd {summary['frame_ms_sd']:.3g}, 95 % within {summary['frame_ms_p95']:.3g}; "
        f"repeats of a frame spread by {summary['repeats_spread_pct']:.2g} %"
    )
    print(
        f"a frame: {means['draw_calls']:,.0f} draw calls, {means['triangles']:,.0f} triangles, "
        f"{means['shaded_samples']:,.0f} samples; {means['cpu_ms']:.3g} ms to submit, "
        f"{means['policy_ms']:.3g} ms of the policy, apart"
    )
    if "gpu_ms" in log:
        print(f"gpu_ms {log['gpu_ms']}; frame_ms is the time to fit")
    if "pictures" in summary:
        pictures = summary["pictures"]
        print(
            f"{pictures['count']} pictures against full detail: SSIM {pictures['ssim_mean']:.4f} "
            f"on average, {pictures['ssim_min']:.4f} at worst, difference "
            f"{100.0 * pictures['difference_mean']:.2f} % of the range"
        )
