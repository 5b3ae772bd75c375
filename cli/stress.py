"""`lodbench stress`: look for a camera path on which a policy does badly, and keep it as a test."""

import json
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from .shared.progress import progress_bar


def stress(
    policy: Annotated[str, typer.Argument(help="NAME, NAME:key=value, or file.py:Class.")],
    *,
    scene: Annotated[str, typer.Option(help="A bundled scene, or a scene file.")] = "plaza",
    hardware: Annotated[
        str, typer.Option(help="A bundled profile, or a TOML file.")
    ] = "desktop-assumed",
    badness: Annotated[
        str,
        typer.Option(
            help="What to look for: overshoot (longest work time over the budget), toggles (a "
            "frame) or lag (99th percentile, ms)."
        ),
    ] = "overshoot",
    out: Annotated[
        Path,
        typer.Option(
            metavar="FILE.csv",
            help="Where to save the path; limits that keep it a test are saved beside it.",
        ),
    ] = Path("stress.csv"),
    speed_m_s: Annotated[float, typer.Option(help="Highest speed of the camera.")] = 7.0,
    turn_deg_s: Annotated[float, typer.Option(help="Highest turn rate of the camera.")] = 180.0,
    duration_s: Annotated[float, typer.Option(help="Length of the path.")] = 3.0,
    legs: Annotated[int, typer.Option(help="Parts of the path of steady speed and turn.")] = 6,
    evaluations: Annotated[int, typer.Option(help="Paths to try.")] = 100,
    budget_ms: Annotated[
        float | None, typer.Option(help="Time a frame may take; else one refresh of the display.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Same seed, same path.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON document.")] = False,
) -> None:
    """Search camera paths within speed and turn limits for one on which a policy does badly."""
    from ..analysis.study import stress as search
    from ..analysis.study.inputs import load_trace
    from ..models.machine.profile_catalog import load_hardware
    from ..models.scene.scene_catalog import load_scene
    from ..policies.registry import parse_policy
    from ..sim.replay import ReplayOptions
    from ..traces.cameras.write_trace import format_for_writing, write_trace

    format_for_writing(out)
    aim = search.check_badness(badness)
    spec, loaded, profile = parse_policy(policy), load_scene(scene), load_hardware(hardware)
    options = ReplayOptions(
        budget_ms=1e3 / profile.display.refresh_hz if budget_ms is None else budget_ms, seed=seed
    )
    bounds = search.PathLimits(
        speed_m_s=speed_m_s, turn_deg_s=turn_deg_s, duration_s=duration_s, legs=legs
    )
    with progress_bar("search") as progress:
        found = search.stress(
            spec, loaded, profile, options, aim, bounds, evaluations=evaluations, progress=progress
        )
    on_walk = search.measure_badness(
        spec, loaded, load_trace("walk", loaded), profile, options, aim
    )
    write_trace(found.trace, out)
    limits = out.with_suffix(".limits.toml")
    metric = search.METRIC_OF[aim]
    _write_limits(limits, metric, policy)
    check = ["lodbench", "check", "--policy", policy, "--scene", scene, "--trace", str(out)]
    check += ["--place", "none", "--hardware", hardware, "--limits", str(limits)]
    check += ["--baseline", str(out.with_suffix(".baseline.json"))]
    check += ["--seed", str(seed)] if seed else []
    check += ["--budget-ms", repr(budget_ms)] if budget_ms is not None else []
    record = {
        "schema": "lodbench.stress/1",
        "policy": policy,
        "scene": loaded.name,
        "hardware": profile.name,
        "badness": badness,
        "metric": metric,
        "value": found.value,
        "walk": on_walk,
        "evaluations": found.evaluations,
        "trace": str(out),
        "limits": str(limits),
        "check": check,
    }
    print(json.dumps(record, indent=1) if as_json else _text(record, check))


def _text(record: Mapping[str, object], check: list[str]) -> str:
    """Return what was found, and how to keep it as a test."""
    badness, value, walk = record["badness"], record["value"], record["walk"]
    return "\n".join(
        (
            f"{badness} {value:.3g} on the path found, {walk:.3g} on the bundled walk",
            f"path: {record['trace']}",
            f"accept it as it is now: {shlex.join([*check, '--update-baseline'])}",
            f"test it from then on:   {shlex.join(check)}",
        )
    )


def _write_limits(path: Path, metric: str, policy: str) -> None:
    """Write limits that fail when the policy gets worse on the path, all or nothing."""
    from ..base.whole_file import write_whole

    text = (
        f"# Found by `lodbench stress {policy}`: the path must not become worse than it is.\n"
        f'[limits]\n{metric} = {{ max_increase = "5%" }}\n'
    )
    write_whole(path, text)
