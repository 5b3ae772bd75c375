"""Limits of time and memory, as users write them and as they add up."""

import pytest

from lodbench.analysis.study.engine.limits import Limits, available_bytes, parse_bytes
from lodbench.base.errors import InputError


@pytest.mark.parametrize(
    ("text", "size"),
    [("2GB", 2 * 10**9), ("1.5 gib", 3 * 2**29), ("300m", None), ("70000000", 70_000_000)],
)
def test_bytes_are_written_with_their_unit(text: str, size: int | None) -> None:
    """Decimal and binary units are what they are elsewhere, and others are refused."""
    if size is None:
        with pytest.raises(InputError, match="expected bytes such as 2GB"):
            parse_bytes(text)
    else:
        assert parse_bytes(text) == size


@pytest.mark.parametrize("text", ["", "GB", "nan", "inf GB", "two"])
def test_what_is_no_number_is_refused(text: str) -> None:
    """In one line."""
    with pytest.raises(InputError, match="expected bytes"):
        parse_bytes(text)


def test_limits_have_bounds() -> None:
    """A timeout that is none, and memory in which nothing runs or that no system can count."""
    for timeout_s in (0.0, -1.0, float("nan"), float("inf")):
        with pytest.raises(InputError, match="policy timeout: expected"):
            Limits(timeout_s=timeout_s)
    for memory_bytes in (1000, 2**60 + 1):
        with pytest.raises(InputError, match="policy memory in bytes: expected 67108864 to"):
            Limits(memory_bytes=memory_bytes)


def test_a_run_may_take_ten_minutes_and_a_second_a_frame() -> None:
    """A policy of 59 s a frame passes the limit of a frame, and is stopped in its eleventh."""
    limits = Limits()
    assert limits.run_s(0) == 600.0
    assert limits.run_s(36_000) == pytest.approx(36_600.0)
    frames = next(n for n in range(100) if 59.0 * n > limits.run_s(n))
    assert frames == 11


def test_workers_share_four_fifths_of_what_is_available() -> None:
    """All workers together never have more than there is; a size that is given is given to each."""
    one, four = Limits().worker_bytes(1), Limits().worker_bytes(4)
    assert one < 0.85 * available_bytes()
    assert one / four == pytest.approx(4.0, rel=0.2)
    assert Limits(memory_bytes=2**30).worker_bytes(4) == 2**30
