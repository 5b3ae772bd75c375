"""The protocol that every policy follows, and what a policy says about itself."""

from dataclasses import dataclass
from typing import ClassVar, Protocol, runtime_checkable

from ..models.cost import CostModel
from ..models.scene import Scene
from .selection import Selection
from .view import View

__all__ = ["Capabilities", "Oracle", "Policy", "Truth", "why_not_applicable"]


@dataclass(frozen=True, slots=True)
class Capabilities:
    """What scenes a policy can drive and what it needs.

    Attributes
    ----------
    levels : discrete levels
    continuous : continuous resolutions
    hierarchy : fronts in trees
    loader : needs a loader that streams nodes
    future : sees the frame's true costs through the oracle's channel; marked in every table
    """

    levels: bool = True
    continuous: bool = False
    hierarchy: bool = False
    loader: bool = False
    future: bool = False


@runtime_checkable
class Policy(Protocol):
    """A level-of-detail policy: told the scene and budget once, then asked once a frame."""

    capabilities: ClassVar[Capabilities]

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Forget everything and prepare for a replay of this scene within this budget."""
        ...

    def select(self, view: View) -> Selection:
        """Return what to draw of the candidates in this frame."""
        ...


@dataclass(frozen=True, slots=True)
class Truth:
    """What an oracle is told of the frame about to be drawn, and no policy may know.

    Attributes
    ----------
    costs : CostModel
        The cost model that the replay takes for true.
    gpu_factor : float
        Noise by which the frame's GPU time will be multiplied.
    """

    costs: CostModel
    gpu_factor: float


@runtime_checkable
class Oracle(Policy, Protocol):
    """A policy with the capability `future`: it is told the truth before each `select`."""

    def foresee(self, truth: Truth) -> None:
        """Note the truth about the next frame."""
        ...


def why_not_applicable(capabilities: Capabilities, scene: Scene) -> str | None:
    """Return why a policy does not fit a scene, or None if it does."""
    if not scene.flat and not capabilities.hierarchy:
        return "the scene is a hierarchy and the policy selects no fronts"
    if scene.flat and not (capabilities.levels or capabilities.continuous):
        return "the scene is flat and the policy only selects fronts of a hierarchy"
    soft = scene.types.levels.continuous
    if soft.any() and not capabilities.continuous:
        return "the scene has continuous types and the policy only selects discrete levels"
    if not soft.all() and not capabilities.levels and scene.flat:
        return "the scene has discrete types and the policy only selects continuous resolutions"
    return None
