"""Compare level-of-detail policies on the same footing.

Every name is imported when it is first asked for.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from lodbench.base.errors import InputError, LodbenchError, PolicyError
from lodbench.base.version import __version__

if TYPE_CHECKING:
    from lodbench.analysis.api import check, compare, register, replay
    from lodbench.analysis.fit.fit import Fit
    from lodbench.analysis.fit.log_files import fit, read_log
    from lodbench.analysis.gate.check_result import CheckReport
    from lodbench.analysis.study.comparison import Comparison
    from lodbench.analysis.study.inputs import load_trace
    from lodbench.analysis.study.study import Study
    from lodbench.analysis.study.sweep.study_results import StudyResults
    from lodbench.models.machine.profile_catalog import load_hardware
    from lodbench.models.scene.scene_catalog import load_scene
    from lodbench.policies import Capabilities, Policy, Selection, View, Work
    from lodbench.sim.frame_log import FrameLog

__all__ = [
    "Capabilities",
    "CheckReport",
    "Comparison",
    "Fit",
    "FrameLog",
    "InputError",
    "LodbenchError",
    "Policy",
    "PolicyError",
    "Selection",
    "Study",
    "StudyResults",
    "View",
    "Work",
    "__version__",
    "check",
    "compare",
    "fit",
    "load_hardware",
    "load_scene",
    "load_trace",
    "read_log",
    "register",
    "replay",
]

_HOMES = {
    "analysis.api": ("check", "compare", "register", "replay"),
    "analysis.fit.fit": ("Fit",),
    "analysis.fit.log_files": ("fit", "read_log"),
    "analysis.gate.check_result": ("CheckReport",),
    "analysis.study.comparison": ("Comparison",),
    "analysis.study.inputs": ("load_trace",),
    "analysis.study.study": ("Study",),
    "analysis.study.sweep.study_results": ("StudyResults",),
    "models.machine.profile_catalog": ("load_hardware",),
    "models.scene.scene_catalog": ("load_scene",),
    "policies": ("Capabilities", "Policy", "Selection", "View", "Work"),
    "sim.frame_log": ("FrameLog",),
}
"""Where each name lives: what type checkers are told above, for when the program runs."""


def __getattr__(name: str) -> Any:
    for home, names in _HOMES.items():
        if name in names:
            globals()[name] = value = getattr(import_module(f"lodbench.{home}"), name)
            return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return list(__all__)
