"""The runs of one policy of a study, made from its grid one after the other."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ....policies.policy_spec import PolicySpec
from ....policies.registry import vary_policy
from ....sim.replay import ReplayOptions
from ..field_of_view import field_of_view
from ..run import Run
from .conditions import DEFAULTS, MACHINE
from .grid import Cell, Grid
from .study_inputs import StudyInputs

if TYPE_CHECKING:
    from ....traces.cameras.camera_trace import CameraTrace


@dataclass(frozen=True, slots=True)
class Case:
    """A run of a study, and where it stands on the study's axes.

    Attributes
    ----------
    cells : dict of str to Cell
        By axis; those on which the study does not vary are there too.
    """

    run: Run
    cells: dict[str, Cell]


@dataclass(frozen=True, slots=True)
class Block:
    """The runs of one policy.

    Attributes
    ----------
    spec : PolicySpec
        Without the parameters that vary.
    params : dict of str to str
        By axis, the parameter that varies on it.
    grid : Grid
        Of the policy, its parameters, and the axes that all policies have.
    inputs : StudyInputs
    warmup_s : float
    """

    spec: PolicySpec
    params: dict[str, str]
    grid: Grid
    inputs: StudyInputs
    warmup_s: float

    def cases(self, places: Iterable[tuple[int, ...]]) -> Iterator[Case]:
        """Yield the runs at places of the grid, of which scenes and paths are loaded."""
        axes = [(axis.name, axis.values, axis.cells) for axis in self.grid.axes]
        specs: dict[tuple[Any, ...], PolicySpec] = {}
        for at in places:
            values = {name: known[i] for (name, known, _), i in zip(axes, at, strict=True)}
            cells = {name: known[i] for (name, _, known), i in zip(axes, at, strict=True)}
            machine = (cells["hardware"], *(values[name] for name in MACHINE))
            if values["budget_ms"] is None:
                refresh_ms = self.inputs.machines[machine].budget_ms(None)
                values["budget_ms"] = cells["budget_ms"] = refresh_ms
            scene, trace, hardware = self.inputs.hashes(cells["scene"], cells["trace"], machine)
            if values["fovy_deg"] is None:
                path: CameraTrace = self.inputs.loaded[trace]
                values["fovy_deg"] = cells["fovy_deg"] = field_of_view([path])
            chosen = tuple(values[axis] for axis in self.params)
            if chosen not in specs:
                varied = dict(zip(self.params.values(), chosen, strict=True))
                specs[chosen] = vary_policy(self.spec, varied) if varied else self.spec
            options = ReplayOptions(**{name: values[name] for name in DEFAULTS})
            run = Run(specs[chosen], scene, trace, hardware, options, self.warmup_s)
            yield Case(run, cells)
