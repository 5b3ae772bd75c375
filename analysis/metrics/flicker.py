"""Flicker: how often and how visibly the level of detail switches."""

from .measured_frames import MeasuredFrames
from .metric import metric
from .statistic import Statistic, mean


@metric("flicker", "switches", "lower")
def toggles_per_frame(run: MeasuredFrames) -> Statistic:
    """Switches of level, up or down, of nodes visible in this frame and the one before.

    Source: three.js issue 14565; the HLOD thesis, which counts the switch of a node as one.
    """
    return mean(run["toggles"])


@metric("flicker", "switches", "lower")
def reversals_per_frame(run: MeasuredFrames) -> Statistic:
    """Switches that undo the switch before on the same node within 0.5 s.

    Source: three.js pull request 14566: no place where a step forward, back and forward shows a
    change of level twice.
    """
    return mean(run["reversals"])


@metric("flicker", "px", "lower")
def popping_px_per_frame(run: MeasuredFrames) -> Statistic:
    """Sum over switches of the change of projected error times the node's share of the viewport.

    Source: lodbench; perceptual basis in Schwarz and Stamminger, APGV 2009.
    """
    return mean(run["popping_px"])
