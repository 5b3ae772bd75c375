"""Put the page of the papers' experiments and its pictures into the documentation.

Takes the folder that `lodbench reproduce all --out` wrote.
"""

import shutil
import sys
from pathlib import Path

DOCS = Path(__file__).parents[1]


def main() -> None:
    """Copy the page and its pictures; pictures of experiments that are gone go."""
    made = Path(sys.argv[1])
    shutil.copy(made / "reproduction.md", DOCS / "reproduction.md")
    shutil.rmtree(DOCS / "reproduction", ignore_errors=True)
    shutil.copytree(made / "reproduction", DOCS / "reproduction")


if __name__ == "__main__":
    main()
