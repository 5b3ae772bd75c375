"""A study: policies, parameters, scenes, paths, machines and conditions, in every combination."""

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from ...base.errors import InputError, require_real
from ...base.quantities import count_text
from ...policies.policy_spec import PolicySpec
from ...policies.registry import PolicyLikes, default_policies, specs_of
from ...sim.machine.faults import Faults
from ...traces.cameras.camera_trace import CameraTrace
from ..metrics.measured_frames import require_window
from .axes.blocks import Block, Case
from .axes.conditions import (
    DEFAULTS,
    draw_axis,
    machine_axes,
    named_axis,
    option_axis,
    several,
)
from .axes.grid import Axis, Cell, Exclusions, Grid, require_known, require_listable
from .axes.parameters import Parameters, by_label, column_of, param_axis
from .axes.study_inputs import StudyInputs
from .engine.limits import Limits
from .engine.open_engine import open_engine
from .inputs import WHOLE, EyesLike, HardwareLike, SceneLike, Seconds, TraceLike, as_eyes
from .results.record import COLUMNS
from .results.run_list import RunList
from .run import Run
from .runs import Progress

if TYPE_CHECKING:
    from .sweep.study_results import StudyResults

Exclude: TypeAlias = Sequence[Mapping[str, Cell | Collection[Cell]]]

BASE_POLICY = "base_policy"
"""Column of results: the policy's label without the parameters that the study varies."""

_ALWAYS = ("policy", "scene", "trace", "hardware", "budget_ms", "draw", "seed")


class Study:
    """Runs of policies in every combination of axes, but for those that are excluded.

    Each axis is one value or several.  Scenes and paths are loaded when runs are asked for.

    Raises `InputError` if a policy, a parameter, a profile or a condition is refused, an exclusion
    names what the study lacks, or there are more than 10,000,000 combinations.

    Parameters
    ----------
    policies
        By name, class or object, or a mapping of labels to these; None for every registered one.
    parameters
        By policy, as its label is, the values of its parameters: these are axes too.
    scenes, traces, hardware
        Bundled names, files, or what was loaded, or a mapping of names to these; a path is placed
        in each scene, and a tuple of paths in a mapping is of players who share a screen.
    budget_ms
        Time that a frame may take; None for one refresh of the display.
    seeds
        Seeds of all noise, or a number of them, from 0 on.
    draws
        Draws of the machine that play the truth, None for the profile's mean; or a
        number of them, evenly spaced (the mean where a profile has none, or the number is 0).
    fovy_deg
        Vertical field of view; None for what each path states, or 60.
    crossfade_ms, measurement_delay, faults, bound_every, memory_bytes, visible_px
        As `ReplayOptions` has them.
    eyes
        Metres between two eyes, or an `Eyes`; None for one camera.
    display, refresh_hz, frames_in_flight, pacing, latency_limit
        Mode and rate of the display, frames between CPU and GPU, and what frames wait for before
        they begin; None for the profile's.
    exclude
        Combinations to leave out, each a mapping of axes to a value or several.  Axes go by the
        columns of the results: ``policy``, ``scene``, ``trace``, ``hardware``, ``seed``, ``draw``,
        a parameter, and the others as above.
    seconds
        The stretch of every path that is replayed: its start and its end, None for the path's.
    warmup_s
        Seconds at the start of the stretch that do not count.
    place
        How the path of a file is put into a scene: shrink, fit, center or none.
    name
        What results are called.
    """

    def __init__(
        self,
        policies: PolicyLikes | None = None,
        *,
        parameters: Parameters | None = None,
        scenes: SceneLike | Sequence[SceneLike] | Mapping[str, SceneLike] = "plaza",
        traces: TraceLike
        | Sequence[TraceLike]
        | Mapping[str, TraceLike | tuple[TraceLike, ...]] = "tour",
        hardware: HardwareLike
        | Sequence[HardwareLike]
        | Mapping[str, HardwareLike] = "desktop-assumed",
        budget_ms: float | Sequence[float | None] | None = None,
        seeds: int | Sequence[int] = 1,
        draws: int | Sequence[int | None] = 0,
        fovy_deg: float | Sequence[float | None] | None = None,
        crossfade_ms: float | Sequence[float] = 0.0,
        measurement_delay: int | Sequence[int] = 0,
        faults: Faults | Sequence[Faults] | None = None,
        bound_every: int | Sequence[int] = 0,
        memory_bytes: float | Sequence[float | None] | None = None,
        visible_px: float | Sequence[float] = 1.0,
        eyes: EyesLike | Sequence[EyesLike] = None,
        display: str | Sequence[str | None] | None = None,
        refresh_hz: float | Sequence[float | None] | None = None,
        frames_in_flight: int | Sequence[int | None] | None = None,
        pacing: str | Sequence[str | None] | None = None,
        latency_limit: int | Sequence[int | None] | None = None,
        exclude: Exclude = (),
        seconds: Seconds = WHOLE,
        warmup_s: float = 1.0,
        place: str = "shrink",
        name: str = "study",
    ) -> None:
        require_real(warmup_s, "warmup_s")
        self.name, self._warmup_s = name, warmup_s
        scene, trace = named_axis("scene", scenes), named_axis("trace", traces)
        machine = named_axis("hardware", hardware)
        screens = machine_axes(display, refresh_hz, frames_in_flight, pacing, latency_limit)
        self._inputs = StudyInputs(scene, trace, machine, screens, place, seconds)
        draw, other_draws = draw_axis(draws, self._inputs.profiles)
        options: dict[str, Any] = {
            "budget_ms": budget_ms,
            "fovy_deg": fovy_deg,
            "crossfade_ms": crossfade_ms,
            "measurement_delay": measurement_delay,
            "faults": Faults() if faults is None else faults,
            "bound_every": bound_every,
            "memory_bytes": memory_bytes,
            "visible_px": visible_px,
            "eyes": tuple(map(as_eyes, several(eyes))),
        }
        options["seed"] = range(seeds) if isinstance(seeds, int) else seeds
        values = {key: several(values) for key, values in options.items()}
        require_listable(math.prod(map(len, values.values())))
        *given, seed = (option_axis(key, some) for key, some in values.items())
        self._common = (scene, trace, machine, *screens, *given, draw, seed)
        excluded = _exclusions(exclude)
        specs = specs_of(default_policies() if policies is None else policies)
        varied = by_label(parameters or {}, specs)
        for spec in specs:
            if not varied[spec.label]:  # else combinations are looked at when they are listed
                spec.check_parameters()
        self._blocks = tuple(
            self._block(spec, varied[spec.label], [*excluded, *other_draws]) for spec in specs
        )
        require_known(excluded, [axis for block in self._blocks for axis in block.grid.axes])
        require_listable(len(self))

    def _block(self, spec: PolicySpec, varied: Mapping[str, Any], excluded: Exclusions) -> Block:
        columns = {column_of(name): name for name in varied}
        params = [param_axis(spec, column, name, varied[name]) for column, name in columns.items()]
        policy = Axis("policy", (spec,), (spec.label,))
        grid = Grid((policy, *params, *self._common), excluded)
        return Block(spec, columns, grid, self._inputs, self._warmup_s)

    def __len__(self) -> int:
        """Return the number of runs."""
        return sum(len(block.grid) for block in self._blocks)

    def __repr__(self) -> str:
        sizes = ", ".join(f"{name} {len(cells)}" for name, cells in self.axes.items())
        return f"<Study {self.name}: {count_text(len(self), 'run')}; {sizes}>"

    @cached_property
    def axes(self) -> dict[str, tuple[Cell, ...]]:
        """The columns that tell runs apart, each with its values in the order given."""
        found: dict[str, dict[Cell, None]] = {}
        for axis in (axis for block in self._blocks for axis in block.grid.axes):
            if axis.name in _ALWAYS or axis.values != (DEFAULTS.get(axis.name),):
                found.setdefault(axis.name, {}).update(dict.fromkeys(axis.cells))
        params = {name for block in self._blocks for name in block.params}
        order = ["policy", *(name for name in found if name in params)]
        order += [axis.name for axis in self._common if axis.name in found]
        return {name: tuple(found[name]) for name in order}

    @cached_property
    def inputs(self) -> dict[str, Any]:
        """Scenes, placed paths and machines of the runs by content hash.

        Raises `InputError` if one cannot be loaded, or all of a path would be warm-up.
        """
        for block in self._blocks:
            self._inputs.load(block.grid.occupied("scene", "trace"))
        for trace in self._inputs.loaded.values():
            if isinstance(trace, CameraTrace):
                require_window(self._warmup_s, trace.duration_s)
        return self._inputs.loaded

    def runs(self) -> Iterator[Run]:
        """Yield the runs, one policy after the other; raises `InputError` as `inputs`."""
        for case in self.cases():
            yield case.run

    def run_list(self, cases: Iterable[Case] | None = None) -> RunList:
        """Return the runs, or some of them, with their digests and their columns of results.

        Raises `InputError` as `inputs`, if all runs are excluded or two are the same, if parameters
        do not go together, or if a policy was typed where it has no source to tell it by.
        """
        cases = tuple(self.cases() if cases is None else cases)
        for policy in {case.run.owner: case.run.policy for case in cases}.values():
            policy.check_parameters()
        names = ["policy", *(name for name in self.axes if name not in COLUMNS)]
        columns = {
            BASE_POLICY if name == "policy" else name: [case.cells.get(name) for case in cases]
            for name in names
        }
        if not cases:
            raise InputError("study: expected runs, got none but excluded ones; exclude fewer")
        try:
            return RunList(tuple(case.run for case in cases), self._inputs.names, columns)
        except TypeError as error:
            message = f"policy: expected a class with a source, got none: {error}; put it in a file"
            raise InputError(message) from error

    def run(
        self,
        *,
        out: str | Path | None = None,
        workers: int = 0,
        scheduler: str | None = None,
        limits: Limits | None = None,
        overwrite: bool = False,
        progress: Progress | None = None,
    ) -> "StudyResults":
        """Carry out the runs, or what is missing of them, and return what became of each.

        A policy that fails in a run fails in that run alone.

        Raises `InputError` as `run_list`, or if the folder holds something else.

        Parameters
        ----------
        out
            Folder of the results; runs that it holds are not repeated.  None keeps them in memory.
        workers
            Processes; 0 for as many as there are processors.
        scheduler
            Address of a Dask scheduler in place of this machine.
        limits
            What a policy may take.
        overwrite
            Whether another study in the folder is replaced.
        progress
            Called with the runs done and the runs in all.
        """
        from .sweep.carry_out import carry_out, carry_out_in

        runs = self.run_list()
        engine = open_engine(self.inputs, workers=workers, limits=limits, scheduler=scheduler)
        if out is None:
            return carry_out(self.name, runs, engine, progress)
        return carry_out_in(Path(out), runs, engine, overwrite=overwrite, progress=progress)

    def cases(self) -> Iterator[Case]:
        """Yield each run with its place on the axes; raises `InputError` as `inputs`."""
        self.inputs  # noqa: B018 - loads what the runs name
        for block in self._blocks:
            yield from block.cases(block.grid)

    def kinds(self) -> Iterator[tuple[int, Case]]:
        """Yield for each policy in each scene how many runs it has, and the middle one.

        Raises `InputError` as `inputs`.
        """
        self.inputs  # noqa: B018 - loads what the runs name
        for block in self._blocks:
            for count, at in block.grid.middles("scene"):
                (case,) = block.cases([at])
                yield count, case


def _exclusions(given: Exclude) -> Exclusions:
    """Return exclusions with the values of each axis as a tuple; ``mean`` is no draw."""
    excluded: list[dict[str, tuple[Cell, ...]]] = []
    for exclusion in given:
        cells = {name: several(values) for name, values in exclusion.items()}
        if "draw" in cells:
            cells["draw"] = tuple(None if draw == "mean" else draw for draw in cells["draw"])
        excluded.append(cells)
    return excluded
