"""`lodbench validate`: record policies on a real renderer, simulate the same, and compare."""

from pathlib import Path
from typing import Annotated

from typer import Option

from ..base.errors import InputError
from .shared import options
from .shared.picture_size import parse_size
from .shared.progress import progress_bar
from .shared.terminal import (
    failure_of,
    open_named_scene,
    print_record,
    table_console,
)

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

_FIRST_S = 10.0


Hardware = Annotated[str, Option(help="The profile to be tested: bundled, or a TOML file.")]
Policies = Annotated[
    list[str] | None,
    Option(help=f"{options.POLICY_HELP}; may be repeated.  Without it, {', '.join(POLICIES)}."),
]
RecordedIn = Annotated[
    Path | None,
    Option(
        metavar="DIR",
        help="Take the recordings that an earlier validate wrote there, with its scene, trace, "
        "budget and size; how they were drawn is theirs.",
    ),
]
Out = Annotated[
    Path | None,
    Option(
        metavar="DIR", help="Write report.html, validation.json, and logs recorded and simulated."
    ),
]
Size = Annotated[str | None, Option(help="WIDTHxHEIGHT of the picture; else the profile's.")]
Seconds = Annotated[
    str | None,
    Option(metavar="A:B", help="Stretch of the path, such as 5:20; else its first 10 seconds."),
]
Passes = Annotated[
    int, Option(help="Recordings of each policy; a second shows the machine's own noise.")
]
NoiseSeed = Annotated[int, Option(help="Seed of the simulated noise.")]


def validate(
    *,
    scene: options.SceneWithMeshes = "market",
    trace: options.Trace = "drive",
    hardware: Hardware = "llvmpipe",
    policy: Policies = None,
    recorded: RecordedIn = None,
    out: Out = None,
    budget_ms: options.BudgetMs = None,
    size: Size = None,
    seconds: Seconds = None,
    passes: Passes = 2,
    repeats: options.Repeats = 3,
    warmup_s: options.Warmup = 1.0,
    draws: options.Draws = 16,
    workers: options.Workers = 0,
    scheduler: options.Scheduler = None,
    policy_timeout: options.PolicyTimeout = 60.0,
    policy_memory: options.PolicyMemory = None,
    backend: options.Backend = "egl",
    instancing: options.Instancing = False,
    threads: options.Threads = 0,
    seed: NoiseSeed = 0,
    place: options.Place = "shrink",
    as_json: options.AsJson = False,
) -> None:
    """Compare simulated with measured: errors of frame times, metrics, and order of policies."""
    from ..analysis.metrics.measured_frames import require_window
    from ..analysis.study.compare import CompareSettings
    from ..analysis.study.engine.limits import make_limits
    from ..analysis.study.inputs import load_trace, parse_seconds
    from ..analysis.validation import replays
    from ..analysis.validation.recordings import RecordOptions, conditions, require_recordable
    from ..analysis.validation.validate import Pair, require_other_frames, require_priced
    from ..analysis.validation.validate import validate as compare_sides
    from ..analysis.validation.validation_folder import (
        claimed_validation,
        read_recordings,
        write_validation,
    )
    from ..analysis.validation.validation_table import print_validation
    from ..models.machine.profile_catalog import load_hardware
    from ..render.gl.recorder import recorded_hardware
    from ..sim.replay import ReplayOptions

    limits = make_limits(policy_timeout, policy_memory)
    labels = list(policy or POLICIES)
    _check_arguments(labels, out, recorded)
    with claimed_validation(out):
        profile = load_hardware(hardware)
        replay = ReplayOptions(budget_ms=profile.budget_ms(budget_ms), seed=seed)
        own_size = profile.display.width_px, profile.display.height_px
        profile = recorded_hardware(profile, own_size if size is None else parse_size(size))
        opened = open_named_scene(scene)
        whole = load_trace(trace, opened.scene, place)
        require_other_frames(profile, opened.scene.name, whole.name)
        path = whole.stretch(
            *((0.0, min(_FIRST_S, whole.duration_s)) if seconds is None else parse_seconds(seconds))
        )
        require_window(warmup_s, path.duration_s)  # before hours of recording
        require_priced(profile)
        require_recordable(labels, opened.scene)
        scoring = CompareSettings(
            warmup_s=warmup_s,
            draws=draws,
            workers=workers,
            policy_limits=limits,
            scheduler=scheduler,
        )
        drawing = RecordOptions(
            backend=backend, instancing=instancing, repeats=repeats, threads=threads
        )
        if recorded is None:
            with progress_bar("record", "steps") as progress:
                recordings = replays.record_all(
                    labels, opened, path, profile, replay, drawing, passes, progress
                )
        else:
            same = conditions(opened.scene, path, profile, replay)
            recordings = read_recordings(recorded, labels, same)
        measured = {
            label: tuple(map(replays.measured_of, passed)) for label, passed in recordings.items()
        }
        with progress_bar("simulate") as progress:
            simulation = replays.simulate_all(
                labels, opened.scene, path, profile, replay, scoring, progress
            )
        pairs = {label: Pair(measured[label], simulation.policies[label].log) for label in labels}
        log = {k: v for k, v in recordings[labels[0]][0].header.items() if k != "policy"}
        validation = compare_sides(simulation, pairs, profile, log)
        kept = recorded or recordings
        unwritten = out and failure_of(lambda: write_validation(out, validation, pairs, kept))
    if as_json:
        print_record(validation)
    else:
        print_validation(validation, table_console(120))
    if unwritten:
        raise unwritten
    if out is not None and not as_json:
        print(f"report: {out / 'report.html'}")


def _check_arguments(labels: list[str], out: Path | None, recorded: Path | None) -> None:
    """Refuse, before the work, what could not be compared or written after it."""
    if len(set(labels)) < len(labels):
        raise InputError("--policy: expected each once, got one twice; name it once")
    if out is None or recorded is None:
        return
    if recorded.absolute() in out.absolute().parents:
        raise InputError("expected a folder beside the recordings, got one in them", path=out)
