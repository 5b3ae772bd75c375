"""The command line that makes a result again: only what differs from the defaults."""

import inspect
import shlex
from collections.abc import Callable, Mapping, Sequence
from typing import Any, cast


def command_of(
    command: Callable[..., Any], given: Mapping[str, Any], leave_out: Sequence[str]
) -> str:
    """Return the command line of what a command was given, in the order of its options.

    Parameters
    ----------
    command
        The function of the command, whose defaults are the options'.
    given
        Values by parameter.
    leave_out
        Parameters that do not change the result, such as the number of workers.
    """
    words = ["lodbench", command.__name__]
    for name, parameter in inspect.signature(command).parameters.items():
        value = given[name]
        if name in leave_out or value == parameter.default:
            continue
        option = f"--{name.replace('_', '-')}"
        if isinstance(value, bool):
            words.append(option)
            continue
        items = cast("list[object]", value) if isinstance(value, list) else [value]
        for item in items:
            words += [option, str(item)]
    return shlex.join(words)
