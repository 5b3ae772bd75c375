"""`lodbench trace`: look at camera traces, convert them, and generate them."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Option, Typer

from ..base.errors import InputError
from .shared.options import AsJson
from .shared.terminal import print_result

if TYPE_CHECKING:  # numpy is loaded by the command that needs it
    from ..traces.cameras.camera_trace import CameraTrace
    from ..traces.cameras.place import Placement
    from ..traces.cameras.reading.poses import Reading
    from ..traces.cameras.trace_stats import Percentiles, TraceStats

app = Typer(
    name="trace",
    help="Look at camera traces, convert them, and generate them.",
    no_args_is_help=True,
    add_completion=False,
)

Spec = Annotated[
    str, Argument(metavar="TRACE", help="A file, or FILE#SELECTOR to choose within it.")
]
From = Annotated[
    str | None,
    Option("--from", metavar="FORMAT", help="Format of TRACE; else its content decides."),
]
To = Annotated[
    str | None,
    Option("--to", metavar="FORMAT", help="csv, parquet or tum; else the suffix decides."),
]
Scale = Annotated[float, Option(help="Factor on positions, and so on speeds.")]
Offset = Annotated[
    tuple[float, float, float], Option(metavar="X Y Z", help="Added after scaling, in metres.")
]
Up = Annotated[str, Option(help="Axis that points up in the trace: z, y, x, -z, -y or -x.")]
Frame = Annotated[
    str | None,
    Option(
        "--frame",
        metavar="WORDS",
        help="Axes of the file: opengl, opencv, unreal, unity, ned or ros, then x-up to -z-up, "
        "left-handed or right-handed, c2w or w2c, as in opencv,z-up,w2c.",
    ),
]
Unit = Annotated[str | None, Option(help="Of lengths in the file: m, cm, mm, km, in or ft.")]
TimeUnit = Annotated[str | None, Option(help="Of times in the file: s, ms, us or ns.")]
Rate = Annotated[float | None, Option(help="Poses a second, of a file without times.")]
Map = Annotated[
    list[str] | None,
    Option(
        "--map",
        metavar="ROLE=COLUMN,...",
        help="Columns of a table: time, x y z, qx qy qz qw, yaw pitch roll, rx ry rz, "
        "forward_x …, up_x ….  May be repeated.",
    ),
]
Picture = Annotated[Path | None, Option(metavar="FILE.png", help="Draw the path from above.")]
InScene = Annotated[
    str | None, Option("--scene", help="Scene in which --picture shows the path, placed as it is.")
]
Yaw = Annotated[float, Option(help="Turn about the up axis, counter-clockwise from above.")]


@app.command()
def info(
    trace: Spec,
    *,
    source: From = None,
    frame: Frame = None,
    unit: Unit = None,
    time_unit: TimeUnit = None,
    rate: Rate = None,
    columns: Map = None,
    picture: Picture = None,
    scene: InScene = None,
    as_json: AsJson = False,
    scale: Scale = 1.0,
    offset_m: Offset = (0.0, 0.0, 0.0),
    up: Up = "z",
    yaw_deg: Yaw = 0.0,
) -> None:
    """Show duration, rate, speeds and turn rates, gaps, cuts and repairs, and what was assumed.

    With --scale, --offset-m, --up or --yaw-deg: of the trace as placed so.
    """
    from ..traces.cameras.place import Placement
    from ..traces.cameras.sanity import doubts, sanity_line
    from ..traces.cameras.trace_stats import trace_stats

    placement = Placement(scale=scale, offset_m=offset_m, up=up, yaw_deg=yaw_deg)
    reading = _reading(frame, unit, time_unit, rate, columns)
    format_name, placed = _read_placed(trace, source, placement, reading)
    stats = trace_stats(placed)
    if picture is not None:
        _draw(placed, scene, picture)
    if as_json:
        record = {
            "schema": "lodbench.trace-info/2",
            "trace": trace,
            "name": placed.name,
            "format": format_name,
            "origin_s": placed.origin_s,
            "placement": asdict(placement),
            "poses": len(placed),
            "assumed": list(placed.assumed),
            "doubts": list(doubts(placed)),
            "fovy_deg": placed.fovy_deg,
            **asdict(stats),
        }
        print(json.dumps(record))
    else:
        _print_info(placed, format_name, scale, stats)
        print(sanity_line(placed))
        for doubt in doubts(placed):
            print(f"warning: {doubt}")


@app.command()
def convert(
    trace: Spec,
    out: Annotated[Path, Argument(metavar="OUT", help="File to write.")],
    *,
    source: From = None,
    target: To = None,
    frame: Frame = None,
    unit: Unit = None,
    time_unit: TimeUnit = None,
    rate: Rate = None,
    columns: Map = None,
    as_json: AsJson = False,
    scale: Scale = 1.0,
    offset_m: Offset = (0.0, 0.0, 0.0),
    up: Up = "z",
    yaw_deg: Yaw = 0.0,
) -> None:
    """Write a trace in another format, placed into a scene if asked."""
    from ..traces.cameras.place import Placement
    from ..traces.cameras.write_trace import format_for_writing, write_trace

    format_for_writing(out, target)  # refuses a wrong name before the work
    placement = Placement(scale=scale, offset_m=offset_m, up=up, yaw_deg=yaw_deg)
    reading = _reading(frame, unit, time_unit, rate, columns)
    _, placed = _read_placed(trace, source, placement, reading)
    written = write_trace(placed, out, target)
    _report_written("lodbench.trace-convert/1", out, written, placed, as_json=as_json)


@app.command()
def generate(
    kind: Annotated[
        str,
        Argument(
            metavar="KIND",
            help="walk, drive, fly-over, orbit, look-around, dash, teleport, sudden-turn or trial.",
        ),
    ],
    *,
    out: Annotated[Path, Option("--out", help="File to write.")],
    target: To = None,
    duration_s: Annotated[
        float | None, Option(help="Length of the trace; else 60 s, and 12 s of trial.")
    ] = None,
    rate_hz: Annotated[float, Option(help="Samples per second.")] = 60.0,
    speed_m_s: Annotated[float | None, Option(help="Largest speed; else the kind's own.")] = None,
    extent_m: Annotated[float, Option(help="Side of the square that is used.")] = 100.0,
    center_m: Annotated[
        tuple[float, float, float], Option(metavar="X Y Z", help="Middle of the square.")
    ] = (0.0, 0.0, 0.0),
    height_m: Annotated[
        float | None, Option(help="Camera above the middle; else the kind's own.")
    ] = None,
    seed: Annotated[int, Option(help="Same seed, same trace.")] = 0,
    as_json: AsJson = False,
) -> None:
    """Make up a trace of one kind of movement."""
    from ..traces.cameras.generators.generate import generate as generate_trace
    from ..traces.cameras.write_trace import format_for_writing, write_trace

    format_for_writing(out, target)
    made = generate_trace(
        kind,
        duration_s=duration_s,
        rate_hz=rate_hz,
        speed_m_s=speed_m_s,
        extent_m=extent_m,
        center_m=center_m,
        height_m=height_m,
        seed=seed,
    )
    written = write_trace(made, out, target)
    _report_written("lodbench.trace-generate/1", out, written, made, as_json=as_json)


def _reading(
    frame: str | None,
    unit: str | None,
    time_unit: str | None,
    rate: float | None,
    columns: list[str] | None,
) -> "Reading":
    """Return what the user says about the file."""
    from ..traces.cameras.reading.poses import Reading

    named: dict[str, str] = {}
    for pair in filter(None, (pair for text in columns or () for pair in text.split(","))):
        role, equals, column = pair.partition("=")
        if not (role and equals and column):
            raise InputError(f"map: expected ROLE=COLUMN, got {pair!r}; as in --map x=PosX,y=PosY")
        named[role.strip()] = column.strip()
    return Reading(frame=frame, unit=unit, time_unit=time_unit, rate_hz=rate, columns=named)


def _read_placed(
    spec: str, source: str | None, placement: "Placement", reading: "Reading"
) -> tuple[str, "CameraTrace"]:
    """Name of the format that was read, and the trace as placed."""
    from ..traces.cameras.place import place
    from ..traces.cameras.read_trace import format_of, read_trace, split_spec

    format_name = "columns" if reading.columns else source or format_of(split_spec(spec)[0])
    return format_name, place(read_trace(spec, format_name, reading), placement)


def _draw(trace: "CameraTrace", scene: str | None, picture: Path) -> None:
    """Draw a path from above, in a scene if one is named."""
    from ..models.scene.scene_catalog import load_scene
    from ..render.pictures.path_picture import draw_path

    draw_path(trace, None if scene is None else load_scene(scene), picture)


def _report_written(
    schema: str, out: Path, format_name: str, trace: "CameraTrace", *, as_json: bool
) -> None:
    record = {
        "schema": schema,
        "out": str(out),
        "format": format_name,
        "samples": len(trace),
        "duration_s": trace.duration_s,
        "repairs": [str(repair) for repair in trace.repairs],
    }
    written = f"{out}: {len(trace)} samples, {trace.duration_s:.3f} s, {format_name}"
    text = "\n".join((written, *(f"repaired: {repair}" for repair in trace.repairs)))
    print_result(record, text, as_json=as_json)


def _print_info(trace: "CameraTrace", format_name: str, scale: float, stats: "TraceStats") -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(trace.name), show_header=False)
    rows = {
        "format": format_name,
        "samples": f"{stats.samples} at {stats.rate_hz:.4g} Hz",
        "duration": f"{stats.duration_s:.3f} s",
        "path": f"{stats.path_m:.2f} m",
        "from": " ".join(f"{value:.2f}" for value in stats.low_m) + " m",
        "to": " ".join(f"{value:.2f}" for value in stats.high_m) + " m",
        "speed p5 p50 p95 max": _show(stats.speed_m_s) + " m/s",
        "turn p5 p50 p95 max": _show(stats.turn_deg_s) + " deg/s",
        "gaps": f"{stats.gaps}, longest {stats.longest_gap_s:.3f} s" if stats.gaps else "none",
        "cuts": str(stats.cuts or "none"),
        "repairs": "; ".join(stats.repairs) or "none",
        "assumed": "; ".join(trace.assumed) or "nothing",
    }
    if trace.fovy_deg is not None:
        rows["field of view"] = f"{trace.fovy_deg:.4g} degrees, vertical"
    if scale != 1.0:
        rows["placed"] = f"scale {scale:g}: speeds are {scale:g} times the source's"
    for label, value in rows.items():
        table.add_row(label, Text(value))
    Console().print(table)


def _show(percentiles: "Percentiles") -> str:
    return " ".join(f"{value:.3g}" for value in asdict(percentiles).values())
