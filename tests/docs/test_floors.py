"""The picture of the house: rooms by floor."""

from pathlib import Path

import pytest
from floors import draw_house, floors, room_imports

ROOT = Path(__file__).parents[2]


def test_the_picture_shows_the_imports_that_the_files_make() -> None:
    """`docs/images/floors.svg` is what ``make docs`` draws of the files as they are."""
    picture = ROOT / "docs" / "images" / "floors.svg"
    assert picture.read_text(encoding="utf-8") == draw_house(ROOT)


def test_imports_between_rooms_are_counted_and_those_within_are_not(tmp_path: Path) -> None:
    """A deep file's import of another room counts, in each way of writing it."""
    for room in ("lodbench", "low", "high", "high/inner"):
        (tmp_path / room).mkdir()
        (tmp_path / room / "__init__.py").touch()
    deep = "import numpy\nfrom ...low.part import name\nfrom ..sibling import other\n"
    (tmp_path / "high" / "inner" / "deep.py").write_text(deep)
    assert room_imports(tmp_path) == {"low": frozenset(), "high": {"low"}}
    (tmp_path / "low" / "part.py").write_text("from .. import high\n")
    assert room_imports(tmp_path)["low"] == {"high"}


def test_a_room_stands_above_all_that_it_imports() -> None:
    """Two rooms that import the ground alone share a floor; who imports one of them is above."""
    imports = {"a": frozenset[str](), "b": frozenset("a"), "c": frozenset("a")}
    assert floors(imports | {"d": frozenset("ac")}) == [["a"], ["b", "c"], ["d"]]
    with pytest.raises(ValueError, match="each other"):
        floors({"a": frozenset("b"), "b": frozenset("a")})
