"""The machine and the limits of Gobbetti and Bouvier's tests, whose numbers the text has lost."""

from typing import TYPE_CHECKING

import numpy as np

from ....models.machine.cost import CostModel, CpuCostModel
from ....models.machine.hardware import Display, HardwareProfile, Provenance
from ....models.machine.residual import Residual
from ....sim.frame_log import FrameLog
from ..experiment import Constant
from ..trial import Numbers

if TYPE_CHECKING:
    from ....base.arrays import FloatArray

TARGET_MS = 100.0
OPTIMISE_SHARE = 0.1
COMPARISON_US = 0.1

CONSTANTS = {
    "target": Constant(f"{TARGET_MS:g} ms", "assumed", "the number is lost in the text at hand"),
    "share of optimisation": Constant(
        f"{100 * OPTIMISE_SHARE:g} % of the target", "assumed", "T_opt is lost in the text at hand"
    ),
    "triangles": Constant("0.3 µs each", "assumed", "3.3 million a second; the table is lost"),
    "set-up of an object": Constant("20 µs", "assumed", "the table is lost"),
    "frame without objects": Constant("2 ms", "assumed", "the table is lost"),
    "a comparison of the search": Constant(
        f"{COMPARISON_US:g} µs", "assumed", "some 50 cycles of a Pentium III"
    ),
    "weight of an object": Constant("2 µs", "assumed", "two logarithms of a Pentium III"),
    "culling": Constant("1 µs a box", "assumed", "Pentium III"),
    "noise": Constant("3 % (Gauss)", "assumed", "what a cost model misses is not printed"),
    "degradation": Constant("area per triangle, m = 1", "assumed", "w and m of the tests are lost"),
}


def machine(noise: float) -> HardwareProfile:
    """Return the assumed machine: one processor that draws, too, so one frame at a time."""
    return HardwareProfile(
        "pentium-iii-assumed",
        Provenance("assumed", assumed=True),
        CostModel.of(2.0, {"triangles": 3e-4, "draw_calls": 0.02}),
        CpuCostModel.of(
            0.2,
            {
                "objects_culled": 1e-3,
                "objects_visited": 2e-3,
                "comparisons": 1e-3 * COMPARISON_US,
                "iterations": 5e-3,
            },
        ),
        gpu_residual=Residual("gaussian", noise) if noise else Residual(),
        display=Display("immediate", images=2, width_px=640, height_px=480),
        frames_in_flight=1,
    )


def numbers_of(log: FrameLog) -> Numbers:
    """Return what the experiments judge of a replay, a list a column."""
    serial: FloatArray = (log["gpu_end_ns"] - log["input_ns"]) * 1e-6
    columns = {
        "time_s": log["input_ns"] * 1e-9,
        "frame_ms": serial,
        "display_ms": log["gpu_ms"],
        "predicted_ms": log["predicted_gpu_ms"],
        "full_ms": log["full_gpu_ms"],
        "select_ms": log["select_ms"],
        "passes": log["iterations"],
        "comparisons": log["comparisons"],
        "visible": log["visible"],
        "triangles": log["triangles"],
        "degradation": log["degradation"],
    }
    return {name: np.round(values, 6).tolist() for name, values in columns.items()}
