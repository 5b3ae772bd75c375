"""Generated scenes on disk: made once, read again, healed when damaged."""

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from lodbench.models.meshes.geometry import Geometry
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_file import write_scene
from lodbench.models.scenes.scene_cache import cache_folder, cached_scene

Build = Callable[[], tuple[Scene, Geometry]]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the cache's folder, which is not there yet."""
    monkeypatch.setenv("LODBENCH_CACHE", str(tmp_path / "a" / "b"))
    return tmp_path / "a" / "b"


@pytest.fixture
def counted(ball_scene: tuple[Scene, Geometry]) -> tuple[list[int], Build]:
    """Return a maker of the scene of balls, and the list in which it notes each use."""
    used: list[int] = []

    def build() -> tuple[Scene, Geometry]:
        used.append(1)
        return ball_scene

    return used, build


def the_file(folder: Path) -> Path:
    """Return the one file that the folder holds."""
    (path,) = folder.iterdir()
    return path


def test_a_scene_is_made_once(counted: tuple[list[int], Build], folder: Path) -> None:
    """The second time it is read, from a file that nobody may write to."""
    used, build = counted
    made, geometry = cached_scene("balls", build)
    again, read = cached_scene("balls", build)
    assert len(used) == 1
    assert (again.position_m == made.position_m).all()
    for mesh, other in zip(geometry(), read(), strict=True):
        assert (mesh.vertices == other.vertices).all()
        assert (mesh.faces == other.faces).all()
    assert len(used) == 1
    assert the_file(folder).stat().st_mode & 0o777 == 0o444


def test_older_files_of_the_name_are_removed(
    counted: tuple[list[int], Build], folder: Path
) -> None:
    """Those of other digests go; those of another scene whose name begins alike stay."""
    folder.mkdir(parents=True)
    for name in ("balls", "balls-more"):
        (folder / f"{name}.0123456789abcdef.lodscene").write_bytes(b"")
    cached_scene("balls", counted[1])
    left = sorted(path.name.split(".")[0] for path in folder.iterdir())
    assert left == ["balls", "balls-more"]
    assert not (folder / "balls.0123456789abcdef.lodscene").exists()


def flipped(data: bytes, at: int) -> bytes:
    """Return the bytes with one of them turned over."""
    return data[:at] + bytes([data[at] ^ 0xFF]) + data[at + 1 :]


def damaged(data: bytes, damage: str) -> bytes:
    """Return what a disk, a full one, or somebody else may make of a file."""
    match damage:
        case "cut":
            return data[: len(data) // 2]
        case "header":
            return flipped(data, 200)
        case "middle":
            return flipped(data, len(data) // 2)
        case "geometry":
            return flipped(data, data.rindex(b"geometry") - 2000)
        case _:
            return damage.encode()


@pytest.mark.parametrize("damage", ["", "something else", "cut", "header", "middle", "geometry"])
def test_a_damaged_file_is_made_anew(
    counted: tuple[list[int], Build], folder: Path, damage: str
) -> None:
    """Scene and geometry come whole whatever became of the file, and so do the next reader's."""
    used, build = counted
    cached_scene("balls", build)
    path = the_file(folder)
    whole = path.read_bytes()
    path.chmod(0o644)
    path.write_bytes(damaged(whole, damage))
    scene, geometry = cached_scene("balls", build)
    assert len(scene) == len(build()[0])
    assert len(geometry()) == len(build()[1])
    assert path.read_bytes() == whole
    used.clear()
    assert len(cached_scene("balls", build)[1]()) == len(scene.types.levels.error_m)
    assert used == []


def test_a_scene_of_another_name_is_not_taken(
    counted: tuple[list[int], Build], folder: Path
) -> None:
    """A whole file that holds another scene than it is named after is made anew."""
    used, build = counted
    cached_scene("balls", build)
    path = the_file(folder)
    write_scene(path, replace(build()[0], name="others"), build()[1])
    used.clear()
    assert cached_scene("balls", build)[0].name == "balls"
    assert used == [1]


def test_geometry_outlives_its_file(counted: tuple[list[int], Build], folder: Path) -> None:
    """Another version may remove the file between the scene and its geometry."""
    _, build = counted
    cached_scene("balls", build)
    geometry = cached_scene("balls", build)[1]
    the_file(folder).unlink()
    assert len(geometry()) == len(build()[1])


def test_without_a_folder_scenes_are_made_in_memory(
    counted: tuple[list[int], Build],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A file where the folder should be: the scene is there, and one line says what to do."""
    (tmp_path / "file").write_bytes(b"")
    monkeypatch.setenv("LODBENCH_CACHE", str(tmp_path / "file"))
    for _ in range(2):
        scene, geometry = cached_scene("balls", counted[1])
        assert len(geometry()) == len(scene.types.levels.error_m)
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert str(tmp_path / "file") in said
    assert "LODBENCH_CACHE" in said


def test_without_a_home_scenes_are_made_in_memory(
    counted: tuple[list[int], Build],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """An account that has no home, and no variable that says otherwise, still gets its scene."""
    for name in ("LODBENCH_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)

    def no_home() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", no_home)
    monkeypatch.chdir(tmp_path)
    scene, geometry = cached_scene("balls", counted[1])
    assert len(geometry()) == len(scene.types.levels.error_m)
    assert "there is no home folder for them; name a folder in LODBENCH_CACHE" in (
        capsys.readouterr().err
    )
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("in_the_way", ["folder", "pipe", "loop", "dangling", "unreadable"])
def test_what_stands_in_the_place_of_a_file(
    counted: tuple[list[int], Build], folder: Path, in_the_way: str
) -> None:
    """A folder of the file's name is passed by; anything else gives way to the scene."""
    used, build = counted
    cached_scene("balls", build)
    path = the_file(folder)
    path.unlink()
    if in_the_way == "folder":
        path.mkdir()
    elif in_the_way == "pipe":
        os.mkfifo(path)
    elif in_the_way == "unreadable":
        path.write_bytes(b"")
        path.chmod(0)
    else:
        path.symlink_to(path if in_the_way == "loop" else folder / "absent")
    scene, geometry = cached_scene("balls", build)
    assert len(geometry()) == len(scene.types.levels.error_m)
    used.clear()
    cached_scene("balls", build)
    assert used == ([1] if in_the_way == "folder" else [])
    assert [item.name for item in folder.iterdir()] == [path.name]


@pytest.mark.slow
def test_two_processes_make_one_file(tmp_path: Path) -> None:
    """Both return the scene, and leave one whole file and nothing beside it."""
    code = (
        "from lodbench.models.scene.scene_catalog import open_scene\n"
        "opened = open_scene('crowd-32'); print(len(opened.scene), len(opened.read_geometry()))"
    )
    environment = os.environ | {"LODBENCH_CACHE": str(tmp_path)}
    both = [
        subprocess.Popen([sys.executable, "-c", code], env=environment, stdout=subprocess.PIPE)
        for _ in range(2)
    ]
    printed = {process.communicate()[0] for process in both}
    assert len(printed) == 1
    assert printed.pop().startswith(b"32 ")
    assert the_file(tmp_path).suffix == ".lodscene"


@pytest.mark.parametrize(
    ("platform", "variables", "end"),
    [
        ("linux", {"XDG_CACHE_HOME": "/x"}, "/x/lodbench"),
        ("linux", {}, "/users/me/.cache/lodbench"),
        ("darwin", {}, "/users/me/Library/Caches/lodbench"),
        ("win32", {"LOCALAPPDATA": "/local"}, "/local/lodbench/Cache"),
        ("win32", {}, "/users/me/AppData/Local/lodbench/Cache"),
        ("linux", {"LODBENCH_CACHE": "/mine"}, "/mine"),
    ],
)
def test_the_folder_by_platform(
    platform: str, variables: dict[str, str], end: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where each platform keeps caches, unless the variable says otherwise."""
    for name in ("LODBENCH_CACHE", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr("sys.platform", platform)
    monkeypatch.setattr(Path, "home", lambda: Path("/users/me"))
    assert cache_folder() == Path(end)
