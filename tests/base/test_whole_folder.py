"""Folders appear whole, or what was there before stays."""

from pathlib import Path

import pytest

from lodbench.base.whole_folder import whole_folder


def test_a_folder_takes_the_place_of_the_one_before(tmp_path: Path) -> None:
    """Only what was written now is there, and nothing is left beside it."""
    folder = tmp_path / "run"
    for name in ("first", "second"):
        with whole_folder(folder) as partial:
            (partial / name).write_text(name, encoding="utf-8")
    assert [path.name for path in folder.iterdir()] == ["second"]
    assert list(tmp_path.iterdir()) == [folder]


def test_a_failure_leaves_what_was_there(tmp_path: Path) -> None:
    """Work that fails, or a folder that cannot be put in place, loses nothing."""
    folder = tmp_path / "run"
    with whole_folder(folder) as partial:
        (partial / "first").write_text("first", encoding="utf-8")
    with pytest.raises(FileNotFoundError), whole_folder(folder) as partial:
        (partial / "no" / "second").write_text("second", encoding="utf-8")
    with pytest.raises(FileNotFoundError), whole_folder(folder) as partial:
        partial.rename(tmp_path / "elsewhere")
    assert [path.name for path in folder.iterdir()] == ["first"]
