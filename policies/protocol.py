"""The protocol that every policy follows, and what a policy says about itself."""

from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, SupportsIndex, runtime_checkable

from ..base.errors import InputError
from ..base.foreign_text import describe_value
from ..models.machine.cost import CostModel
from ..models.scene.scene import Scene
from .selection import Selection
from .view import View

MOST_REST_FRAMES = 1_000_000
"""What a policy may claim to take to come to rest: nearly five hours at 60 Hz."""


@dataclass(frozen=True, slots=True)
class Capabilities:
    """What scenes a policy can drive and what it needs; raises `InputError` if one is no bool.

    Attributes
    ----------
    levels : bool
        Selects discrete levels.
    continuous : bool
        Selects continuous resolutions.
    hierarchy : bool
        Selects fronts in trees.
    loader : bool
        Needs a loader that streams nodes.
    future : bool
        Sees the frame's true costs through the oracle's channel; marked in every table.
    """

    levels: bool = True
    continuous: bool = False
    hierarchy: bool = False
    loader: bool = False
    future: bool = False

    def __post_init__(self) -> None:
        for name in ("levels", "continuous", "hierarchy", "loader", "future"):
            _require_bool(f"capabilities: {name}", getattr(self, name))


@dataclass(frozen=True, slots=True)
class Claims:
    """Properties that a policy claims, and that the contract checks then hold it to.

    A policy says so with an attribute or property `claims`; without one it claims nothing.

    Raises `InputError` if one is of another kind, or `settles_frames` out of range.

    Attributes
    ----------
    budget : bool
        With the true cost model and no noise, neither the predicted time nor the time itself
        exceeds the budget, unless that of the coarsest selection does.
    monotone : bool
        More budget never lowers the benefit of a frame of a flat scene.
    settles_frames : int or None
        Frames, at most `MOST_REST_FRAMES`, after which a camera at rest changes no level any more;
        None if that may never be.
    hysteresis : bool
        A step forward, back and forward again nowhere switches a node twice.
    """

    budget: bool = False
    monotone: bool = False
    settles_frames: int | None = None
    hysteresis: bool = False

    def __post_init__(self) -> None:
        for name in ("budget", "monotone", "hysteresis"):
            _require_bool(f"claims: {name}", getattr(self, name))
        rest: Any = self.settles_frames
        whole = isinstance(rest, SupportsIndex) and not isinstance(rest, bool)
        if rest is not None and not (whole and 0 <= int(rest) <= MOST_REST_FRAMES):
            raise InputError(
                f"claims: settles_frames: expected None or 0 to {MOST_REST_FRAMES} frames, got "
                f"{describe_value(rest)}"
            )


def _require_bool(name: str, value: object) -> None:
    if value is not True and value is not False:
        raise InputError(f"{name}: expected True or False, got {describe_value(value)}")


def claims_of(policy: object) -> Claims:
    """Return what a policy, or a class whose claims do not depend on its parameters, claims."""
    claims = getattr(policy, "claims", None)
    return claims if isinstance(claims, Claims) else Claims()


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
class Clairvoyant(Policy, Protocol):
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
