"""How far a command is, on stderr: a bar in a terminal, a line now and then elsewhere."""

import sys
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager

from ...base.quantities import duration_text

Progress = Callable[[int, int], None]
"""Called with the steps done and the steps in all."""

LINE_S = 10.0
"""Time between lines where there is no terminal; a job that is done before has none."""


@contextmanager
def progress_bar(label: str, unit: str = "runs") -> Generator[Progress]:
    """Yield what shows steps done of all, their rate, and the time that the rest takes.

    Parameters
    ----------
    unit
        What a step is, in the plural.
    """
    if not sys.stderr.isatty():
        yield _Lines(unit)
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    # Our own words in place of rich's columns: they are the same as those of a line.
    columns = (TextColumn(label), BarColumn(), TextColumn("{task.fields[words]}"))
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        pace = _Pace(unit)
        task = bar.add_task(label, total=None, words="")
        yield lambda done, total: bar.update(
            task, completed=done, total=total, words=pace.words(done, total)
        )


class _Pace:
    """Steps a second since the first call, which may come with steps of an earlier start."""

    def __init__(self, unit: str) -> None:
        self._unit = unit
        self._began_s, self._first = time.monotonic(), -1

    def words(self, done: int, total: int) -> str:
        """Return such as ``123 of 4,000 runs, 12.3/s, 5 min left``."""
        if self._first < 0:
            # The first call is after the first step, or before it with what was done before.
            self._first = done if done > 1 else 0
        text = f"{done:,} of {total:,} {self._unit}"
        passed_s, new = time.monotonic() - self._began_s, done - self._first
        if passed_s <= 0.0 or new <= 0:
            return text
        rate = new / passed_s
        return f"{text}, {_rate(rate)}, {duration_text((total - done) / rate)} left"


class _Lines:
    """A line on stderr every `LINE_S`, when a step is done."""

    def __init__(self, unit: str) -> None:
        self._pace = _Pace(unit)
        self._last_s = time.monotonic()

    def __call__(self, done: int, total: int) -> None:
        words, now_s = self._pace.words(done, total), time.monotonic()
        if now_s - self._last_s >= LINE_S and done < total:
            self._last_s = now_s
            print(words, file=sys.stderr, flush=True)


def _rate(per_s: float) -> str:
    if per_s >= 0.1:
        return f"{per_s:.1f}/s"
    return f"{60.0 * per_s:.1f}/min" if per_s >= 0.1 / 60.0 else f"{3600.0 * per_s:.1f}/h"
