"""Flicker: how often and how visibly the level of detail switches, a second of the window."""

from .measured_frames import MeasuredFrames
from .metric import metric


@metric("flicker", "1/s", "lower")
def visible_pops_per_s(run: MeasuredFrames) -> float | None:
    """Switches that change the projected error by the least visible error (`--visible`) or more.

    Source: lodbench; the threshold of 1 px is that of meshoptimizer, Godot and Nanite's authors.
    """
    return _per_s(run, "visible_pops")


@metric("flicker", "1/s", "lower")
def toggles_per_s(run: MeasuredFrames) -> float | None:
    """Switches of level, up or down, of nodes visible in this frame and the one before.

    Source: three.js issue 14565; the HLOD thesis, which counts the switch of a node as one.
    """
    return _per_s(run, "toggles")


@metric("flicker", "1/s", "lower")
def reversals_per_s(run: MeasuredFrames) -> float | None:
    """Switches that undo the switch before on the same node within 0.5 s.

    Source: three.js pull request 14566: no place where a step forward, back and forward shows a
    change of level twice.
    """
    return _per_s(run, "reversals")


@metric("flicker", "px/s", "lower")
def popping_px_per_s(run: MeasuredFrames) -> float | None:
    """Sum over switches of the change of projected error times the node's share of the viewport.

    Source: lodbench; perceptual basis in Schwarz and Stamminger, APGV 2009.
    """
    return _per_s(run, "popping_px")


def _per_s(run: MeasuredFrames, column: str) -> float:
    return float(run[column].sum()) / run.window_s
