"""Costs that nobody measured: what the work of a kept run would be, were they charged too.

Counts of the run are priced again; nothing is replayed.  So a policy that watches times does not
answer to them, which it would.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ...base.predictors import CPU_PREDICTORS, GPU_PREDICTORS, POLICY_WORK
from ...models.machine.hardware import HardwareProfile
from ..metrics.measured_frames import MeasuredFrames


@dataclass(frozen=True, slots=True)
class AddedCost:
    """A cost on top of what the profile charges.

    Attributes
    ----------
    name : str
        In words that follow "with".
    predictors : tuple of str
        What is counted.
    gpu_ms, cpu_ms : float or None
        Of each; None for what the profile charges, once more.
    where_free : bool
        Whether it is of profiles alone that charge nothing for it.
    """

    name: str
    predictors: tuple[str, ...]
    gpu_ms: float | None = None
    cpu_ms: float | None = None
    where_free: bool = False


ADDED_COSTS = (
    # A frame in which a driver makes what a level needs has its hitch: some milliseconds, assumed.
    AddedCost("2 ms for the first use of each level", ("first_uses",), gpu_ms=0.0, cpu_ms=2.0),
    AddedCost("uploads at twice their cost", ("bytes_uploaded",)),
    # PCIe 3.0 with 16 lanes has 15.75 GB/s.
    AddedCost("uploads at 10 GB/s", ("bytes_uploaded",), gpu_ms=1e-7, cpu_ms=0.0, where_free=True),
    # No bundled profile has measured what deciding takes: compiled or interpreted, by how many
    # threads.
    AddedCost("deciding at twice its cost", POLICY_WORK),
)


def works_with_added(
    frames: MeasuredFrames,
    hardware: HardwareProfile,
    costs: Sequence[AddedCost] = ADDED_COSTS,
) -> Iterator[tuple[str, FloatArray]]:
    """Yield the name of each cost and `work_ms` with it, (n,).

    A cost whose count the log lacks, or that is nothing on this machine, is not yielded.
    """
    for cost in costs:
        cpu, gpu, any_cost = frames["cpu_ms"], frames["gpu_ms"], False
        for name in cost.predictors:
            charged = _unit_ms(hardware, name)
            if name not in frames.log.columns or (cost.where_free and any(charged)):
                continue
            gpu_ms = charged[0] if cost.gpu_ms is None else cost.gpu_ms
            cpu_ms = charged[1] if cost.cpu_ms is None else cost.cpu_ms
            cpu, gpu = cpu + cpu_ms * frames[name], gpu + gpu_ms * frames[name]
            any_cost |= gpu_ms > 0.0 or cpu_ms > 0.0
        if any_cost:
            yield cost.name, np.maximum(cpu, gpu)


def _unit_ms(hardware: HardwareProfile, predictor: str) -> tuple[float, float]:
    """Return what one of a predictor costs the GPU and the CPU."""
    gpu, cpu = (
        float(unit_ms[names.index(predictor)]) if predictor in names else 0.0
        for names, unit_ms in (
            (GPU_PREDICTORS, hardware.gpu.linear_ms),
            (CPU_PREDICTORS, hardware.cpu.linear_ms),
        )
    )
    return gpu, cpu
