"""One sentence for every name that nobody knows."""

import pytest

from lodbench.base.nearest_names import unknown_name

NAMES = ("plaza", "city", "crowd")


@pytest.mark.parametrize(
    ("got", "sentence"),
    [
        ("palza", "expected one of plaza, city, crowd or a file, got palza; did you mean plaza?"),
        ("xyz", "expected one of plaza, city, crowd or a file, got xyz; give a path"),
        ("", "expected one of plaza, city, crowd or a file, got nothing; give a path"),
        ("a\nb", r"expected one of plaza, city, crowd or a file, got 'a\nb'; give a path"),
    ],
)
def test_the_sentence(got: str, sentence: str) -> None:
    """What is known, what was given, and the nearest or what to do, in one line."""
    assert unknown_name(got, NAMES, instead="a file", advice="give a path") == sentence


def test_where_nothing_is_known_nothing_is_suggested() -> None:
    """A policy without parameters takes none."""
    assert unknown_name("gain", ()) == "expected no such name, got gain; remove it"


def test_long_lists_are_cut_but_searched_whole() -> None:
    """Of a hundred columns forty are listed, and the nearest may be the last."""
    sentence = unknown_name("column99x", [f"column{i}" for i in range(100)])
    assert "column39, …, got column99x; did you mean column99?" in sentence
    assert "column40" not in sentence
