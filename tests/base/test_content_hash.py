"""Hashes of content: equal for equal values, and different for any difference that counts."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from lodbench.base.content_hash import content_hash


@dataclass
class Record:
    """A value with a cache."""

    name: str
    numbers: np.ndarray
    cache: dict[int, int] = field(default_factory=dict[int, int], compare=False)


def test_equal_content_has_one_hash() -> None:
    """Neither the layout of an array, nor its byte order, nor a cache is content."""
    numbers = np.arange(6.0).reshape(2, 3)
    one = Record("a", numbers, {1: 2})
    other = Record("a", np.asfortranarray(numbers.astype(">f8")))
    assert content_hash(one) == content_hash(other)
    assert content_hash({"b": 1, "a": (2,)}) == content_hash({"a": [2], "b": 1})


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (1, 1.0),
        (1, True),
        (0.0, -0.0),
        ("1", 1),
        (("ab", "c"), ("a", "bc")),
        ((1, (2, 3)), (1, 2, 3)),
        (np.zeros(2), np.zeros((2, 1))),
        (np.zeros(2), np.zeros(2, dtype=np.float32)),
        (np.array([1, 2]), np.array([2, 1])),
        (None, ()),
        (Record("a", np.zeros(1)), Record("b", np.zeros(1))),
    ],
)
def test_different_content_has_different_hashes(one: object, other: object) -> None:
    """Kind, shape, grouping, order and the sign of zero count."""
    assert content_hash(one) != content_hash(other)


def test_what_has_no_content_is_refused() -> None:
    """A function or an array of objects could change behind its hash."""
    for value in (len, np.array([len], dtype=object), {"a": object()}):
        with pytest.raises(TypeError, match="no content"):
            content_hash(value)
