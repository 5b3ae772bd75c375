"""The machine that frames were drawn on several deep: a profile with the recorder's own CPU.

A profile that was fitted to whole frames charges all of a frame to the GPU, and what Python takes
to cull, to decide and to keep accounts is no cost of the machine's.  Where frames overlap both
matter: the device works on one frame while the next is prepared and submitted.  So here the CPU
takes what it took in the recording.  The GPU takes the price of a frame times one factor: that by
which all of them together took the device as long as they did after their submission.  A price
is of frames that are waited for, and beside each other both halves are slower: on two cores of
llvmpipe, by a third.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...models.machine.cost import CostModel, CpuCostModel
from ...models.machine.hardware import HardwareProfile, Posterior
from ...models.machine.residual import Residual
from .recorded_frames import Measured, frames_in_flight


def as_drawn(
    hardware: HardwareProfile,
    header: Mapping[str, str],
    recordings: Sequence[Sequence[Measured]],
) -> HardwareProfile:
    """Return the machine that frames were recorded on: as deep, and with the CPU's part apart.

    The CPU's part is log-normal about one number for all frames of the recordings: a case that is
    to tell of lag has one policy.

    Parameters
    ----------
    header : of the recordings
    """
    deep = replace(hardware, frames_in_flight=frames_in_flight(header))
    items = [item for passed in recordings for item in passed]
    prepare_ms = [item.prepare_ms for item in items if item.prepare_ms is not None]
    submit_ms = [item.submit_ms for item in items if item.submit_ms is not None]
    if not prepare_ms or not submit_ms:
        return deep
    submitted_ms = np.concatenate(submit_ms)
    worked_ms = np.concatenate([np.asarray(item.frames["gpu_ms"]) for item in items])
    priced_ms = np.concatenate([hardware.gpu.counted_ms(item.counts) for item in items])
    # Of sums, since a price is of the mean frame.
    left = float(worked_ms.sum() / priced_ms.sum()) if priced_ms.any() else 1.0
    log_ms = np.log(np.concatenate(prepare_ms) + submitted_ms)
    return replace(
        deep,
        cpu=CpuCostModel.of(float(np.exp(log_ms.mean())), {}),
        cpu_residual=Residual("lognormal", float(log_ms.std()), floor=0.0),
        gpu=_scaled(hardware.gpu, left),
        posterior=None if hardware.posterior is None else _scaled_draws(hardware.posterior, left),
    )


def _scaled(model: CostModel, share: float) -> CostModel:
    knees = tuple(replace(knee, ms=share * knee.ms) for knee in model.knees)
    return CostModel(
        share * model.base_ms, share * model.linear_ms, share * model.roofline_ms, knees
    )


def _scaled_draws(draws: Posterior, share: float) -> Posterior:
    roofline_ms, knee_ms = draws.roofline_ms, draws.knee_ms
    return replace(
        draws,
        base_ms=share * draws.base_ms,
        linear_ms=share * draws.linear_ms,
        roofline_ms=None if roofline_ms is None else share * roofline_ms,
        knee_ms=None if knee_ms is None else share * knee_ms,
    )
