"""What is told on stderr while a command works."""

import io
import sys

import pytest

from lodbench.base.quantities import bytes_text, count_text, duration_text
from lodbench.cli.shared import progress as module
from lodbench.cli.shared.progress import progress_bar


class Clock:
    """A clock that a test sets."""

    now_s = 0.0

    def monotonic(self) -> float:
        """Return the time."""
        return self.now_s


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """Return the clock that progress goes by."""
    made = Clock()
    monkeypatch.setattr(module, "time", made)
    return made


def test_a_line_every_ten_seconds(clock: Clock, capsys: pytest.CaptureFixture[str]) -> None:
    """Four runs a second of 400: a line after 10 s and after 20 s, by hand 90 s and 80 s left."""
    with progress_bar("sweep") as progress:
        for step in range(1, 101):
            clock.now_s = 0.25 * step
            progress(step, 400)
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err == "40 of 400 runs, 4.0/s, 90 s left\n80 of 400 runs, 4.0/s, 80 s left\n"


def test_a_short_job_says_nothing(clock: Clock, capsys: pytest.CaptureFixture[str]) -> None:
    """What is done within ten seconds has no line, nor has the last step of any."""
    with progress_bar("sweep") as progress:
        for step, now_s in enumerate((0.1, 9.9, 30.0), 1):
            clock.now_s = now_s
            progress(step, 3)
    assert capsys.readouterr() == ("", "")


def test_earlier_results_are_no_speed(clock: Clock, capsys: pytest.CaptureFixture[str]) -> None:
    """A study that goes on at 3,000 of 4,000 runs is as fast as what it adds, one a second."""
    with progress_bar("sweep") as progress:
        progress(3000, 4000)
        clock.now_s = 10.0
        progress(3010, 4000)
    assert capsys.readouterr().err == "3,010 of 4,000 runs, 1.0/s, 16 min left\n"


def test_slow_steps_are_counted_by_the_minute(
    clock: Clock, capsys: pytest.CaptureFixture[str]
) -> None:
    """A rate below one in ten seconds is one a minute or an hour."""
    with progress_bar("record", "steps") as progress:
        progress(0, 40)
        clock.now_s = 120.0
        progress(4, 40)
        clock.now_s = 36_000.0
        progress(5, 40)
    assert capsys.readouterr().err.splitlines() == [
        "4 of 40 steps, 2.0/min, 18 min left", "5 of 40 steps, 0.5/h, 70 h left",
    ]  # fmt: skip


def test_a_terminal_has_a_bar(
    clock: Clock, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The bar says the same words, on stderr, and is gone at the end."""

    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    with progress_bar("sweep") as progress:
        progress(0, 400)
        clock.now_s = 5.0
        progress(20, 400)
    assert "20 of 400 runs, 4.0/s, 95 s left" in terminal.getvalue()
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.4, "0 s"), (99.4, "99 s"), (100.0, "2 min"), (5_900.0, "98 min"), (36_000.0, "10 h"),
     (86_400.0 * 4, "4 days")],
)  # fmt: skip
def test_times_in_words(seconds: float, words: str) -> None:
    """Whole numbers of the largest unit that leaves more than one and a half of it."""
    assert duration_text(seconds) == words


@pytest.mark.parametrize(
    ("count", "words"),
    [(999, "999 bytes"), (1_234, "1.2 kB"), (999_600, "1 MB"), (45e6, "45 MB"), (3e15, "3,000 TB")],
)
def test_sizes_in_words(count: float, words: str) -> None:
    """Two or three digits in powers of 1,000."""
    assert bytes_text(count) == words


def test_one_of_a_kind_is_not_several() -> None:
    """A noun has its plural for every number but 1, and thousands have commas."""
    texts = [count_text(count, "run") for count in (0, 1, 2, 1001)]
    assert texts == ["0 runs", "1 run", "2 runs", "1,001 runs"]
