"""A hardware profile: cost models, their uncertainty, display, memory and disk."""

from dataclasses import dataclass, field, replace
from typing import Annotated, Literal, get_args

import numpy as np

from ...base.arrays import FloatArray, freeze, require_finite
from ...base.errors import InputError, require_between, require_whole
from ...base.predictors import GPU_PREDICTORS
from .cost import CostModel, CpuCostModel
from .identification import Identification
from .residual import Residual
from .scatter import Scatter

DisplayMode = Literal["immediate", "vsync", "mailbox", "vrr"]
Pacing = Literal["none", "limiter", "just-in-time"]

MOST_LATENCY = 16
"""Frames of a waitable swapchain at most: DXGI's SetMaximumFrameLatency."""

_SCATTER_DRAWS = 64  # as many as a fit keeps


@dataclass(frozen=True, slots=True)
class Display:
    """How finished frames reach the screen, and what frames wait for before they begin.

    Attributes
    ----------
    mode : "immediate", "vsync", "mailbox" or "vrr"
    refresh_hz : refresh rate of vsync and mailbox; highest rate of vrr
    vrr_min_hz : lowest rate of vrr, below which the panel repeats a frame
    images : 2 or 3 images in the swapchain
    pacing : "none", "limiter" or "just-in-time", see `sim.pipeline.pacing`
    limiter_hz : highest rate at which frames begin under "limiter"; 0 for that of the refresh
    latency_limit : frames begun and not yet shown, 1 to 16 at most; 0 for no limit
    width_px, height_px : viewport
    """

    mode: DisplayMode = "vsync"  # what a user sees who changes nothing
    refresh_hz: float = 60.0
    vrr_min_hz: float = 48.0
    images: int = 3
    pacing: Pacing = "none"
    limiter_hz: float = 0.0
    latency_limit: int = 2  # Unity's maxQueuedFrames; without it light frames fill all queues
    width_px: int = 1280
    height_px: int = 720

    def __post_init__(self) -> None:
        if self.mode not in ("immediate", "vsync", "mailbox", "vrr"):
            raise InputError(
                f"display mode: expected immediate, vsync, mailbox or vrr, got {self.mode}"
            )
        if self.images not in (2, 3):
            raise InputError(f"display images: expected 2 or 3, got {self.images}")
        if not 0 < self.vrr_min_hz <= self.refresh_hz < 1e5:
            raise InputError(
                "display: expected 0 < vrr_min_hz <= refresh_hz, got "
                f"{self.vrr_min_hz} and {self.refresh_hz}"
            )
        self._require_pacing()
        if self.width_px < 1 or self.height_px < 1:
            raise InputError(
                f"display: expected positive size, got {self.width_px}x{self.height_px}"
            )

    def _require_pacing(self) -> None:
        if self.pacing not in get_args(Pacing):
            raise InputError(
                f"pacing: expected {', '.join(get_args(Pacing))}, got {self.pacing}; name one"
            )
        if not 0.0 <= self.limiter_hz < 1e5:
            raise InputError(f"limiter_hz: expected 0 (the refresh) to 1e5, got {self.limiter_hz}")
        require_whole(self.latency_limit, "latency_limit")
        require_between(self.latency_limit, 0, MOST_LATENCY, "latency_limit")


@dataclass(frozen=True, slots=True)
class Posterior:
    """Draws of GPU coefficients from a fit: D rows of base and `GPU_PREDICTORS` coefficients.

    Attributes
    ----------
    base_ms : (D,) float64
    linear_ms : (D, P) float64
    scale : (D,) float64
        Relative residual scale of each draw.
    roofline_ms : (D, P) float64 or None
        Coefficients of the roofline; None where those of the profile hold for every draw.
    knee_ms : (D, K) float64 or None
        Of the profile's knees, in their order; None as of the roofline.
    """

    base_ms: Annotated[FloatArray, np.float64, "D"]
    linear_ms: Annotated[FloatArray, np.float64, "D", len(GPU_PREDICTORS)]
    scale: Annotated[FloatArray, np.float64, "D"]
    roofline_ms: Annotated[FloatArray | None, np.float64, "D", len(GPU_PREDICTORS)] = None
    knee_ms: Annotated[FloatArray | None, np.float64, "D", "K"] = None

    def __post_init__(self) -> None:
        if len(self) == 0:
            raise InputError("posterior: expected at least one draw, got none")
        knees = 0 if self.knee_ms is None else np.shape(self.knee_ms)[-1]
        freeze(self, "posterior", D=len(self), K=knees)
        for name in ("base_ms", "linear_ms", "roofline_ms", "knee_ms", "scale"):
            if getattr(self, name) is not None:
                require_finite(getattr(self, name), f"posterior {name}", low=0.0)

    def __len__(self) -> int:
        """Return the number of draws."""
        return len(self.base_ms)


@dataclass(frozen=True, slots=True)
class Provenance:
    """Where a profile's numbers come from.

    `assumed` is true where a cost was neither measured nor published; the word is then shown
    wherever the profile is.  `measured_on` names what was drawn as ``SCENE along TRACE``: frames on
    which the profile must not be validated.
    """

    source: str
    renderer: str = ""
    date: str = ""
    method: str = ""
    assumed: bool = False
    measured_on: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, repr=False)
class HardwareProfile:
    """Everything that the simulator knows about a machine.

    Attributes
    ----------
    gpu, cpu : cost models, milliseconds
    gpu_residual, cpu_residual : scatter of measured times about the models
    posterior : draws of the GPU coefficients, if the profile was fitted
    frames_in_flight : 1 to 4
    memory_bytes : bound of the loader
    disk_bytes_per_s, disk_latency_ms : loader bandwidth and latency
    scatter : spread of the GPU's times between occasions and between scenes
    identification : how well the fit could tell its terms apart, if one says so
    """

    name: str
    provenance: Provenance
    gpu: CostModel
    cpu: CpuCostModel
    gpu_residual: Residual = field(default_factory=Residual)
    cpu_residual: Residual = field(default_factory=Residual)
    posterior: Posterior | None = None
    display: Display = field(default_factory=Display)
    frames_in_flight: int = 2
    memory_bytes: float = 1e9
    disk_bytes_per_s: float = 200e6
    disk_latency_ms: float = 1.0
    scatter: Scatter = field(default_factory=Scatter)
    identification: Identification | None = None

    def __post_init__(self) -> None:
        require_between(self.frames_in_flight, 1, 4, "frames_in_flight")
        good = np.isfinite((self.memory_bytes, self.disk_bytes_per_s, self.disk_latency_ms)).all()
        if not good or self.memory_bytes <= 0 or self.disk_bytes_per_s <= 0:
            raise InputError("hardware: expected positive finite memory and disk figures")
        if self.disk_latency_ms < 0:
            raise InputError(f"disk latency: expected >= 0 ms, got {self.disk_latency_ms}")
        drawn = None if self.posterior is None else self.posterior.knee_ms
        if drawn is not None and drawn.shape[1] != len(self.gpu.knees):
            raise InputError(
                f"posterior knee_ms: expected a column for each of {len(self.gpu.knees)} knees, "
                f"got {drawn.shape[1]}"
            )

    def __repr__(self) -> str:
        display, assumed = self.display, ", assumed" if self.provenance.assumed else ""
        size = f"{display.width_px}x{display.height_px}"
        return f"<HardwareProfile {self.name}: {display.mode}, {size}{assumed}>"

    def budget_ms(self, asked: float | None) -> float:
        """Return the budget of a frame: the one that was asked for, else one refresh."""
        return 1e3 / self.display.refresh_hz if asked is None else asked

    @property
    def draws(self) -> int:
        """How many draws of the machine there are: those of a fit, else some of its scatter."""
        if self.posterior is not None:
            return len(self.posterior)
        return _SCATTER_DRAWS if self.scatter.any else 0

    def truth(self, draw: int | None) -> tuple[CostModel, Residual]:
        """Return the GPU's cost model and residual: the profile's own, or those of one draw.

        A draw is a row of the posterior, on one occasion and in one scene of the scatter.

        Raises `InputError` if the profile has no such draw.
        """
        if draw is None:
            return self.gpu, self.gpu_residual
        if not 0 <= draw < self.draws:
            raise InputError(f"draw: {self.name} has {self.draws} draws, got {draw}")
        model, residual = self._fitted(draw)
        return (self.scatter.apply(model, draw) if self.scatter.any else model), residual

    def _fitted(self, draw: int) -> tuple[CostModel, Residual]:
        """Return model and residual of a row of the posterior; without one, the profile's."""
        if self.posterior is None:
            return self.gpu, self.gpu_residual
        drawn, knee_ms = self.posterior.roofline_ms, self.posterior.knee_ms
        model = CostModel(
            float(self.posterior.base_ms[draw]),
            self.posterior.linear_ms[draw],
            self.gpu.roofline_ms if drawn is None else drawn[draw],
            self.gpu.knees
            if knee_ms is None
            else tuple(
                replace(knee, ms=ms)
                for knee, ms in zip(self.gpu.knees, knee_ms[draw].tolist(), strict=True)
            ),
        )
        return model, replace(self.gpu_residual, scale=float(self.posterior.scale[draw]))
