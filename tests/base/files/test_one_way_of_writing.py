"""Outputs are put in place by `base` alone, so that none forgets devices, Ctrl-C or a full disk."""

import ast
from collections.abc import Iterator
from pathlib import Path

import lodbench.base

ROOT = Path(lodbench.base.__path__[0]).resolve().parent
ROOMS = ("models", "traces", "policies", "sim", "render", "analysis", "testing", "cli", "lodbench")
TEMPORARY = {"mkstemp", "mkdtemp", "NamedTemporaryFile", "TemporaryDirectory", "rename", "renames"}


def replacements(tree: ast.AST) -> Iterator[int]:
    """Yield the lines that move a file or make a temporary one beside an output."""
    for node in ast.walk(tree):
        if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)):
            continue
        name, owner = node.func.attr, node.func.value
        of_os = isinstance(owner, ast.Name) and owner.id in {"os", "shutil"}
        # str.replace takes two values; what takes one is Path.replace.
        moves = name == "replace" and (of_os or (len(node.args) == 1 and not node.keywords))
        if moves or name in TEMPORARY or (of_os and name == "move"):
            yield node.lineno


def test_no_other_room_puts_files_in_place() -> None:
    """No module outside `base` renames a file or makes a temporary one."""
    files = [path for room in ROOMS for path in (ROOT / room).rglob("*.py")]
    assert len(files) > 200
    offenders = [
        f"{path.relative_to(ROOT)}:{line}"
        for path in files
        for line in replacements(ast.parse(path.read_text(encoding="utf-8")))
    ]
    assert not offenders


def test_what_puts_files_in_place_is_seen() -> None:
    """The search sees each way, and leaves text and dataclasses alone."""
    for way in ("os.replace(a, b)", "path.replace(b)", "a.rename(b)", "tempfile.mkstemp()"):
        assert list(replacements(ast.parse(way)))
    for other in ("text.replace('a', 'b')", "replace(record, a=1)", "dataclasses.replace(r, a=1)"):
        assert not list(replacements(ast.parse(other)))
