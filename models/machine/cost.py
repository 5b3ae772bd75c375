"""Coefficients of a cost model: milliseconds per unit of each predictor; `frame_cost` prices.

``ms = base + Σ linear · x + Σ_objects max(geometry · x, pixel · x) + Σ_knees ms · max(0, x − at)``,
the second sum over objects being Gobbetti-Bouvier's and Funkhouser-Séquin's ``max(T_tri ·
triangles, T_pix · pixels)``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ...base.arrays import FloatArray, derive, frozen_array, require_finite
from ...base.errors import InputError, require_whole
from ...base.predictors import CPU_PREDICTORS, GPU_PREDICTORS, POLICY_WORK
from .knee import Knee

DISC_SHARE = 0.4
"""Share of a bounding sphere's disc that a mesh covers; hulls of eight cover 0.32 to 0.46."""


def _vector(names: tuple[str, ...], given: Mapping[str, float], label: str) -> FloatArray:
    unknown = sorted(set(given) - set(names))
    if unknown:
        raise InputError(f"{label}: expected predictors among {', '.join(names)}; got {unknown[0]}")
    return _checked([given.get(name, 0.0) for name in names], names, label)


def _checked(values: ArrayLike, names: tuple[str, ...], label: str) -> FloatArray:
    array = frozen_array(values, np.float64, (len(names),), label)
    require_finite(array, label, low=0.0)
    return array


def _require_base(base_ms: float, label: str) -> None:
    if not (np.isfinite(base_ms) and base_ms >= 0.0):
        raise InputError(f"{label}: expected milliseconds >= 0, got {base_ms}")


@dataclass(frozen=True, slots=True)
class CostModel:
    """GPU milliseconds of a frame.

    Attributes
    ----------
    base_ms : float
        Cost of an empty frame.
    linear_ms : (P,) float64
        Milliseconds per unit, in the order of `GPU_PREDICTORS`.
    roofline_ms : (P,) float64
        Milliseconds per unit of the roofline term; ``shaded_samples`` is its pixel side, every
        level predictor its geometry side.
    knees : tuple of Knee
        Costs of what a frame counts beyond a total, each of another name.
    passes : int
        Cameras that draw what they see one after another: each draws, and is charged, anew.  1
        also where several draw at once.
    """

    base_ms: float
    linear_ms: FloatArray
    roofline_ms: FloatArray
    knees: tuple[Knee, ...] = ()
    # No number of the machine's: it takes no part in its content.
    passes: int = field(default=1, compare=False)

    def __post_init__(self) -> None:
        require_whole(self.passes, "passes", 1)
        for name in ("linear_ms", "roofline_ms"):
            derive(self, **{name: _checked(getattr(self, name), GPU_PREDICTORS, name)})
        _require_base(self.base_ms, "base")
        names = [knee.name for knee in self.knees]
        if len(set(names)) < len(names):
            raise InputError(f"knees: expected each once, got {', '.join(names)}")

    @classmethod
    def of(
        cls,
        base_ms: float,
        linear: Mapping[str, float],
        roofline: Mapping[str, float] | None = None,
        knees: Sequence[Knee] = (),
    ) -> "CostModel":
        """Build a model from milliseconds per unit by predictor name.

        Raises `InputError` if a predictor is unknown or a coefficient negative or not finite.
        """
        return cls(
            base_ms,
            _vector(GPU_PREDICTORS, linear, "linear"),
            _vector(GPU_PREDICTORS, roofline or {}, "roofline"),
            tuple(knees),
        )

    @property
    def has_roofline(self) -> bool:
        """Whether any coefficient of the roofline is positive."""
        return bool(self.roofline_ms.any())

    def unit_ms(self, predictor: str) -> float:
        """Return the linear coefficient of a predictor, ms per unit."""
        return float(self.linear_ms[GPU_PREDICTORS.index(predictor)])

    def counted_ms(self, counts: Mapping[str, FloatArray]) -> FloatArray:
        """Return what all but the roofline says of n frames' counts by predictor, (n,)."""
        total = np.full(len(next(iter(counts.values()))), self.base_ms)
        for name, ms in zip(GPU_PREDICTORS, self.linear_ms.tolist(), strict=True):
            if ms > 0.0:
                total = total + ms * counts[name]
        for knee in self.knees:
            total = total + knee.ms * np.maximum(0.0, counts[knee.predictor] - knee.at)
        return total


@dataclass(frozen=True, slots=True)
class CpuCostModel:
    """CPU milliseconds of a frame: base and milliseconds per unit of `CPU_PREDICTORS`."""

    base_ms: float
    linear_ms: FloatArray
    _charged: list[tuple[str, float]] = field(init=False, repr=False)
    _charged_work: list[tuple[str, float]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        array = _checked(self.linear_ms, CPU_PREDICTORS, "cpu linear_ms")
        _require_base(self.base_ms, "cpu base")
        charged = [(n, ms) for n, ms in zip(CPU_PREDICTORS, array.tolist(), strict=True) if ms]
        work = [term for term in charged if term[0] in POLICY_WORK]
        derive(self, linear_ms=array, _charged=charged, _charged_work=work)

    @classmethod
    def of(cls, base_ms: float, linear: Mapping[str, float]) -> "CpuCostModel":
        """Build a model from milliseconds per unit by predictor name; raises InputError."""
        return cls(base_ms, _vector(CPU_PREDICTORS, linear, "cpu linear"))

    def frame_ms(self, counts: Mapping[str, float]) -> tuple[float, float]:
        """Return the time of a frame of these counts, and the policy's work's share of it, ms."""
        select_ms = sum([ms * counts[name] for name, ms in self._charged_work])
        return self.base_ms + sum([ms * counts[name] for name, ms in self._charged]), select_ms
