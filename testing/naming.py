"""What a command line calls a policy class."""

import sys
from pathlib import Path
from typing import Any


def name_policy(policy: str | type[Any]) -> str:
    """Return the text that `parse_policy` makes the policy of.

    A class of a package is ``package.module:Class``, one of a single file ``file.py:Class`` with
    the path from the current folder, which is what one types there.
    """
    if isinstance(policy, str):
        return policy
    module: Any = sys.modules.get(policy.__module__)
    file = getattr(module, "__file__", None)
    if file is None or module.__package__:
        return f"{policy.__module__}:{policy.__qualname__}"
    path, here = Path(file).resolve(), Path.cwd()
    shown = path.relative_to(here) if path.is_relative_to(here) else path
    return f"{shown}:{policy.__qualname__}"
