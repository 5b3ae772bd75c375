"""`lodbench record`: replay a trace on a real renderer, and write a render log."""

import json
from pathlib import Path
from typing import Annotated, Any

from typer import Option

from ..base.errors import InputError
from .shared import options
from .shared.picture_size import parse_size
from .shared.progress import progress_bar
from .shared.terminal import open_named_scene, tell_field_of_view

Calibrate = Annotated[
    bool,
    Option(
        "--calibrate",
        help="Instead of a policy, draw what spreads the predictors of a fit: random levels, "
        "swings, levels by size, shares of the objects, sizes of the picture.",
    ),
]
Out = Annotated[Path, Option(metavar="LOG", help="Render log, .parquet or .csv.")]
FrameLogOut = Annotated[
    Path | None, Option(metavar="FILE.parquet", help="Also write a frame log, as compare does.")
]
Images = Annotated[
    Path | None,
    Option(metavar="DIR", help="Write pictures beside full detail, and images.csv: SSIM, FLIP."),
]
ImageEvery = Annotated[int, Option(help="Frames from picture to picture.")]
Size = Annotated[str, Option(help="WIDTHxHEIGHT of the picture.")]
Hardware = Annotated[str, Option(help="Profile that predictive policies go by.")]
Clock = Annotated[
    str,
    Option(
        metavar="wall|thread",
        help="What drawings are timed by; thread is its CPU time, of llvmpipe with --threads 0.",
    ),
]
FramesInFlight = Annotated[
    int,
    Option(
        metavar="F",
        help="Draw a policy's frames 1 to 4 deep, each once, and measure lag; 0 waits for each "
        "drawing of a frame.",
    ),
]
Steps = Annotated[int, Option(help="Poses along the trace that --calibrate draws, twice each.")]
CalibrationSeed = Annotated[int, Option(help="Seed of --calibrate.")]


def record(
    *,
    scene: options.SceneWithMeshes = "plaza",
    trace: options.Trace = "tour",
    policy: options.Policy = None,
    calibrate: Calibrate = False,
    out: Out,
    frame_log: FrameLogOut = None,
    images: Images = None,
    image_every: ImageEvery = 30,
    backend: options.Backend = "egl",
    size: Size = "1280x720",
    instancing: options.Instancing = False,
    hardware: Hardware = "llvmpipe",
    budget_ms: options.BudgetMs = None,
    seconds: options.Seconds = "0:",
    steps: Steps = 1200,
    repeats: options.Repeats = 5,
    threads: options.Threads = 0,
    clock: Clock = "wall",
    frames_in_flight: FramesInFlight = 0,
    seed: CalibrationSeed = 0,
    place: options.Place = "shrink",
    fovy_deg: options.FovyDeg = None,
    as_json: options.AsJson = False,
) -> None:
    """Draw a replay with OpenGL, the policy in closed loop, and log what frames hold and take."""
    from ..analysis.study.field_of_view import field_of_view
    from ..analysis.study.inputs import load_trace, parse_seconds
    from ..analysis.validation.image_folder import image_folder
    from ..analysis.validation.record_options import RecordOptions
    from ..analysis.validation.recording_summary import summary_of
    from ..analysis.validation.recordings import open_recorder
    from ..models.machine.profile_catalog import load_hardware
    from ..render.gl.recorder import recorded_hardware
    from ..sim.frame_log_file import write_frame_log
    from ..sim.replay import ReplayOptions
    from ..traces.logs.log_writer import write_log

    _check_outputs(out, frame_log, images)
    if (policy is None) is not calibrate:
        got = "both" if calibrate else "neither"
        raise InputError(f"record: expected --policy or --calibrate, got {got}; give one")
    profile = recorded_hardware(load_hardware(hardware), parse_size(size))
    opened = open_named_scene(scene)
    path = load_trace(trace, opened.scene, place).stretch(*parse_seconds(seconds))
    budget = profile.budget_ms(budget_ms)
    replay = ReplayOptions(budget_ms=budget, seed=seed, fovy_deg=field_of_view([path], fovy_deg))
    tell_field_of_view([path], replay.fovy_deg)
    drawing = RecordOptions(
        backend=backend,
        instancing=instancing,
        repeats=repeats,
        threads=threads,
        clock=clock,
        frames_in_flight=frames_in_flight,
        calibration_steps=steps,
    )
    with (
        image_folder(images, image_every) as pictures,
        open_recorder(opened, drawing, parse_size(size)) as recorder,
        progress_bar("record", "steps") as progress,
    ):
        recorded = recorder.record(
            policy,
            path,
            profile,
            replay,
            pictures=pictures,
            progress=progress,
            on_pass=lambda found: write_log(out, found.columns, found.header),
        )
        write_log(out, recorded.columns, recorded.header)
        if pictures is not None:
            pictures.write_table(recorded)
        if frame_log is not None:
            write_frame_log(frame_log, recorded.frames)
    _print(summary_of(recorded), as_json=as_json)


def _check_outputs(out: Path, frame_log: Path | None, images: Path | None) -> None:
    """Refuse, before the work, what could not be written after it.

    The folder of pictures is replaced as a whole, so that no log may lie in it.
    """
    from ..traces.logs.log_writer import check_log_path

    check_log_path(out)
    if frame_log is not None:
        check_log_path(frame_log, (".parquet",))
        if frame_log.resolve() == out.resolve():
            raise InputError("--frame-log: expected another file than --out, got the same")
    for file in filter(None, (out, frame_log)):
        if images is not None and file.resolve().is_relative_to(images.resolve()):
            raise InputError(
                "expected a log outside of the folder of pictures, got one in it; name another",
                path=file.resolve(),
            )


def _print(summary: dict[str, Any], *, as_json: bool) -> None:
    if as_json:
        print(json.dumps(summary, ensure_ascii=False))
        return
    means, log = summary["means"], summary["log"]
    print(f"{log['renderer']}, {log['driver']}, {log['resolution']}, {log['date']}")
    print(
        f"{summary['frames']} frames of {summary['frame_ms_mean']:.3g} ms, "
        f"sd {summary['frame_ms_sd']:.3g}, 95 % within {summary['frame_ms_p95']:.3g}"
        + _sentence(summary)
    )
    print(
        f"a frame: {means['draw_calls']:,.0f} draw calls, {means['triangles']:,.0f} triangles, "
        f"{means['shaded_samples']:,.0f} samples; {means['cpu_ms']:.3g} ms to submit"
        + (f", {means['policy_ms']:.3g} ms of the policy, apart" if "policy_ms" in means else "")
    )
    if "gpu_ms" in log:
        print(f"gpu_ms {log['gpu_ms']}; frame_ms is the time to fit")
    if "condition" in summary:
        print(
            "drawn twice, in shuffled order; condition number of draws, triangles, rasterized "
            f"triangles, pixels, uploads and state changes: {summary['condition']:.3g}"
        )
    if "pictures" in summary:
        pictures = summary["pictures"]
        print(
            f"{pictures['count']} pictures against full detail: SSIM {pictures['ssim_mean']:.4f} "
            f"on average, {pictures['ssim_min']:.4f} at worst, difference "
            f"{100.0 * pictures['difference_mean']:.2f} % of the range, FLIP "
            f"{pictures['flip_mean']:.4f}"
        )


def _sentence(summary: dict[str, Any]) -> str:
    """Return what else there is to say of times: of repeats and a reference, or of lag."""
    if "lag_ms_mean" in summary:
        depth = summary["log"]["frames_in_flight"]
        return f"; complete {summary['lag_ms_mean']:.3g} ms after its input, {depth} in flight"
    mean, sd = summary["reference_ms_mean"], summary["reference_ms_sd"]
    return (
        f"; repeats of a frame spread by {summary['repeats_spread_pct']:.2g} %, the reference "
        f"takes {mean:.3g} ms, sd {100.0 * sd / mean:.2g} %"
    )
