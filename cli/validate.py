"""`lodbench validate`: record policies on a real renderer, simulate the same, and compare."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Exit, Option

from ..base.errors import InputError
from .record import Clock, FramesInFlight
from .shared import options
from .shared.picture_size import parse_size
from .shared.progress import progress_bar
from .shared.terminal import (
    failure_of,
    open_named_scene,
    print_record,
    table_console,
    tell_field_of_view,
)

if TYPE_CHECKING:  # numpy and what needs it are loaded by the command
    from ..analysis.validation.record_options import RecordOptions
    from ..analysis.validation.run_cases import CaseInputs
    from ..analysis.validation.study_file import CaseSpec
    from ..models.machine.hardware import HardwareProfile

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

TREE_POLICIES = ("cluster-cut", "erikson", "maciel", "mason-blake", "zach")
"""The same of scenes that are trees."""

_FIRST_S = 10.0

StudyFile = Annotated[
    Path | None,
    Argument(
        metavar="[STUDY.toml]",
        help="Several paths in one validation: [[case]] with scene and trace; and budget_ms, "
        "seconds, place, fovy_deg, policies, frames_in_flight and threads where they differ from "
        "the options.",
    ),
]
Hardware = Annotated[str, Option(help="The profile to be tested: bundled, or a TOML file.")]
Policies = Annotated[
    list[str] | None,
    Option(
        help=f"{options.POLICY_HELP}; may be repeated.  Without it, {', '.join(POLICIES)}; in a "
        f"scene that is a tree, {', '.join(TREE_POLICIES)}."
    ),
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
        metavar="DIR",
        help="Write report.html, validation.json, and logs recorded and simulated.  Recordings "
        "stand in DIR.recordings as each ends, until all is done.",
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
Replicates = Annotated[
    int,
    Option(help="Simulated recordings of each policy, by which intervals are made; 19 at least."),
]
NoiseSeed = Annotated[int, Option(help="Seed of the simulated noise.")]


def validate(
    study: StudyFile = None,
    *,
    scene: options.SceneWithMeshes = "market",
    trace: options.Trace = "drive",
    hardware: Hardware = "llvmpipe",
    policy: Policies = None,
    recorded: RecordedIn = None,
    out: Out = None,
    budget_ms: options.BudgetMs = None,
    size: Size = None,
    fovy_deg: options.FovyDeg = None,
    seconds: Seconds = None,
    passes: Passes = 2,
    repeats: options.Repeats = 3,
    warmup_s: options.Warmup = 1.0,
    replicates: Replicates = 40,
    workers: options.Workers = 0,
    scheduler: options.Scheduler = None,
    policy_timeout: options.PolicyTimeout = 60.0,
    policy_memory: options.PolicyMemory = None,
    backend: options.Backend = "egl",
    instancing: options.Instancing = False,
    threads: options.Threads = 0,
    clock: Clock = "wall",
    frames_in_flight: FramesInFlight = 0,
    seed: NoiseSeed = 0,
    place: options.Place = "shrink",
    as_json: options.AsJson = False,
) -> None:
    """Compare simulated with measured: frame times, metrics, verdict, and order of policies."""
    from ..analysis.study.compare import CompareSettings
    from ..analysis.study.engine.limits import make_limits
    from ..analysis.validation.record_options import RecordOptions
    from ..analysis.validation.recording_folder import find_recordings
    from ..analysis.validation.replays import require_passes
    from ..analysis.validation.replicates import require_replicates
    from ..analysis.validation.run_cases import Source, carry_out
    from ..analysis.validation.shown.tables import print_validation
    from ..analysis.validation.study_file import CaseSpec, read_cases
    from ..analysis.validation.validate import require_priced
    from ..analysis.validation.validation_folder import (
        claimed_validation,
        recordings_beside,
        write_validation,
    )
    from ..models.machine.profile_catalog import load_hardware
    from ..render.gl.recorder import recorded_hardware

    limits = make_limits(policy_timeout, policy_memory)
    require_passes(passes)
    require_replicates(replicates)
    _check_outputs(out, recorded)
    labels = tuple(policy) if policy else None
    given = CaseSpec(
        scene, trace, budget_ms, seconds, place, fovy_deg, labels, frames_in_flight, threads
    )
    drawing = RecordOptions(backend=backend, instancing=instancing, repeats=repeats, clock=clock)
    specs = [given] if study is None else [case.or_else(given) for case in read_cases(study)]
    with claimed_validation(out, recorded):
        profile = load_hardware(hardware)
        require_priced(profile)
        own_size = profile.display.width_px, profile.display.height_px
        drawn = recorded_hardware(profile, own_size if size is None else parse_size(size))
        # Before hours of recording, all that can be refused.
        cases = [_prepare(spec, drawn, drawing, seed, warmup_s) for spec in specs]
        scoring = CompareSettings(
            warmup_s=warmup_s, workers=workers, policy_limits=limits, scheduler=scheduler
        )
        found = None if recorded is None else find_recordings(recorded)
        kept = recordings_beside(out) if out is not None and found is None else None
        source = Source(recorded=found, kept=kept, passes=passes)
        with progress_bar("validate", "steps") as progress:
            done = carry_out(cases, source, scoring, replicates, progress)
        unwritten = None
        if out is not None and (recordings := found or kept) is not None:
            written = (done.validation, done.names, done.series, recordings)
            unwritten = failure_of(lambda: write_validation(out, *written))
    if as_json:
        print_record(done.validation)
    else:
        print_validation(done.validation, table_console(140))
    if unwritten:
        raise unwritten
    if out is not None and not as_json:
        print(f"report: {out / 'report.html'}")
    if any(case.failed for case in done.validation.cases):
        raise Exit(1)


def _prepare(
    spec: "CaseSpec",
    hardware: "HardwareProfile",
    drawing: "RecordOptions",
    seed: int,
    warmup_s: float,
) -> "CaseInputs":
    """Return a case, loaded and checked; raises `InputError` if it cannot be recorded."""
    from ..analysis.metrics.measured_frames import require_window
    from ..analysis.study.field_of_view import field_of_view
    from ..analysis.study.inputs import load_trace, parse_seconds
    from ..analysis.validation.recordings import require_recordable
    from ..analysis.validation.run_cases import CaseInputs
    from ..analysis.validation.validate import require_other_frames
    from ..sim.replay import ReplayOptions

    if spec.policies and len(set(spec.policies)) < len(spec.policies):
        raise InputError("--policy: expected each once, got one twice; name it once")
    opened = open_named_scene(spec.scene)
    whole = load_trace(spec.trace, opened.scene, spec.place or "shrink")
    replay = ReplayOptions(
        budget_ms=hardware.budget_ms(spec.budget_ms),
        seed=seed,
        fovy_deg=field_of_view([whole], spec.fovy_deg),
    )
    tell_field_of_view([whole], replay.fovy_deg)
    require_other_frames(hardware, opened.scene.name, whole.name)
    first = (0.0, min(_FIRST_S, whole.duration_s))
    path = whole.stretch(*(first if spec.seconds is None else parse_seconds(spec.seconds)))
    require_window(warmup_s, path.duration_s)
    labels = spec.policies or (POLICIES if opened.scene.flat else TREE_POLICIES)
    require_recordable(labels, opened.scene)
    deep, threads = spec.frames_in_flight or 0, spec.threads or 0
    drawing = replace(drawing, frames_in_flight=deep, threads=threads)
    return CaseInputs(opened, path, labels, replay, hardware, drawing)


def _check_outputs(out: Path | None, recorded: Path | None) -> None:
    """Refuse, before the work, what could not be written after it."""
    if out is None or recorded is None:
        return
    if recorded.absolute() in out.absolute().parents:
        raise InputError("expected a folder beside the recordings, got one in them", path=out)
