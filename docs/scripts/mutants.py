"""Try whether quick tests kill hand-made mutants of what prices, counts, replays and judges.

``make mutants`` runs it, and writes the table of ``docs/mutants.md`` once none survives.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import msgspec
from page_parts import table, write_blocks

ROOT = Path(__file__).parents[2]


class Mutant(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One wrong change to one file.

    Attributes
    ----------
    file : str
    original, mutant : str
        Text that stands once in the file, and what takes its place.
    killed_by : tuple of str
        Test files whose quick tests fail on it.
    claim : str
        What false claim it would let through.
    """

    file: str
    original: str
    mutant: str
    killed_by: tuple[str, ...]
    claim: str


def read_mutants() -> list[Mutant]:
    """Return the mutants of ``tests/mutation``, one TOML file a subject."""
    found: list[Mutant] = []
    for path in sorted((ROOT / "tests" / "mutation").glob("*.toml")):
        entries = tomllib.loads(path.read_text(encoding="utf-8"))
        found += msgspec.convert(entries["mutant"], list[Mutant])
    return found


def killed(mutant: Mutant) -> bool:
    """Return whether the quick tests that are named fail on a copy with this mutant."""
    with tempfile.TemporaryDirectory() as folder:
        copy = _copy_package(Path(folder))
        path = copy / mutant.file
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace(mutant.original, mutant.mutant), encoding="utf-8")
        return not passes(copy, mutant.killed_by)


def passes(copy: Path, tests: Iterable[str]) -> bool:
    """Return whether the quick tests of these files pass in a copy of the package.

    Raises `RuntimeError` if they cannot run, which tells nothing of a mutant.
    """
    # Hypothesis draws the same examples each time in CI, so that a mutant is not killed by luck.
    environment = {"PYTHONPATH": str(copy / ".types"), "PYTHONSAFEPATH": "1", "CI": "1"}
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-m", "not slow", *sorted(set(tests))]
    run = subprocess.run(  # noqa: S603 - our own interpreter
        command, cwd=copy, env=os.environ | environment, capture_output=True, text=True, check=False
    )
    if run.returncode not in (0, 1):
        raise RuntimeError(f"pytest ended with {run.returncode}:\n{run.stdout}{run.stderr}")
    return run.returncode == 0


def copy_passes(mutants: Iterable[Mutant]) -> bool:
    """Return whether all tests that kill something pass in a copy that nothing was done to."""
    with tempfile.TemporaryDirectory() as folder:
        return passes(_copy_package(Path(folder)), [t for m in mutants for t in m.killed_by])


def _copy_package(to: Path) -> Path:
    """Copy rooms and tests of this checkout, linked into one package as in ``.types``."""
    package = to / ".types" / "lodbench"
    package.mkdir(parents=True)
    for room in sorted(path.parent for path in ROOT.glob("*/__init__.py")):
        # Without what Python compiled before: a mutant of the same length could pass for it.
        shutil.copytree(room, to / room.name, ignore=shutil.ignore_patterns("__pycache__"))
        if room.name != "lodbench":
            (package / room.name).symlink_to(to / room.name)
    for face in (to / "lodbench").glob("*.py"):
        (package / face.name).symlink_to(face)
    shutil.copytree(ROOT / "tests", to / "tests")
    shutil.copy(ROOT / "pyproject.toml", to)
    return to


def summary(mutants: Iterable[Mutant]) -> str:
    """Return the page's table: by file how many mutants there are, and the tests that kill them."""
    by_file: dict[str, list[Mutant]] = {}
    for mutant in mutants:
        by_file.setdefault(mutant.file, []).append(mutant)
    rows = [
        (f"`{file}`", str(len(group)), ", ".join(f"`{name}`" for name in _tests(group)))
        for file, group in by_file.items()
    ]
    return table(("file", "mutants killed", "by quick tests of"), *rows)


def _tests(mutants: Iterable[Mutant]) -> list[str]:
    return sorted({name for mutant in mutants for name in mutant.killed_by})


def main() -> int:
    """Try all mutants and print a line for each; return 1 if one survives."""
    mutants = read_mutants()
    assert copy_passes(mutants), "tests fail before anything is changed"
    survivors = 0
    with ThreadPoolExecutor(os.cpu_count()) as threads:
        for mutant, dead in zip(mutants, threads.map(killed, mutants), strict=True):
            survivors += not dead
            print(f"{'killed  ' if dead else 'SURVIVES'}  {mutant.file}: {mutant.claim}")
    print(f"{len(mutants)} mutants, {survivors} survive")
    if not survivors:
        blocks = {"killed": summary(mutants)}
        write_blocks(ROOT / "docs" / "mutants.md", "docs/scripts/mutants.py", blocks)
    return int(survivors > 0)


if __name__ == "__main__":
    sys.exit(main())
