"""The machine of LODManager's tests, and what changing a level costs on it."""

from dataclasses import replace
from typing import Final

from ....base.predictors import CPU_PREDICTORS
from ....models.machine.cost import CpuCostModel
from ....models.machine.hardware import HardwareProfile
from ....models.machine.profile_catalog import load_hardware
from ..experiment import Constant

PROFILE = "athlon64-6800ultra-assumed"
CHANGED_NS: Final = 30.0
BYTE_NS: Final = 1.0
_VISITED_NS, _COMPARISON_NS = 50.0, 10.0
NEAR_M, FAR_M = 2.0, 90.0
SLOTS = 32

CONSTANTS = {
    "ogres": Constant("3,000 of 1,960 triangles, least 10 %", "printed", "section 5.3"),
    "trees": Constant("100 of 97,133 triangles, least 10 %", "printed", "section 5.3"),
    "machine": Constant(f"`{PROFILE}`", "assumed", "its name is printed, no cost is"),
    "changed triangle": Constant(f"{CHANGED_NS:g} ns", "assumed", "swept"),
    "byte uploaded": Constant(f"{BYTE_NS:g} ns", "assumed", "writes over AGP 8x, 1 GB/s"),
    "object looked at, comparison": Constant(
        f"{_VISITED_NS:g} and {_COMPARISON_NS:g} ns", "assumed", "100 and 20 cycles of 2 GHz"
    ),
    "call of an upload": Constant("0 to 300 µs", "assumed", "swept; decides the answer"),
    "slots N_T": Constant(f"{SLOTS}", "assumed", "left to the user"),
    "range": Constant(f"{NEAR_M:g} to {FAR_M:g} m", "assumed", "not printed"),
    "frame-rate feedback": Constant("off", "assumed", "the comparison is at the same levels"),
    "field": Constant("180 m by 180 m", "assumed", "figure 1"),
}


def machine(call_us: float, changed_ns: float, *, whole: bool) -> HardwareProfile:
    """Return the machine on which changing an index set costs so much.

    Parameters
    ----------
    call_us
        Of each set that is made or changed: locking a buffer, the driver, a wait.
    changed_ns
        Of each triangle in it that is not as it was.
    whole
        Whether the set is sent whole, three indices of four bytes a triangle, or changed in place.
    """
    hardware = load_hardware(PROFILE)
    costs: dict[str, float] = dict(
        zip(CPU_PREDICTORS, hardware.cpu.linear_ms.tolist(), strict=True)
    )
    costs |= {
        "objects_visited": 1e-6 * _VISITED_NS,
        "comparisons": 1e-6 * _COMPARISON_NS,
        "levels_extracted": 1e-3 * call_us,
        "triangles_changed": 1e-6 * changed_ns,
        "bytes_uploaded": 1e-6 * BYTE_NS if whole else 0.0,
    }
    return replace(hardware, cpu=CpuCostModel.of(hardware.cpu.base_ms, costs))


def manager(*, slots: int = SLOTS, sharing: bool = True, more: str = "") -> str:
    """Return the policy's text, without feedback."""
    share = "on" if sharing else "off"
    fixed = f"near_m={NEAR_M:g},far_m={FAR_M:g},gain=1"
    return f"lodmanager:slots={slots},sharing={share},{fixed}{more}"


POLICIES = {
    "manager": manager(),
    "own slots": manager(sharing=False),
    "exact": manager(slots=1_000_000, sharing=False),
}
"""With the manager; with its slots but nothing shared; and each object at its own level."""
