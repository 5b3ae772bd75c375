"""Put a report together from its sections."""

from collections.abc import Callable
from importlib import import_module

from ...sim.frame_log import FrameLog
from ..study.comparison import Comparison
from .blocks import Section
from .page import render_page
from .palette import inks
from .results import Results
from .summary import describe_run

SECTIONS = (
    "verdicts",
    "headline",
    "along_the_trace",
    "slow_frames",
    "load_steps",
    "tradeoffs",
    "every_metric",
    "provenance",
)
"""Files of ``sections/``, in the order of the page; each has a section of the same name."""


def render_report(comparison: Comparison, logs: dict[str, FrameLog]) -> str:
    """Return the HTML of a comparison; the same comparison gives the same bytes.

    Parameters
    ----------
    comparison : Comparison
    logs : dict of str to FrameLog
        By label, of every policy with status ok.
    """
    results = Results(comparison, logs, inks(comparison))
    return render_page(
        f"Which policy keeps {comparison.budget_ms:.4g} ms?",
        describe_run(comparison),
        [_find_section(name)(results) for name in SECTIONS],
    )


def _find_section(name: str) -> Callable[[Results], Section]:
    return getattr(import_module(f".sections.{name}", __package__), name)
