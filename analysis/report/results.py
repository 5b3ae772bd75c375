"""What the sections of a report are made from."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from ...models.scene.scene import Scene
from ...sim.frame_log import FrameLog
from ..metrics.measured_frames import MeasuredFrames
from ..study.comparison import Comparison
from ..study.comparison_parts import PolicyResult
from .blocks import Block, Cell, Section
from .names import short_name, whole_name
from .palette import Ink
from .summary import MetricColumn, shown_policies, words_of
from .values import format_span


@dataclass(frozen=True, slots=True)
class Results:
    """A comparison, the frame logs of its scored policies, and how each policy is drawn.

    Attributes
    ----------
    logs, inks : by label
    scene : Scene or None
        By which the nodes are named whose levels the logs keep.
    pictures : mapping of str to bytes
        PNG of the worst moments of some policies, by label.
    """

    comparison: Comparison
    logs: dict[str, FrameLog]
    inks: dict[str, Ink]
    scene: Scene | None = None
    pictures: Mapping[str, bytes] = field(default_factory=dict[str, bytes])

    @property
    def drawn(self) -> tuple[PolicyResult, ...]:
        """What charts draw, in the order of the answer: of those that did the same, one."""
        return shown_policies(self.comparison)

    @property
    def first(self) -> PolicyResult:
        """The first of the answer, of which sentences speak; there is one where any is drawn."""
        return self.drawn[0]

    def first_path(self, label: str) -> MeasuredFrames:
        """Return what is judged of a policy's first path."""
        return MeasuredFrames(self.logs[label], *self.comparison.window_s[0])

    def words(self, text: str) -> str:
        """Return a text about the comparison, with names cut that are too long to read."""
        return words_of(self.comparison, text)

    def name_of(self, policy: PolicyResult, tags: tuple[str, ...] = ()) -> Cell:
        """Return a policy's name with its mark."""
        label = policy.label
        ink = self.inks[label]
        return Cell(short_name(label), hint=whole_name(label), ink=ink, tags=tags)

    def value_of(self, policy: PolicyResult, column: MetricColumn) -> Cell:
        """Return a policy's value, with its interval over such paths below, or of this path."""
        score = policy.metrics[column.metric]
        span = score.such_paths or score.this_path
        small = "" if span is None else format_span(*span, percent=column.percent)
        return Cell(column.text(policy), small, value=score.value)


_Blocks = Callable[[Results], Sequence[Block]]
_Build = Callable[[Results], Section]


def section(
    title: str, *, folded: bool = False, takeaway: Callable[[Results], str] | None = None
) -> Callable[[_Blocks], _Build]:
    """Make the function below, which returns blocks, a section under a heading.

    Its docstring is the note under the heading; ``{level}`` stands for the level of intervals.

    Parameters
    ----------
    takeaway
        Returns the sentence that a reader should take from the section; empty for none.
    """

    def record(blocks: _Blocks) -> _Build:
        note = " ".join((blocks.__doc__ or "").split())

        def build(results: Results) -> Section:
            level = f"{results.comparison.sampling.level:.0%}"
            said = results.words(takeaway(results)) if takeaway and results.drawn else ""
            return Section(title, note.format(level=level), blocks(results), folded, said)

        return build

    return record
