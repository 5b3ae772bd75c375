"""The command line that a result tells of: what differs from the defaults, ready for a shell."""

import shlex

from lodbench.cli.shared.command_line import command_of


def made(
    items: list[str] | None = None,
    *,
    budget_ms: float | None = None,
    trace: list[str] | None = None,
    as_shipped: bool = False,
    seed: int = 0,
    workers: int = 0,
) -> dict[str, object]:
    """Return what it was given, as a command sees its own parameters."""
    return dict(locals())


def test_defaults_are_left_out() -> None:
    """A command without options is its name alone."""
    assert command_of(made, made(), []) == "lodbench made"


def test_options_are_in_the_order_of_the_command() -> None:
    """Names have hyphens, a switch has no value, a list is one option an item."""
    given = made(seed=7, as_shipped=True, trace=["walk", "tour"], budget_ms=8.0)
    told = command_of(made, given, [])
    assert told == "lodbench made --budget-ms 8.0 --trace walk --trace tour --as-shipped --seed 7"


def test_what_does_not_matter_is_left_out() -> None:
    """The number of workers changes no result."""
    assert command_of(made, made(workers=4, seed=1), ["workers"]) == "lodbench made --seed 1"


def test_words_are_quoted_for_a_shell() -> None:
    """A glob, a blank and a quote come through a shell as they were given."""
    paths = ["my walk/*.csv", "it's.csv#first", ""]
    told = shlex.split(command_of(made, made(trace=paths), []))
    assert told[2::2] == ["--trace"] * 3
    assert told[3::2] == paths


def test_names_that_are_no_parameters_are_not_told() -> None:
    """What else is in the mapping, as among a function's locals, is no option."""
    assert command_of(made, made() | {"other": 5}, []) == "lodbench made"
