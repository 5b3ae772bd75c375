"""The frames of a replay as one policy decides them: what the pipeline asks for, one by one."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import FloatArray
from ..base.errors import InputError, PolicyError
from ..base.foreign_text import describe_error
from ..models.machine.hardware import HardwareProfile
from ..models.scene.scene import Scene
from ..models.scene.tree import Tree
from ..policies.protocol import Clairvoyant, Policy, Truth
from ..policies.selection import Selection
from ..policies.view import FrameState, View
from ..traces.cameras.camera_trace import CameraTrace
from .frame_recorder import FrameRecorder
from .level_history import LevelRecorder
from .loader import make_memory
from .machine.frame_timer import FrameTimer
from .machine.simulated_machine import Machine, SimulatedMachine
from .pipeline.pipeline import Pipeline
from .replay_options import ReplayOptions
from .selection_check import SelectionCheck
from .sight import Seen, Sight

_PACE_FRAMES = 10_000
_LEAST_FRAME_NS = 1_000  # a million frames a second: no machine, but a profile without a base cost


class PolicyFrames:
    """Culls, shows and has the policy select each frame when the pipeline begins it."""

    def __init__(
        self,
        policy: Policy,
        scene: Scene,
        trace: CameraTrace,
        hardware: HardwareProfile,
        options: ReplayOptions,
        name: str,
        machine: Machine | None,
        beat: Callable[[int], None] | None,
        levels: LevelRecorder | None = None,
    ) -> None:
        self._policy, self._name, self._beat = policy, name, beat
        future = policy.capabilities.future
        self._oracle = policy if future and isinstance(policy, Clairvoyant) else None
        self._trace, self._hardware, self._options = trace, hardware, options
        self._end_ns = round(trace.duration_s * 1e9)
        sight = self._sight = Sight(scene, trace, hardware.display, options)
        self._scene = scene.with_costs(replace(hardware.gpu, passes=sight.passes))
        self._tree = None if scene.flat else Tree(scene)
        streaming = policy.capabilities.loader and not scene.flat
        bound_bytes = options.memory_bytes or hardware.memory_bytes
        self._memory = make_memory(scene, hardware, bound_bytes, streaming=streaming)
        truth, residual = hardware.truth(options.draw)
        truth = replace(truth, passes=sight.passes)
        gpu, cpu, dice = np.random.SeedSequence(options.seed).spawn(3)
        self._time_ns = 0  # at which the frame began
        self._machine = machine or SimulatedMachine(
            hardware, truth, residual, (gpu, cpu), lambda: self._time_ns
        )
        self._timer = FrameTimer(options.faults, options.measurement_delay, dice)
        self._recorder = FrameRecorder(
            self._scene,
            self._tree,
            truth,
            options,
            sight,
            self._machine,
            self._memory,
            policy=name,
            future=future,
            levels=levels,
        )
        self._check = SelectionCheck(self._scene, self._tree)
        self._previous: Selection | None = None
        self._seen: Seen | None = None
        self._previous_s = 0.0
        self._pace_ns = 0
        try:
            policy.reset(self._scene, options.budget_ms)
        except (Exception, SystemExit) as error:
            raise PolicyError(name, None, describe_error(error)) from error

    def attach(self, pipeline: Pipeline) -> None:
        """Take times of completed frames from this pipeline, and read on its clock."""
        self._timer.attach(pipeline)
        self._memory.attach(pipeline.events)

    def counts(self) -> FloatArray:
        """Return what was recorded of the frames so far (`FrameLog.counts`)."""
        return self._recorder.counts()

    def drawn_by_depth(self) -> NDArray[np.int64]:
        """Return nodes drawn of the frames so far (`FrameLog.drawn_by_depth`)."""
        return self._recorder.drawn_by_depth()

    def begin(self, frame: int, time_ns: int) -> tuple[int, int] | None:
        """Select, count and price one frame (see `FrameSource`)."""
        if frame == self._options.frames or (self._options.frames is None and self._over(time_ns)):
            self._memory.stop()
            return None
        if self._beat is not None:
            self._beat(frame)
        if frame % _PACE_FRAMES == 0:
            self._check_pace(frame, time_ns)
        self._time_ns = time_ns
        view = self._show(frame, time_ns)
        selection = self._select(view, self._machine.begin())
        self._previous, self._previous_s = selection, time_ns * 1e-9
        check = self._check
        costs_ns = self._recorder.record(
            view, selection, repeats=check.repeats, changed=check.changed
        )
        # What is wanted is read while the frame is drawn: the next one may have it, not this one.
        self._memory.want(time_ns, selection.wanted)
        return costs_ns

    def _show(self, frame: int, time_ns: int) -> View:
        time_s, sight, before = time_ns * 1e-9, self._sight, self._seen
        seen = self._seen = sight.look(time_s)
        state = FrameState(
            self._scene,
            seen.camera,
            seen.centers,
            frame,
            time_ns,
            self._recorder.last_detail,
            self._timer.completed(),
            sight.inside,
            self._previous,
            None if before is None else before.camera,
            time_s - self._previous_s,
            self._memory.resident,
            None if before is None else before.centers,
            None if before is None else (before.nodes, before.xyz_m),
            seen.rig,
        )
        view = state.view(seen.nodes.ids, seen.xyz_m, seen.nodes)
        if self._tree is None:
            return view
        roots = self._scene.roots
        return view.at(roots[sight.inside[roots]])

    def _check_pace(self, frame: int, time_ns: int) -> None:
        """Refuse a machine on which frames take so little time that the trace's end never comes."""
        if frame and time_ns - self._pace_ns < _PACE_FRAMES * _LEAST_FRAME_NS:
            raise InputError(
                f"hardware {self._hardware.name}: expected frames that take time, got "
                f"{_PACE_FRAMES} in {(time_ns - self._pace_ns) * 1e-6:.3g} ms; give the profile a "
                "base cost, or limit the number of frames"
            )
        self._pace_ns = time_ns
        if frame:
            # What was seen so far may be the quickest part: it has to end even at half its rate.
            expected = frame * self._end_ns / time_ns
            self._options.require_end(self._trace.name, max(0.5 * expected, frame))

    def _over(self, time_ns: int) -> bool:
        return time_ns > self._end_ns

    def _select(self, view: View, truth: Truth | None) -> Selection:
        try:
            if self._oracle is not None and truth is not None:
                self._oracle.foresee(truth)
            selection = self._policy.select(view)
        except (Exception, SystemExit) as error:
            raise PolicyError(self._name, view.frame, describe_error(error)) from error
        violation = self._check.find_violation(selection, view)
        if violation is not None:
            raise PolicyError(self._name, view.frame, violation)
        return selection
