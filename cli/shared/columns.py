"""The option that names columns of logs, which several commands share."""

from typing import Annotated

from typer import Option

from ...base.errors import InputError

Mapping = Annotated[
    str,
    Option(
        "--map",
        help="Columns by name: gpu_ms=GPUTime,triangles=Prims; with a unit: gpu_ms=span:us.",
    ),
]


def parse_columns(text: str) -> dict[str, str]:
    """Return the columns that ``name=COLUMN,name=COLUMN`` maps.

    Raises `InputError` if it is of another form, or maps a name twice.
    """
    pairs = [item.partition("=") for item in filter(None, text.split(","))]
    names = [name.strip() for name, _, _ in pairs]
    for name, equals, column in pairs:
        if not (name.strip() and equals and column.strip()):
            raise InputError(f"--map: expected name=COLUMN,name=COLUMN, got {text}")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"--map: expected each name once, got {twice} twice; remove one")
    return {name.strip(): column.strip() for name, _, column in pairs}
