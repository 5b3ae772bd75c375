"""What a policy promises beyond the contract that binds every policy."""

from dataclasses import dataclass

__all__ = ["Claims", "claims_of"]


@dataclass(frozen=True, slots=True)
class Claims:
    """Properties that a policy claims, and that the contract checks then hold it to.

    A policy says so with an attribute or property `claims`; without one it claims nothing.

    Attributes
    ----------
    budget : bool
        With the true cost model and no noise, neither the predicted time nor the time itself
        exceeds the budget, unless that of the coarsest selection does.
    monotone : bool
        More budget never lowers the benefit of a frame of a flat scene.
    settles_frames : int or None
        Frames after which a camera at rest changes no level any more; None if that may never be.
    hysteresis : bool
        A step forward, back and forward again nowhere switches a node twice.
    """

    budget: bool = False
    monotone: bool = False
    settles_frames: int | None = None
    hysteresis: bool = False


def claims_of(policy: object) -> Claims:
    """Return what a policy, or a class whose claims do not depend on its parameters, claims."""
    claims = getattr(policy, "claims", None)
    return claims if isinstance(claims, Claims) else Claims()
