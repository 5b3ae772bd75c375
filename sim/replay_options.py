"""How to replay: budget, seed, field of view, what is seen, and what the simulator adds."""

import math
from dataclasses import dataclass, field

from ..base.errors import InputError, require_real, require_whole
from ..models.scene.rig import Eyes
from .machine.faults import Faults

MAX_FRAMES = 10_000_000
"""Frames of a replay: 46 hours at 60 Hz."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayOptions:
    """How to replay.

    Attributes
    ----------
    budget_ms : float
        Time that a frame may take; what policies aim at.
    seed : int
        Root of all noise; the noise of frame k is the same under every policy.
    frames : int or None
        Frames to render at most, for tests and timings; None for as long as the trace lasts, as
        all do that are compared.
    fovy_deg : float
        Vertical field of view.
    crossfade_ms : float
        Time for which a switched node is drawn at both levels.
    measurement_delay : int
        Frames, beyond its completion, until a frame's timer is read (GPU timer queries).
    faults : Faults
        What the timers get wrong.
    bound_every : int
        Compute the bound behind `optimality` in every so many frames, 0 for never; flat scenes
        only.  Frames of an oracle always have theirs.
    draw : int or None
        Draw of the machine that plays the truth; None for the profile's mean.
    memory_bytes : float or None
        Bound of the loader; None for the profile's.
    visible_px : float
        Least error on the screen, and least change of it, that is seen.
    eyes : Eyes or None
        The two eyes of a head that follows the path; None for one camera.
    """

    budget_ms: float
    seed: int = 0
    frames: int | None = None
    fovy_deg: float = 60.0
    crossfade_ms: float = 0.0
    measurement_delay: int = 0
    faults: Faults = field(default_factory=Faults)
    bound_every: int = 0
    draw: int | None = None
    memory_bytes: float | None = None
    visible_px: float = 1.0  # as meshoptimizer, Godot and Nanite's authors have it
    eyes: Eyes | None = None

    def __post_init__(self) -> None:
        self._require_types()
        if not (math.isfinite(self.budget_ms) and self.budget_ms > 0.0):
            raise InputError(f"budget: expected milliseconds > 0, got {self.budget_ms}")
        if self.frames is not None and not 1 <= self.frames <= MAX_FRAMES:
            raise InputError(f"frames: expected 1 to {MAX_FRAMES}, got {self.frames}")
        if not (math.isfinite(self.crossfade_ms) and self.crossfade_ms >= 0.0):
            raise InputError(f"crossfade: expected milliseconds >= 0, got {self.crossfade_ms}")
        if not 0 <= self.measurement_delay <= 16:
            raise InputError(
                f"measurement delay: expected 0 to 16 frames, got {self.measurement_delay}"
            )
        if self.memory_bytes is not None and not 0.0 < self.memory_bytes < math.inf:
            raise InputError(f"memory: expected bytes > 0, got {self.memory_bytes}")
        if not (math.isfinite(self.visible_px) and self.visible_px >= 0.0):
            raise InputError(f"visible: expected pixels >= 0, got {self.visible_px}")

    def require_end(self, trace: str, frames: float) -> None:
        """Raise InputError if a trace takes too many frames, and their number is not limited.

        Parameters
        ----------
        trace
            Its name.
        frames
            How many it takes at the rate of the display, or at the pace so far.
        """
        if self.frames is None and frames > MAX_FRAMES:
            raise InputError(
                f"trace {trace}: expected at most {MAX_FRAMES} frames, got {frames:.3g}; "
                "replay a stretch of it"
            )

    def _require_types(self) -> None:
        """Refuse fractions of frames, texts and truth values, which bounds alone would let pass."""
        require_whole(self.seed, "seed", 0)
        require_whole(self.bound_every, "bound_every", 0)
        require_whole(self.measurement_delay, "measurement_delay")
        if self.frames is not None:
            require_whole(self.frames, "frames")
        if self.draw is not None:
            require_whole(self.draw, "draw", 0)
        for name in ("budget_ms", "fovy_deg", "crossfade_ms", "visible_px", "memory_bytes"):
            value = getattr(self, name)
            if value is not None or name != "memory_bytes":
                require_real(value, name)
        if not isinstance(self.faults, Faults):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise InputError(f"faults: expected a Faults, got {self.faults!r}")
        if not isinstance(self.eyes, Eyes | None):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise InputError(f"eyes: expected an Eyes or None, got {self.eyes!r}")
