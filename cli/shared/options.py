"""Options that several commands share, declared once; a command's signature has the default."""

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

POLICY_HELP = "NAME, NAME:key=value,key=value, or file.py:Class"
_OR_REFRESH = "Time a frame may take; else one refresh of the display."
_PLACE = (
    "How a trace's file is put into the scene: shrink (centred, scaled down if larger), fit "
    "(scaled to fill it), center or none."
)
_TRACE = "`tour`, a kind of movement (`list traces`), or FILE, FILE#SELECTOR."

AsJson = Annotated[bool, Option("--json", help="Print one JSON document.")]

# What is replayed.
Scene = Annotated[str, Option(help="A bundled scene, or a scene file.")]
SceneWithMeshes = Annotated[str, Option(help="A bundled scene, or a scene file with meshes.")]
Trace = Annotated[str, Option(help=_TRACE)]
Traces = Annotated[
    list[str] | None,
    Option("--trace", help=f"{_TRACE} May be repeated, and a file may be a glob."),
]
Paths = Annotated[
    int | None,
    Option(help="Paths of a kind of movement, each by a seed of its own; else 10, or 4 quick."),
]
Place = Annotated[str, Option(help=_PLACE)]
Hardware = Annotated[str, Option(help="A bundled profile, or a TOML file.")]
Policy = Annotated[str | None, Option(help=f"{POLICY_HELP}.")]
Policies = Annotated[list[str] | None, Option(help=f"{POLICY_HELP}; may be repeated.")]
BudgetMs = Annotated[float | None, Option(help=_OR_REFRESH)]
Seconds = Annotated[
    str, Option(metavar="A:B", help="Stretch of the path to replay, such as 5:20, 5: or :20.")
]
FovyDeg = Annotated[
    float | None,
    Option(help="Vertical field of view; else what the path's file states, or 60."),
]
Eyes = Annotated[
    float | None,
    Option(
        "--eyes",
        metavar="M",
        help="Look with two eyes that are so many metres apart, people's 0.064; each has half of "
        "the display's width.",
    ),
]
EyeSize = Annotated[
    str | None, Option("--eye-size", metavar="WxH", help="Picture of each eye; else half.")
]
SinglePass = Annotated[
    bool,
    Option(
        "--single-pass",
        help="Submit every object once for both eyes (instanced stereo, multiview).",
    ),
]
Players = Annotated[
    int,
    Option(metavar="N", help="Split the screen among players: each N paths, in order, share one."),
]
Seed = Annotated[int, Option(help="Same seed, same results.")]
Pacing = Annotated[
    str | None,
    Option(
        help="What a frame waits for before it samples the camera: none, limiter or just-in-time; "
        "else the profile's."
    ),
]
LatencyLimit = Annotated[
    int | None,
    Option(metavar="N", help="Frames begun and not shown, 0 for no limit; else the profile's."),
]

# How replays are scored.
Warmup = Annotated[
    float, Option("--warmup", metavar="S", help="Seconds at the start that do not count.")
]
Visible = Annotated[
    float,
    Option("--visible", metavar="PX", help="Least error, and change of it, that is seen."),
]
Miss = Annotated[
    float,
    Option(help="Share of time for which a policy may exceed the budget and still keep it."),
]
Margin = Annotated[
    float, Option(help="Part of the best's value within which another is as good; at least .25 px.")
]
Quick = Annotated[
    bool, Option("--quick", help="4 paths of 6 s in place of 10 of 12 s, at less certainty.")
]
Draws = Annotated[
    int,
    Option(help="Draws of the machine, of its fit and its scatter, to replay, if there are any."),
]
Workers = Annotated[int, Option(help="Processes; 0 for one a processor.  Results are the same.")]
Scheduler = Annotated[
    str | None,
    Option(
        metavar="ADDR",
        help="Replay on a Dask cluster in place of processes here: tcp://HOST:PORT, tls://..., a "
        "scheduler file, or config for the address that Dask is configured with.",
    ),
]
PolicyTimeout = Annotated[
    float,
    Option(
        metavar="S",
        help="Seconds without a new frame after which a policy fails; a whole replay may take ten "
        "times as many, and a sixtieth for each frame.",
    ),
]
PolicyMemory = Annotated[
    str | None,
    Option(
        metavar="BYTES",
        help="Memory that a policy may have before it fails, such as 2GB; else 80% of what is "
        "available, divided by the workers.",
    ),
]

# How frames are drawn with OpenGL.
Backend = Annotated[str, Option(help="egl, off screen, or window.")]
Instancing = Annotated[
    bool, Option("--instancing", help="Draw all instances of a level at once, not each on its own.")
]
Repeats = Annotated[int, Option(help="Times that each frame is drawn; the median counts.")]
Threads = Annotated[int, Option(help="Threads of llvmpipe beside the caller's; 0 is the quietest.")]

# How scenes are built from meshes.
Meshes = Annotated[
    list[Path],
    Argument(metavar="MESH...", help="Mesh files, each a type or a tree of its own: obj, ply..."),
]
SceneOut = Annotated[Path, Option("--out", help="Scene file to write, *.lodscene.")]
Layout = Annotated[str, Option(help="grid, scatter, rows, city or forest.")]
MeshSeed = Annotated[int, Option(help="Same seed and meshes, same file.")]
Levels = Annotated[int, Option(help="Levels at most, the full mesh included.")]
SpacingM = Annotated[float, Option(help="Free space between bounding spheres.")]
SideM = Annotated[float | None, Option(help="Side of the square; else as large as needed.")]
RandomYaw = Annotated[bool, Option(help="Turn objects about the vertical.")]
Up = Annotated[str, Option(help="Axis that points up in the files: y or z.")]
HeightM = Annotated[float, Option(help="Height that each mesh is scaled to.")]
UnitM = Annotated[float | None, Option(help="Metres of a file unit, instead of --height-m.")]
