"""What several commands do with what they were given, and with what they print."""

import json
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from ...base.errors import InputError

if TYPE_CHECKING:  # numpy and rich are loaded by the command that needs them
    from rich.console import Console

    from ...models.scene.scene_catalog import OpenedScene
    from ...traces.cameras.camera_trace import CameraTrace


def open_named_scene(spec: str) -> "OpenedScene":
    """Open a scene, and meanwhile tell so on stderr, where that is a terminal."""
    from rich.console import Console

    from ...models.scene.scene_catalog import open_scene

    console = Console(stderr=True)
    if not console.is_terminal:
        return open_scene(spec)
    with console.status(f"opening {spec}; bundled scenes are made the first time"):
        return open_scene(spec)


def tell_field_of_view(paths: "Sequence[CameraTrace]", fovy_deg: float) -> None:
    """Say on stderr what field of view is taken, if a path states one."""
    from ...analysis.study.field_of_view import whose_field_of_view

    if whose := whose_field_of_view(paths, fovy_deg):
        print(f"note: field of view of {fovy_deg:.4g} degrees, {whose}", file=sys.stderr)


def failure_of(write: Callable[[], object]) -> InputError | OSError | None:
    """Write a result; return why that failed, to be raised when its scores have been printed."""
    try:
        write()
    except (InputError, OSError) as error:
        return error
    return None


def print_record(record: object) -> None:
    """Print a result, a dataclass with a schema, as one JSON document."""
    from ...base.files.strict_json import encode_record

    print(encode_record(record).decode(), end="")


def print_result(record: Mapping[str, object], text: str, *, as_json: bool) -> None:
    """Print what a command did: the record as JSON, or the text about it."""
    print(json.dumps(record) if as_json else text)


def table_console(piped_width: int) -> "Console":
    """Return a console for tables; a pipe, which has no width of its own, gets the one given."""
    from rich.console import Console

    return Console(width=None if sys.stdout.isatty() else piped_width, highlight=False, emoji=False)
