"""`lodbench export`: a run for the viewers, and a policy for the engines, that users have."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Option

from ..base.errors import InputError
from .shared.options import AsJson
from .shared.terminal import open_named_scene, print_record, print_result

if TYPE_CHECKING:  # numpy and pyarrow are loaded by the command that needs them
    from ..sim.frame_log import FrameLog


def export(
    run: Annotated[
        Path | None,
        Argument(
            metavar="[RUN]",
            help="A folder that `compare --out` wrote, or one frames/POLICY.parquet.",
            show_default=False,
        ),
    ] = None,
    *,
    export_format: Annotated[
        str | None, Option("--format", help="presentmon, capframex or chrome-trace.")
    ] = None,
    engine: Annotated[
        str | None,
        Option(help="Settings in place of a run: unity, unreal, godot, threejs or cesium."),
    ] = None,
    policy: Annotated[
        str | None,
        Option(
            help="Which policy of a folder, by its name or its file's. With --engine and without a "
            "folder: NAME:key=value."
        ),
    ] = None,
    scene: Annotated[
        str | None,
        Option(help="With --engine: the scene whose levels are set; else the comparison's."),
    ] = None,
    fovy_deg: Annotated[
        float | None,
        Option(help="With --engine: vertical field of view; else the comparison's, or 60."),
    ] = None,
    out: Annotated[
        Path | None,
        Option(
            "--out",
            help="File to write; else POLICY and the format's ending, here. With --engine JSON, "
            "else printed.",
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Write a run for viewers (PresentMon, CapFrameX, Perfetto), or a policy for an engine."""
    from ..sim.export.export import EXPORTS

    if engine is not None:
        if export_format is not None:
            raise InputError("--engine: expected no --format beside it, got both; leave one out")
        _export_settings(engine, run, policy, scene, fovy_deg, out, as_json=as_json)
        return
    if scene is not None or fovy_deg is not None:
        raise InputError("--scene, --fovy-deg: expected --engine beside them; a run has its own")
    if export_format not in EXPORTS:
        raise InputError(
            f"--format: expected one of {', '.join(EXPORTS)}, got {export_format or 'none'}; name "
            "one, or an --engine"
        )
    if run is None:
        raise InputError("export: expected a folder or file of frames, got none; name one")
    path, log = _read_run(run, policy)
    target = out or Path(path.stem + EXPORTS[export_format].suffix)
    EXPORTS[export_format].write(log, target)
    record = {
        "schema": "lodbench.export/1",
        "run": str(path),
        "policy": log.header.policy,
        "format": export_format,
        "out": str(target),
        "frames": len(log),
    }
    text = f"{target}: {len(log)} frames of {log.header.policy}, {export_format}"
    print_result(record, text, as_json=as_json)


def _export_settings(
    engine: str,
    run: Path | None,
    policy: str | None,
    scene: str | None,
    fovy_deg: float | None,
    out: Path | None,
    *,
    as_json: bool,
) -> None:
    """Print a policy as settings of an engine, or write them."""
    from ..analysis.export.engines import engine_settings, exported_policy, require_counterpart
    from ..analysis.export.settings_text import settings_text
    from ..analysis.study.comparison import read_comparison
    from ..analysis.study.comparison_folder import COMPARISON
    from ..base.files.strict_json import encode_record
    from ..base.files.whole_file import write_whole
    from ..models.scene.scene_catalog import list_bundled_scenes
    from ..policies.registry import parse_policy, policy_text

    if run is not None:
        comparison = read_comparison((run if run.is_dir() else run.parent) / COMPARISON)
        chosen = exported_policy(comparison, engine, policy)
        spec = parse_policy(policy_text(chosen.name, chosen.params))
        fovy_deg = comparison.conditions.fovy_deg if fovy_deg is None else fovy_deg
        if scene is None and comparison.scene in list_bundled_scenes():
            scene = comparison.scene
    elif policy is None:
        raise InputError("export: expected a folder or a --policy for the engine, got neither")
    else:
        spec = parse_policy(policy)
    require_counterpart(engine, spec.name)
    world = None if scene is None else open_named_scene(scene).scene
    settings = engine_settings(engine, spec, world, 60.0 if fovy_deg is None else fovy_deg)
    if out is not None:
        write_whole(out, encode_record(settings))
    if as_json:
        print_record(settings)
    else:
        print(settings_text(settings))


def _read_run(run: Path, policy: str | None) -> tuple[Path, "FrameLog"]:
    """Return the frame log that is meant, and its file."""
    from ..sim.frame_log_file import read_frame_log

    if not run.is_dir():
        log = read_frame_log(run)
        if policy not in {None, log.header.policy, run.stem}:
            raise InputError(
                f"expected a run of policy {policy}, got one of {log.header.policy}; "
                "leave --policy out",
                path=run,
            )
        return run, log
    logs = {path: read_frame_log(path) for path in sorted((run / "frames").glob("*.parquet"))}
    if not logs:
        raise InputError(
            "expected a folder with frames/POLICY.parquet, got none; give a folder that "
            "`lodbench compare --out` wrote",
            path=run,
        )
    meant = [
        (path, log) for path, log in logs.items() if policy in {None, log.header.policy, path.stem}
    ]
    if len(meant) != 1:
        known = ", ".join(log.header.policy for log in logs.values())
        raise InputError(
            f"expected one policy of {known}, got {policy or 'none'}; choose with --policy",
            path=run,
        )
    return meant[0]
