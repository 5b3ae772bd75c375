"""Put a report together from its sections."""

from collections.abc import Callable, Mapping
from importlib import import_module

from ...models.scene.scene import Scene
from ...sim.frame_log import FrameLog
from ..study.comparison import Comparison
from .blocks import Section
from .page import render_page
from .palette import inks
from .results import Results
from .summary import describe_run

SECTIONS = (
    "the_answer",
    "ranks",
    "tradeoffs",
    "along_the_trace",
    "slow_frames",
    "load_steps",
    "flicker",
    "object_levels",
    "robustness",
    "worst_moments",
    "cost_breakdown",
    "predictions",
    "from_above",
    "every_metric",
    "provenance",
)
"""Files of ``sections/``, in the order of the page; each has a section of the same name."""

_DRAWN_AT_FIRST = 6
"""Policies, the first of the ranking, that charts show until a reader asks for more."""


def render_report(
    comparison: Comparison,
    logs: dict[str, FrameLog],
    scene: Scene | None = None,
    pictures: Mapping[str, bytes] | None = None,
) -> str:
    """Return the HTML of a comparison; the same comparison gives the same bytes.

    Parameters
    ----------
    comparison : Comparison
    logs : dict of str to FrameLog
        By label, of every policy with status ok.
    scene : Scene or None
        By which the nodes are named whose levels the logs keep.
    pictures : mapping of str to bytes, or None
        PNG of the worst moments of some policies, by label.
    """
    results = Results(comparison, logs, inks(comparison), scene, pictures or {})
    return render_page(
        f"Which policy keeps {comparison.budget_ms:.4g} ms?",
        results.words(describe_run(comparison)),
        [find_section(name)(results) for name in SECTIONS],
        [results.name_of(policy) for policy in results.drawn],
        _DRAWN_AT_FIRST,
    )


def find_section(name: str) -> Callable[[Results], Section]:
    """Return what builds a section of `SECTIONS` by its name."""
    return getattr(import_module(f".sections.{name}", __package__), name)
