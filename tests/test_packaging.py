"""What is shipped: the wheel and the sdist hold the package, its data, and nothing else."""

import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

import lodbench

ROOT = Path(__file__).parents[1]
ROOMS = ("base", "models", "traces", "policies", "sim", "render", "analysis", "testing", "cli")


def tracked_files() -> list[str]:
    """Files of the work tree that git tracks or would track, which is what a clone holds."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    names = filter(None, listed.stdout.split("\0"))
    return sorted(name for name in names if (ROOT / name).is_file())


def package_files() -> set[str]:
    """Tracked files that belong to the package, under the name they have in a wheel."""
    names = tracked_files()
    rooms = tuple(f"{room}/" for room in ROOMS)
    door = {name for name in names if name.startswith("lodbench/")}
    return door | {f"lodbench/{name}" for name in names if name.startswith(rooms)}


@pytest.fixture(scope="module")
def dist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the sdist from a clean copy of the checkout, and the wheel from the sdist."""
    clone = tmp_path_factory.mktemp("clone with a space")
    for name in tracked_files():
        target = clone / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, target)
    build = [sys.executable, "-m", "build", "--no-isolation", "--outdir", "dist"]
    run = subprocess.run(build, cwd=clone, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    assert "Warning" not in run.stdout + run.stderr
    return clone / "dist"


@pytest.fixture(scope="module")
def wheel(dist: Path) -> zipfile.ZipFile:
    """Open the wheel."""
    return zipfile.ZipFile(dist / f"lodbench-{lodbench.__version__}-py3-none-any.whl")


def test_wheel_holds_the_package_and_nothing_else(wheel: zipfile.ZipFile) -> None:
    """Every tracked file of the package is in the wheel, and no test, document or stray folder."""
    shipped = {name for name in wheel.namelist() if ".dist-info/" not in name}
    assert shipped == package_files()


def test_wheel_describes_itself(wheel: zipfile.ZipFile) -> None:
    """The wheel carries the command, the licence and a description."""
    info = f"lodbench-{lodbench.__version__}.dist-info"
    metadata = wheel.read(f"{info}/METADATA").decode()
    assert f"Version: {lodbench.__version__}\n" in metadata
    assert "License-Expression: MIT\n" in metadata
    assert "lodbench = lodbench.cli.main:main" in wheel.read(f"{info}/entry_points.txt").decode()
    assert wheel.read(f"{info}/licenses/LICENSE") == (ROOT / "LICENSE").read_bytes()
    for unwanted in ("pandas", "simpy"):
        assert f"Requires-Dist: {unwanted}" not in metadata


def test_sdist_holds_the_package(dist: Path) -> None:
    """The sdist holds every file of the package; the wheel above was built from it alone."""
    base = f"lodbench-{lodbench.__version__}"
    with tarfile.open(dist / f"{base}.tar.gz") as archive:
        names = {name.removeprefix(f"{base}/") for name in archive.getnames()}
    door = {name for name in tracked_files() if name.startswith("lodbench/")}
    assert door | {name.removeprefix("lodbench/") for name in package_files() - door} <= names
