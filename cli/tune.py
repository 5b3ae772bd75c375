"""`lodbench tune`: search better parameters of a policy, and confirm them on other paths."""

from pathlib import Path
from shlex import quote
from typing import Annotated

from typer import Argument, Option

from .shared import options
from .shared.command_line import command_of
from .shared.progress import progress_bar
from .shared.terminal import (
    failure_of,
    open_named_scene,
    print_record,
    table_console,
    tell_field_of_view,
)

Policy = Annotated[str, Argument(help=f"{options.POLICY_HELP}: where the search starts.")]
Over = Annotated[
    list[str] | None,
    Option(
        metavar="NAME[=LOW:HIGH],...",
        help="Parameters to search, and their ranges; else those that the policy declares, of all "
        "that it declares any for. May be repeated.",
    ),
]
Trials = Annotated[int, Option(help="Choices of parameters to try.")]
Out = Annotated[Path | None, Option(metavar="FILE.json", help="Write the record to a file.")]

_NO_MATTER = ("out", "as_json", "workers", "scheduler", "policy_timeout", "policy_memory", "policy")
"""Parameters that do not change what is found, and the policy, which has no option."""


def tune(
    policy: Policy,
    *,
    over: Over = None,
    trials: Trials = 24,
    scene: options.Scene = "district",
    trace: options.Trace = "trial",
    paths: options.Paths = None,
    seconds: options.Seconds = "0:",
    warmup: options.Warmup = 1.0,
    hardware: options.Hardware = "desktop-assumed",
    budget_ms: options.BudgetMs = None,
    miss: options.Miss = 0.01,
    visible: options.Visible = 1.0,
    margin: options.Margin = 0.1,
    quick: options.Quick = False,
    seed: options.Seed = 0,
    place: options.Place = "shrink",
    fovy_deg: options.FovyDeg = None,
    out: Out = None,
    as_json: options.AsJson = False,
    workers: options.Workers = 0,
    scheduler: options.Scheduler = None,
    policy_timeout: options.PolicyTimeout = 60.0,
    policy_memory: options.PolicyMemory = None,
) -> None:
    """Search parameters of a policy for a finer picture within the budget.

    Every trial is brought to the budget by the policy's knob; the gain is confirmed on other paths.
    """
    from ..analysis.report.tuning_table import print_tuning
    from ..analysis.study.compare import (
        DEFAULT_PATHS,
        QUICK_LENGTH_S,
        QUICK_PATHS,
        CompareSettings,
    )
    from ..analysis.study.engine.limits import make_limits
    from ..analysis.study.engine.open_engine import prepare_engine
    from ..analysis.study.field_of_view import field_of_view
    from ..analysis.study.inputs import parse_seconds
    from ..analysis.study.search.drawn_paths import draw_paths
    from ..analysis.study.search.tune_policy import tune_policy
    from ..base.files.strict_json import encode_record
    from ..base.files.whole_file import write_whole
    from ..base.files.writable import require_file_writable
    from ..models.machine.profile_catalog import load_hardware
    from ..policies.registry import parse_policy
    from ..sim.replay import ReplayOptions

    told = command_of(tune, locals(), _NO_MATTER).replace("tune", f"tune {quote(policy)}", 1)
    limits = make_limits(policy_timeout, policy_memory)
    if out is not None:
        require_file_writable(out)
    prepare_engine(scheduler)
    spec, profile = parse_policy(policy), load_hardware(hardware)
    world = open_named_scene(scene).scene
    drawn = draw_paths(
        trace,
        world,
        place,
        paths=paths or (QUICK_PATHS if quick else DEFAULT_PATHS),
        length_s=QUICK_LENGTH_S if quick else None,
        seconds=parse_seconds(seconds),
        seed=seed,
    )
    walked = (*drawn.training, *drawn.judged)
    replay = ReplayOptions(
        budget_ms=profile.budget_ms(budget_ms),
        seed=seed,
        visible_px=visible,
        fovy_deg=field_of_view(walked, fovy_deg),
    )
    tell_field_of_view(walked, replay.fovy_deg)
    settings = CompareSettings(
        warmup_s=warmup,
        miss=miss,
        margin=margin,
        workers=workers,
        policy_limits=limits,
        scheduler=scheduler,
        command=told,
    )
    names = [name for text in over or () for name in text.split(",") if name.strip()]
    with progress_bar("tune", "replays") as progress:
        found = tune_policy(
            spec, names, world, drawn, profile, replay, settings, trials=trials, progress=progress
        )
    unwritten = out and failure_of(lambda: write_whole(out, encode_record(found)))
    if as_json:
        print_record(found)
    else:
        print_tuning(found, table_console(100))
    if unwritten:
        raise unwritten
