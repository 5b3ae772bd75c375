"""What the figures of a comparison are drawn from, and on."""

from dataclasses import dataclass

from ....base.errors import InputError
from ....base.foreign_text import one_line
from ....sim.frame_log import FrameLog
from ...study.comparison import Comparison
from ...study.comparison_parts import PolicyResult
from ..palette import Ink
from ..summary import shown_policies

_LONGEST_NAME = 24

DASHES = {"solid": "-", "dash": "--", "dot": ":", "dashdot": "-."}
MARKERS = {"circle": "o", "square": "s", "diamond": "D", "triangle-up": "^"}
"""What the page's charts call a dash and a marker, in matplotlib."""

BUDGET_COLOR = "#555555"


@dataclass(frozen=True, slots=True)
class Sheet:
    """A comparison, the frames of its policies, how each is drawn, and a width in inches.

    Raises `InputError` if no policy was scored.
    """

    comparison: Comparison
    logs: dict[str, FrameLog]
    inks: dict[str, Ink]
    width_in: float

    def __post_init__(self) -> None:
        if not self.comparison.ok:
            raise InputError("--figures: expected a policy with scores, got none; see the reasons")

    @property
    def policies(self) -> tuple[PolicyResult, ...]:
        """Policies that are drawn: of those that did the same, one."""
        return shown_policies(self.comparison)

    def names(self) -> dict[str, str]:
        """Return a short name by label, in one line, and no two the same."""
        names: dict[str, str] = {}
        for policy in self.policies:
            short = name = one_line(policy.label, _LONGEST_NAME)
            again = 2
            while name in names.values():
                name, again = f"{short} ({again})", again + 1
            names[policy.label] = name
        return names

    def budget_text(self) -> str:
        """Return the name of the budget's line."""
        return f"budget {self.comparison.budget_ms:.4g} ms"
