"""Generated scenes on disk: made once, found again, never stale."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from lodbench import InputError
from lodbench.models.meshes.geometry import Geometry
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_file import read_scene
from lodbench.models.scenes.scene_cache import cache_folder, cached_scene


@pytest.fixture
def counted(
    make_scene: Callable[..., Scene],
) -> tuple[list[int], Callable[[], tuple[Scene, Geometry]]]:
    """Return a maker of a scene, and the list in which it notes each use."""
    used: list[int] = []

    def build() -> tuple[Scene, Geometry]:
        used.append(1)
        return make_scene(np.zeros((2, 3))), ()

    return used, build


def test_a_scene_is_made_once(
    counted: tuple[list[int], Callable[[], tuple[Scene, Geometry]]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The second time it is read; files of other digests of the same name are removed."""
    monkeypatch.setenv("LODBENCH_CACHE", str(tmp_path / "a" / "b"))
    used, build = counted
    (tmp_path / "a" / "b").mkdir(parents=True)
    old = tmp_path / "a" / "b" / "two.0123456789abcdef.lodscene"
    other = tmp_path / "a" / "b" / "two-more.0123456789abcdef.lodscene"
    old.write_bytes(b"")
    other.write_bytes(b"")
    path = cached_scene("two", ".lodscene", build)
    assert cached_scene("two", ".lodscene", build) == path
    assert len(used) == 1
    assert len(read_scene(path)) == 2
    assert not old.exists()
    assert other.exists()


def test_a_cache_that_cannot_be_written_is_named(
    counted: tuple[list[int], Callable[[], tuple[Scene, Geometry]]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A file where the folder should be: the message says how to name another."""
    (tmp_path / "file").write_bytes(b"")
    monkeypatch.setenv("LODBENCH_CACHE", str(tmp_path / "file"))
    with pytest.raises(InputError, match="name another in LODBENCH_CACHE") as caught:
        cached_scene("two", ".lodscene", counted[1])
    assert str(tmp_path / "file") in str(caught.value)


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
