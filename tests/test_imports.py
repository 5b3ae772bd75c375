"""Structure of the package: who imports whom, what an import costs, and how long files get.

Docstrings and sorted ``__all__`` are ruff's to check (D1, RUF022).
"""

import ast
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ROOMS = ("base", "models", "traces", "policies", "sim", "render", "analysis", "testing", "cli")
BELOW = {
    room: set(ROOMS[:i]) - ({"models"} if room == "traces" else set[str]())
    for i, room in enumerate(ROOMS)
} | {"policies": {"base", "models"}}
PACKAGE = sorted(path for room in ("lodbench", *ROOMS) for path in (ROOT / room).rglob("*.py"))
TESTS = sorted((ROOT / "tests").rglob("*.py"))
HEAVY = ("numpy", "scipy", "trimesh", "casadi", "emcee", "plotly", "pyarrow", "networkx")


def name_of(path: Path) -> str:
    """``models/cost.py`` for the identifiers of parametrised tests."""
    return path.relative_to(ROOT).as_posix()


def module_of(path: Path) -> str:
    """``lodbench.models.machine.cost``, as users import it."""
    inside = path.relative_to(ROOT / "lodbench" if path.parent.name == "lodbench" else ROOT)
    parts = ("lodbench", *inside.with_suffix("").parts)
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


def subpackage_imports(path: Path) -> Iterator[tuple[str, int]]:
    """Names directly below ``lodbench`` that a file of the package imports relatively."""
    package = path.relative_to(ROOT).parent.parts
    for level, name, line in imports_of(path):
        if level:
            absolute = (*package[: len(package) - level + 1], *name.split("."))
            yield absolute[0], line


def run_python(script: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a script in an interpreter of its own, where nothing is imported yet."""
    command = [sys.executable, "-c", script, *arguments]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return run


@pytest.mark.parametrize("path", PACKAGE, ids=name_of)
def test_imports_run_one_way(path: Path) -> None:
    """Models and traces know nobody; policies see models; sim, analysis and cli what is below."""
    folder = path.relative_to(ROOT).parts[0]
    allowed = BELOW.get(folder, {"cli"} if folder == "__main__.py" else set[str]())
    against = [
        f"line {line}: {name}"
        for name, line in subpackage_imports(path)
        if name in BELOW and name != folder and name not in allowed
    ]
    assert against == []


@pytest.mark.parametrize("path", PACKAGE, ids=name_of)
def test_imports_inside_the_package_are_relative(path: Path) -> None:
    """The package never imports itself by name, so that every tool resolves it by path."""
    own = {"lodbench", *BELOW}
    named = [
        f"line {line}: {name}"
        for level, name, line in imports_of(path)
        if level == 0 and name.split(".")[0] in own and path.parent.name != "lodbench"
    ]
    assert named == []


@pytest.mark.parametrize("path", TESTS, ids=name_of)
def test_tests_import_as_users_do(path: Path) -> None:
    """Tests name ``lodbench.models``, never a bare ``models`` or a relative path."""
    bare = [
        f"line {line}: {name}"
        for level, name, line in imports_of(path)
        if level or name.split(".")[0] in BELOW
    ]
    assert bare == []


def test_nobody_imports_pandas_or_simpy() -> None:
    """The one place that may import simpy is the benchmark that is held against it."""
    benchmarks = ROOT / "tests" / "benchmarks"
    guilty = [
        f"{name_of(path)}:{line}"
        for path in (*PACKAGE, *TESTS)
        if benchmarks not in path.parents
        for _, name, line in imports_of(path)
        if name.split(".")[0] in {"pandas", "simpy"}
    ]
    assert guilty == []


def test_only_testing_imports_test_tools() -> None:
    """Neither pytest nor hypothesis is needed, but by who tests; the contract checks ask late."""
    late = ROOT / "policies" / "checks" / "run.py"
    guilty = [
        f"{name_of(path)}:{line}"
        for path in PACKAGE
        if path.parts[len(ROOT.parts)] != "testing" and path != late
        for _, name, line in imports_of(path)
        if name.split(".")[0] in {"pytest", "hypothesis"}
    ]
    assert guilty == []


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


@pytest.mark.parametrize("library", ["trimesh", "casadi", "emcee", "plotly", "pyarrow", "scipy"])
def test_heavy_libraries_stay_out_of_package_imports(library: str) -> None:
    """Importing a subpackage, which a command does on its way, loads no heavy library."""
    packages = ["lodbench", *(f"lodbench.{folder}" for folder in BELOW)]
    script = f"import sys, {', '.join(packages)}; print({library!r} in sys.modules)"
    assert run_python(script).stdout.strip() == "False"


def test_every_folder_with_code_is_packaged() -> None:
    """``packages`` in pyproject.toml lists each folder of the package that holds Python files."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    listed = project["tool"]["setuptools"]["packages"]
    folders = {module_of(path.with_name("__init__.py")) for path in PACKAGE}
    assert sorted(listed) == sorted(folders)


@pytest.mark.parametrize("path", [*PACKAGE, *TESTS], ids=name_of)
def test_files_stay_short(path: Path) -> None:
    """No file is longer than 400 lines."""
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 400


def test_no_file_names_a_place_on_a_machine() -> None:
    """No committed text holds an absolute path of somebody's home or checkout."""
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    place = re.compile(rb"(?<![\w.~$}])/(?:home|root|Users|work|farm|mnt)/\w")
    guilty = [
        f"{name}: {found.group().decode()}"
        for name in filter(None, listed.stdout.split("\0"))
        if (ROOT / name).is_file()
        for found in [place.search((ROOT / name).read_bytes())]
        if found
    ]
    assert guilty == []
