"""A whole file that is to be damaged, and how it is read."""

import importlib.util
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
LINES = 40
"""Rows of a text that is damaged: damage in the 9,000th is that in the 9th."""


@dataclass(frozen=True, slots=True)
class Seed:
    """A file, or a folder of files.

    Attributes
    ----------
    family, name : str
        What its results are gathered under, and its own.
    files : dict of str to bytes
        By name; the first is the one that is read.
    kinds : dict of str to str
        How each that is damaged is known (`damage.KINDS`).
    command : tuple of str
        The command line, ``@`` for the file; or the name of a reader (`record_seeds.READERS`).
    """

    family: str
    name: str
    files: dict[str, bytes]
    kinds: dict[str, str]
    command: tuple[str, ...]


def one_file(
    family: str, name: str, content: bytes | str, kind: str, *command: str, file: str = ""
) -> Seed:
    """Return the seed of a single file, called as short as its format allows."""
    data = content.encode() if isinstance(content, str) else content
    file = file or f"f{Path(name).suffix}"
    return Seed(family, name, {file: data}, {file: kind}, command)


def test_module(name: str) -> Any:
    """Return a file of tests as a module: its makers know the formats."""
    path = ROOT / "tests" / name
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def wild_files(folder: str) -> list[Path]:
    """Return real files of a kind, none where they are not at hand."""
    named = os.environ.get("LODBENCH_DATA")
    found = (Path(named) if named else ROOT.parent / "shared" / "data") / "wild" / folder
    return sorted(path for path in found.iterdir() if path.is_file()) if found.is_dir() else []


def beginning(path: Path) -> str:
    """Return the first lines of a text, all of JSON."""
    text = path.read_text(encoding="utf-8", errors="replace")
    return text if path.suffix == ".json" else "\n".join(text.split("\n")[:LINES]) + "\n"


def kind_of(path: Path) -> str:
    """Return how a file is damaged, by its suffix."""
    kinds = {".json": "json", ".gltf": "json", ".glb": "glb", ".parquet": "parquet"}
    return kinds.get(path.suffix.lower(), "text")
