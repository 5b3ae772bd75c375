"""What the sections of a report are made from."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ...sim.frame_log import FrameLog
from ..study.comparison import Comparison
from ..study.comparison_parts import PolicyResult
from .blocks import Block, Cell, Chart, Section
from .palette import Ink
from .summary import MetricColumn
from .values import format_span


@dataclass(frozen=True, slots=True)
class Results:
    """A comparison, the frame logs of its scored policies, and how each policy is drawn.

    Attributes
    ----------
    logs, inks : by label
    """

    comparison: Comparison
    logs: dict[str, FrameLog]
    inks: dict[str, Ink]

    def chart(self, name: str, draw: Callable[["Results"], Any]) -> Chart:
        """Return a chart, empty where no policy was scored."""
        return Chart(name, draw(self) if self.comparison.ok else None)

    def name_of(self, policy: PolicyResult, tags: tuple[str, ...] = ()) -> Cell:
        """Return a policy's name with its mark."""
        return Cell(policy.label, ink=self.inks[policy.label], tags=tags)

    def value_of(self, policy: PolicyResult, column: MetricColumn) -> Cell:
        """Return a policy's value, with its interval over such paths below, or of this path."""
        score = policy.metrics[column.metric]
        span = score.such_paths or score.this_path
        small = "" if span is None else format_span(*span, percent=column.percent)
        return Cell(column.text(policy), small)


_Blocks = Callable[[Results], Sequence[Block]]
_Build = Callable[[Results], Section]


def section(title: str, *, folded: bool = False) -> Callable[[_Blocks], _Build]:
    """Make the function below, which returns blocks, a section under a heading.

    Its docstring is the note under the heading; ``{level}`` stands for the level of intervals.
    """

    def record(blocks: _Blocks) -> _Build:
        note = " ".join((blocks.__doc__ or "").split())

        def build(results: Results) -> Section:
            level = f"{results.comparison.sampling.level:.0%}"
            return Section(title, note.format(level=level), blocks(results), folded)

        return build

    return record
