"""Structure of the package: who imports whom, what an import costs, and how long files get.

Docstrings and sorted ``__all__`` are ruff's to check (D1, RUF022).
"""

import ast
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROOMS = ("base", "models", "traces", "policies", "sim", "render", "analysis", "testing", "cli")
PACKAGE = sorted(path for room in ("lodbench", *ROOMS) for path in (ROOT / room).rglob("*.py"))
TESTS = sorted((ROOT / "tests").rglob("*.py"))
HEAVY = ("numpy", "scipy", "trimesh", "casadi", "emcee", "plotly", "pyarrow", "networkx", "duckdb")


def name_of(path: Path) -> str:
    """``models/machine/cost.py`` for the identifiers of parametrised tests."""
    return path.relative_to(ROOT).as_posix()


def installed(path: Path) -> Path:
    """``lodbench/models/machine/cost.py``: where a file of the package is once installed."""
    inside = path.relative_to(ROOT)
    return inside if inside.parts[0] == "lodbench" else "lodbench" / inside


def module_of(path: Path) -> str:
    """``lodbench.models.machine.cost``, as users import it."""
    parts = installed(path).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def syntax_of(path: Path) -> ast.Module:
    """Return the parsed file."""
    return ast.parse(path.read_text(encoding="utf-8"), str(path))


def imports_of(path: Path) -> Iterator[tuple[int, str, int]]:
    """Relative level, module named, and line of each import in a file, wherever it stands."""
    for node in ast.walk(syntax_of(path)):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield 0, alias.name, node.lineno
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            names = [base] if base else [alias.name for alias in node.names]
            for name in names:
                yield node.level, name, node.lineno


def run_python(script: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a script in an interpreter of its own, where nothing is imported yet."""
    command = [sys.executable, "-c", script, *arguments]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return run


def lint_imports(tree: Path) -> subprocess.CompletedProcess[str]:
    """Judge a tree that holds the package as it is installed by the contracts in pyproject.toml."""
    script = "from importlinter.cli import lint_imports_command as lint; lint()"
    command = [
        sys.executable,
        "-c",
        script,
        "--no-cache",
        "--no-logo",
        str(ROOT / "pyproject.toml"),
    ]
    path = {"PYTHONPATH": str(tree), "COLUMNS": "200"}
    return subprocess.run(command, cwd=tree, env=os.environ | path, capture_output=True, text=True)


def test_imports_run_one_way(tmp_path: Path) -> None:
    """The contracts in pyproject.toml hold: rooms import downwards, helpers know no policy."""
    (tmp_path / "lodbench").mkdir()
    for path in (*(ROOT / room for room in ROOMS), *(ROOT / "lodbench").glob("*.py")):
        (tmp_path / "lodbench" / path.name).symlink_to(path)
    run = lint_imports(tmp_path)
    assert run.returncode == 0, run.stdout


def test_wrong_imports_are_noticed(tmp_path: Path) -> None:
    """Imports upwards, of paths by a policy, of a policy by the simulator, of pytest are named."""
    for path in PACKAGE:
        copy = tmp_path / installed(path)
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes(path.read_bytes())
    wrong = {
        "base.errors": "lodbench.cli.main",
        "policies.view": "lodbench.traces.cameras.camera_trace",
        "sim.replay": "lodbench.policies.bounds.full",
        "analysis.gate.limits": "pytest",
    }
    for module, imported in wrong.items():
        with (tmp_path / "lodbench" / f"{module.replace('.', '/')}.py").open("a") as source:
            source.write(f"import {imported}\n")
    report = lint_imports(tmp_path).stdout
    assert "0 kept, 4 broken" in report
    for module, imported in wrong.items():
        assert f"lodbench.{module} -> {imported}" in report


def test_imports_inside_the_package_are_relative() -> None:
    """Rooms never import the package by name, so that every tool resolves it by path."""
    assert [
        f"{name_of(path)}:{line}: {name}"
        for path in PACKAGE
        if path.parts[len(ROOT.parts)] != "lodbench"
        for level, name, line in imports_of(path)
        if level == 0 and name.split(".")[0] in {"lodbench", *ROOMS}
    ] == []


def test_tests_import_as_users_do() -> None:
    """Tests name ``lodbench.models``, never a bare ``models`` or a relative path."""
    assert [
        f"{name_of(path)}:{line}: {name}"
        for path in TESTS
        for level, name, line in imports_of(path)
        if level or name.split(".")[0] in ROOMS
    ] == []


def test_files_stay_short() -> None:
    """No file of the package is longer than 350 lines, and none of the tests than 400."""
    lengths = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in PACKAGE + TESTS}
    assert [
        f"{name_of(path)}: {length} lines"
        for path, length in lengths.items()
        if length > (400 if path in TESTS else 350)
    ] == []


def test_no_import_of_the_package_asks_for_pandas_or_simpy() -> None:
    """Importing every module never even looks for them, directly or through a library."""
    script = """
import importlib, importlib.abc, sys

class Watch(importlib.abc.MetaPathFinder):
    asked = set()
    def find_spec(self, name, path, target=None):
        if name in {"pandas", "simpy"}:
            self.asked.add(name)

sys.meta_path.insert(0, Watch())
for module in sys.argv[1:]:
    importlib.import_module(module)
print(*sorted(Watch.asked))
"""
    modules = [module_of(path) for path in PACKAGE if path.name != "__main__.py"]
    assert run_python(script, *modules).stdout.split() == []


def test_help_loads_no_heavy_library() -> None:
    """``lodbench --help`` is quick because it imports neither numpy nor what is built on it."""
    script = f"""
import sys
from lodbench.cli.main import run
code = run(["--help"])
print(code, *(name for name in {HEAVY!r} if name in sys.modules), file=sys.stderr)
"""
    run = run_python(script)
    assert "Usage: lodbench" in run.stdout
    assert run.stderr.split() == ["0"]


def test_heavy_libraries_stay_out_of_package_imports() -> None:
    """Importing the rooms, which a command does on its way, loads no heavy library but numpy."""
    heavy = set(HEAVY) - {"numpy"}
    packages = ["lodbench", *(f"lodbench.{room}" for room in ROOMS)]
    script = f"import sys, {', '.join(packages)}; print(*{heavy!r} & set(sys.modules))"
    assert run_python(script).stdout.split() == []


def test_every_folder_with_code_is_packaged() -> None:
    """``packages`` in pyproject.toml lists each folder of the package that holds Python files."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    listed = project["tool"]["setuptools"]["packages"]
    folders = {module_of(path.with_name("__init__.py")) for path in PACKAGE}
    assert sorted(listed) == sorted(folders)


def test_no_file_names_a_place_on_a_machine(tracked_files: list[str]) -> None:
    """No committed text holds an absolute path of somebody's home or checkout."""
    place = re.compile(rb"(?<![\w.~$}])/(?:home|root|Users|work|farm|mnt)/\w")
    guilty = [
        f"{name}: {match.group().decode()}"
        for name in tracked_files
        for match in [place.search((ROOT / name).read_bytes())]
        if match
    ]
    assert guilty == []
