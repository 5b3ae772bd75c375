"""`lodbench export`: a simulated run for the viewers that users already have."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Option

from ..base.errors import InputError
from .shared.options import AsJson
from .shared.terminal import print_result

if TYPE_CHECKING:  # numpy and pyarrow are loaded by the command that needs them
    from ..sim.frame_log import FrameLog


def export(
    run: Annotated[
        Path,
        Argument(
            metavar="RUN", help="A folder that `compare --out` wrote, or one frames/POLICY.parquet."
        ),
    ],
    *,
    export_format: Annotated[
        str, Option("--format", help="presentmon, capframex or chrome-trace.")
    ],
    policy: Annotated[
        str | None, Option(help="Which policy of a folder, by its name or its file's.")
    ] = None,
    out: Annotated[
        Path | None,
        Option("--out", help="File to write; else POLICY and the format's ending, here."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Write a run as PresentMon CSV, CapFrameX JSON or Chrome trace events (for Perfetto)."""
    from ..sim.export.export import EXPORTS

    if export_format not in EXPORTS:
        raise InputError(
            f"--format: expected one of {', '.join(EXPORTS)}, got {export_format}; name one"
        )
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
