"""``python -m lodbench.render.unattended``: record what a fit wants, and leave it in a folder."""

import argparse
import signal
import sys
from dataclasses import fields
from pathlib import Path
from typing import Any, NoReturn

from .campaign import Campaign, run_campaign


def main() -> int:
    """Run the campaign that the command line names; return 1 if anything failed, else 0."""
    parser = argparse.ArgumentParser("python -m lodbench.render.unattended", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder of the results")
    for option in fields(Campaign):
        default: Any = option.default
        kinds: dict[Any, Any] = {float: float, int: int}
        parser.add_argument(
            f"--{option.name.replace('_', '-')}",
            type=kinds.get(option.type, str),
            nargs=None if option.type in {*kinds, str} else "+",
            default=default,
            help=f"default: {default}",
        )
    given = vars(parser.parse_args())
    out = given.pop("out")
    signal.signal(signal.SIGTERM, _end)
    results = run_campaign(Campaign(**given), out)
    print(f"{len(results.recordings)} recordings, {len(results.errors)} errors")
    return 1 if results.errors or not results.recordings else 0


def _end(number: int, _frame: object) -> NoReturn:
    """End as by an error, so that what was started is ended too, and scratch files are removed."""
    sys.exit(128 + number)


if __name__ == "__main__":
    sys.exit(main())
