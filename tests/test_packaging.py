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


@pytest.fixture(scope="module")
def package_files(tracked_files: list[str]) -> set[str]:
    """Tracked files that belong to the package, under the name that they have in a wheel."""
    folders = {name: name.split("/")[0] for name in tracked_files}
    rooms = {f"lodbench/{name}" for name, folder in folders.items() if folder in ROOMS}
    return rooms | {name for name, folder in folders.items() if folder == "lodbench"}


@pytest.fixture(scope="module")
def dist(tmp_path_factory: pytest.TempPathFactory, tracked_files: list[str]) -> Path:
    """Build the sdist from a clean copy of the checkout, and the wheel from the sdist."""
    clone = tmp_path_factory.mktemp("clone with a space")
    for name in tracked_files:
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


def test_wheel_holds_the_package_and_nothing_else(
    wheel: zipfile.ZipFile, package_files: set[str]
) -> None:
    """Every tracked file of the package is in the wheel, and no test, document or stray folder."""
    shipped = {name for name in wheel.namelist() if ".dist-info/" not in name}
    assert shipped == package_files


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


def test_sdist_holds_the_package(
    dist: Path, tracked_files: list[str], package_files: set[str]
) -> None:
    """The sdist holds every file of the package; the wheel above was built from it alone."""
    base = f"lodbench-{lodbench.__version__}"
    with tarfile.open(dist / f"{base}.tar.gz") as archive:
        names = {name.removeprefix(f"{base}/") for name in archive.getnames()}
    sources = package_files | {name.removeprefix("lodbench/") for name in package_files}
    assert sources & set(tracked_files) <= names
