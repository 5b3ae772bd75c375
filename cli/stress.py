"""`lodbench stress`: look for a camera path on which a policy does badly, and keep it as a test."""

import json
import shlex
from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from .shared import options
from .shared.progress import progress_bar
from .shared.terminal import failure_of

Policy = Annotated[str, Argument(help=f"{options.POLICY_HELP}.")]
Badness = Annotated[
    str,
    Option(
        help="What to look for: overshoot (longest work time over the budget), toggles (a second) "
        "or lag (99th percentile, ms)."
    ),
]
Out = Annotated[
    Path,
    Option(
        metavar="FILE.csv",
        help="Where to save the path; limits that keep it a test are saved beside it.",
    ),
]
SpeedMS = Annotated[float, Option(help="Highest speed of the camera.")]
TurnDegS = Annotated[float, Option(help="Highest turn rate of the camera.")]
DurationS = Annotated[float, Option(help="Length of the path.")]
Legs = Annotated[int, Option(help="Parts of the path of steady speed and turn.")]
Evaluations = Annotated[int, Option(help="Paths to try.")]
PathSeed = Annotated[int, Option(help="Same seed, same path.")]


def stress(
    policy: Policy,
    *,
    scene: options.Scene = "plaza",
    hardware: options.Hardware = "desktop-assumed",
    badness: Badness = "overshoot",
    out: Out = Path("stress.csv"),
    speed_m_s: SpeedMS = 7.0,
    turn_deg_s: TurnDegS = 180.0,
    duration_s: DurationS = 3.0,
    legs: Legs = 6,
    evaluations: Evaluations = 100,
    budget_ms: options.BudgetMs = None,
    warmup_s: options.Warmup = 1.0,
    seed: PathSeed = 0,
    scheduler: options.Scheduler = None,
    policy_timeout: options.PolicyTimeout = 60.0,
    policy_memory: options.PolicyMemory = None,
    as_json: options.AsJson = False,
) -> None:
    """Search camera paths within speed and turn limits for one on which a policy does badly."""
    from ..analysis.study import badness as kinds
    from ..analysis.study import stress as search
    from ..analysis.study.engine.limits import make_limits
    from ..analysis.study.engine.open_engine import prepare_engine
    from ..analysis.study.inputs import load_trace
    from ..base.files.writable import require_file_writable
    from ..models.machine.profile_catalog import load_hardware
    from ..models.scene.scene_catalog import load_scene
    from ..policies.registry import parse_policy
    from ..sim.replay import ReplayOptions
    from ..traces.cameras.write_trace import format_for_writing, write_trace

    format_for_writing(out)
    limits = make_limits(policy_timeout, policy_memory)
    limits_file = out.with_suffix(".limits.toml")
    for file in (out, limits_file):
        require_file_writable(file)
    prepare_engine(scheduler)
    aim = kinds.check_badness(badness)
    spec, world, profile = parse_policy(policy), load_scene(scene), load_hardware(hardware)
    replay = ReplayOptions(budget_ms=profile.budget_ms(budget_ms), seed=seed)
    bounds = search.PathLimits(
        speed_m_s=speed_m_s, turn_deg_s=turn_deg_s, duration_s=duration_s, legs=legs
    )
    with (
        kinds.open_gauge(
            spec,
            world,
            profile,
            replay,
            aim,
            warmup_s=warmup_s,
            limits=limits,
            scheduler=scheduler,
        ) as gauge,
        progress_bar("search", "paths") as progress,
    ):
        walk = gauge(load_trace("walk", world))
        worst = search.stress(
            gauge, world, bounds, seed=seed, evaluations=evaluations, progress=progress
        )
    metric = kinds.METRIC_OF[aim]

    def write() -> None:
        write_trace(worst.trace, out)
        _write_limits(limits_file, kinds.GUARD_OF[aim], policy)

    unwritten = failure_of(write)
    check = ["lodbench", "check", "--policy", policy, "--scene", scene, "--trace", str(out)]
    check += ["--place", "none", "--hardware", hardware, "--limits", str(limits_file)]
    check += ["--baseline", str(out.with_suffix(".baseline.json"))]
    check += ["--seed", str(seed)] if seed else []
    check += ["--warmup", repr(warmup_s)] if warmup_s != 1.0 else []
    check += ["--budget-ms", repr(budget_ms)] if budget_ms is not None else []
    record = {
        "schema": "lodbench.stress/1",
        "policy": policy,
        "scene": world.name,
        "hardware": profile.name,
        "badness": badness,
        "metric": metric,
        "value": worst.value,
        "walk": walk,
        "evaluations": worst.evaluations,
        "trace": str(out),
        "limits": str(limits_file),
        "check": check,
    }
    found = f"{badness} {worst.value:.3g} on the path found, {walk:.3g} on the bundled walk"
    print(json.dumps(record, indent=1) if as_json else found)
    if unwritten is not None:
        raise unwritten
    if as_json:
        return
    print(f"path: {out}")
    print(f"accept it as it is now: {shlex.join([*check, '--update-baseline'])}")
    print(f"test it from then on:   {shlex.join(check)}")


def _write_limits(path: Path, metric: str, policy: str) -> None:
    """Write limits that fail when the policy gets worse on the path, all or nothing."""
    from ..base.files.whole_file import write_whole

    text = (
        f"# Found by `lodbench stress {policy}`: the path must not become worse than it is.\n"
        f'[limits]\n{metric} = {{ max_increase = "5%", population = "this-path" }}\n'
    )
    write_whole(path, text)
