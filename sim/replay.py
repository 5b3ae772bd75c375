"""Replay of a camera trace through the pipeline under one policy."""

import math
from array import array
from dataclasses import dataclass, field, replace

import numpy as np

from ..base.arrays import BoolArray, FloatArray
from ..base.errors import InputError, PolicyError
from ..models.machine.hardware import HardwareProfile
from ..models.scene.camera import Camera
from ..models.scene.frustum import Culler
from ..models.scene.scene import Scene
from ..models.scene.tree import Tree
from ..policies.protocol import Oracle, Policy, Truth
from ..policies.selection import Selection, find_violation
from ..policies.view import FrameState, View
from ..traces.cameras.camera_trace import CameraTrace
from .accounting.accounting import Accounting
from .accounting.benefit_bound import BenefitBound
from .accounting.extraction import IndexSets
from .accounting.fronts import Fronts
from .accounting.quality import FlatQuality, TreeQuality, screen_errors
from .faults import Faults
from .frame_log import COUNTS, TIMES, FrameLog, LogHeader
from .frame_timer import FrameTimer
from .loader import find_not_resident, make_memory
from .pipeline import Pipeline
from .simulated_machine import Machine, SimulatedMachine, Submitted

_NS_PER_MS = 1e6
_MAX_FRAMES = 10_000_000
_PACE_FRAMES = 10_000
_LEAST_FRAME_NS = 1_000  # a million frames a second: no machine, but a profile without a base cost


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayOptions:
    """How to replay.

    Attributes
    ----------
    budget_ms : float
        Time that a frame may take; what policies aim at.
    seed : int
        Root of all noise; the noise of frame k is the same under every policy.
    frames : int or None
        Frames to render; None for as long as the trace lasts.
    fovy_deg : float
        Vertical field of view.
    crossfade_ms : float
        Time for which a switched node is drawn at both levels.
    measurement_delay : int
        Frames, beyond its completion, until a frame's timer is read (GPU timer queries).
    faults : Faults
        What the timers get wrong.
    bound_every : int
        Compute the bound behind `optimality` in every so many frames, 0 for never; flat scenes
        only.  Frames of an oracle always have it.
    draw : int or None
        Posterior draw that plays the truth; None for the profile's mean.
    memory_bytes : float or None
        Bound of the loader; None for the profile's.
    """

    budget_ms: float
    seed: int = 0
    frames: int | None = None
    fovy_deg: float = 60.0
    crossfade_ms: float = 0.0
    measurement_delay: int = 0
    faults: Faults = field(default_factory=Faults)
    bound_every: int = 0
    draw: int | None = None
    memory_bytes: float | None = None

    def __post_init__(self) -> None:
        if not (math.isfinite(self.budget_ms) and self.budget_ms > 0.0):
            raise InputError(f"budget: expected milliseconds > 0, got {self.budget_ms}")
        if self.frames is not None and not 1 <= self.frames <= _MAX_FRAMES:
            raise InputError(f"frames: expected 1 to {_MAX_FRAMES}, got {self.frames}")
        if not (math.isfinite(self.crossfade_ms) and self.crossfade_ms >= 0.0):
            raise InputError(f"crossfade: expected milliseconds >= 0, got {self.crossfade_ms}")
        if not 0 <= self.measurement_delay <= 16:
            raise InputError(
                f"measurement delay: expected 0 to 16 frames, got {self.measurement_delay}"
            )
        if self.memory_bytes is not None and not 0.0 < self.memory_bytes < math.inf:
            raise InputError(f"memory: expected bytes > 0, got {self.memory_bytes}")
        if self.bound_every < 0:
            raise InputError(f"bound_every: expected frames >= 0, got {self.bound_every}")
        if self.seed < 0:
            raise InputError(f"seed: expected an integer >= 0, got {self.seed}")


def replay(
    policy: Policy,
    scene: Scene,
    trace: CameraTrace,
    hardware: HardwareProfile,
    options: ReplayOptions,
    *,
    name: str,
    machine: Machine | None = None,
) -> FrameLog:
    """Replay `trace` through `scene` on `hardware` under `policy`; return its frame log.

    The replay ends with the trace or after `options.frames` frames.  The same arguments give the
    same bytes, unless a `machine` that measures stands in for the simulated one.

    Raises
    ------
    PolicyError
        If the policy raises or a selection breaks its contract.
    """
    source = _Source(policy, scene, trace, hardware, options, name, machine)
    pipeline = Pipeline(source, hardware.display, hardware.frames_in_flight)
    source.attach(pipeline)
    pipeline.run()
    return source.log(pipeline)


class _Source:
    """Decides, counts and prices each frame when the pipeline begins it."""

    def __init__(
        self,
        policy: Policy,
        scene: Scene,
        trace: CameraTrace,
        hardware: HardwareProfile,
        options: ReplayOptions,
        name: str,
        machine: Machine | None,
    ) -> None:
        self._policy, self._name = policy, name
        self._oracle = policy if isinstance(policy, Oracle) and policy.capabilities.future else None
        self._scene = scene.with_costs(hardware.gpu)
        self._trace, self._hardware, self._options = trace, hardware, options
        self._end_ns = round(trace.duration_s * 1e9)
        self._fovy_rad = math.radians(options.fovy_deg)
        self._rest_m = np.ascontiguousarray(scene.center_m.T)
        self._rest_m.flags.writeable = False
        self._culler = Culler(scene.radius_m, scene.cells)
        truth, scatter = hardware.truth(options.draw)
        crossfade_ns = round(options.crossfade_ms * _NS_PER_MS)
        self._accounting = Accounting(scene, truth, crossfade_ns, self._camera(0.0))
        self._tree = None if scene.flat else Tree(scene)
        if self._tree is None:
            self._fronts, self._quality = None, FlatQuality(scene)
        else:
            self._fronts = Fronts(self._tree, self._accounting.viewport_px)
            self._quality = TreeQuality(self._tree)
        every = 1 if policy.capabilities.future else options.bound_every
        self._bound = BenefitBound(self._scene, truth, every)
        self._index_sets = IndexSets(scene)
        streaming = policy.capabilities.loader and not scene.flat
        self._bound_bytes = options.memory_bytes or hardware.memory_bytes
        self._memory = make_memory(scene, hardware, self._bound_bytes, streaming=streaming)
        self._loaded_bytes = 0
        gpu, cpu, dice = np.random.SeedSequence(options.seed).spawn(3)
        self._machine = machine or SimulatedMachine(hardware, truth, scatter, (gpu, cpu))
        self._timer = FrameTimer(options.faults, options.measurement_delay, dice)
        self._counts = array("d")
        self._previous: Selection | None = None
        self._previous_camera: Camera | None = None
        self._previous_centers_m: FloatArray | None = None
        self._previous_s = 0.0
        self._pace_ns = 0
        try:
            policy.reset(self._scene, options.budget_ms)
        except (Exception, SystemExit) as error:
            raise PolicyError(name, None, _describe(error)) from error

    def attach(self, pipeline: Pipeline) -> None:
        """Take times of completed frames from this pipeline, and read on its clock."""
        self._timer.attach(pipeline)
        self._memory.attach(pipeline.events)

    def begin(self, frame: int, time_ns: int) -> tuple[int, int] | None:
        """Select, count and price one frame (see `FrameSource`)."""
        if frame == self._options.frames or (self._options.frames is None and self._over(time_ns)):
            self._memory.stop()
            return None
        if frame % _PACE_FRAMES == 0:
            self._check_pace(frame, time_ns)
        time_s = time_ns * 1e-9
        camera = self._camera(time_s)
        centers_m = self._centers(time_s)
        ids, xyz_m = self._culler.cull(centers_m, camera)
        state = FrameState(
            self._scene,
            camera,
            centers_m,
            frame,
            time_ns,
            self._accounting.switches.detail,
            self._timer.completed(),
            self._culler.inside,
            self._previous,
            self._previous_camera,
            time_s - self._previous_s,
            self._memory.resident,
            self._previous_centers_m,
        )
        view = View(state, ids, xyz_m)
        if self._tree is not None:
            roots = self._scene.roots
            view = view.at(roots[self._culler.inside[roots]])
        selection = self._select(view, self._machine.begin())
        self._previous, self._previous_camera = selection, camera
        self._previous_s, self._previous_centers_m = time_s, centers_m
        costs_ns = self._record(view, selection)
        self._memory.want(time_ns, selection.wanted)
        return costs_ns

    def _check_pace(self, frame: int, time_ns: int) -> None:
        """Refuse a machine on which frames take no time: the end of the trace would never come."""
        if frame and time_ns - self._pace_ns < _PACE_FRAMES * _LEAST_FRAME_NS:
            raise InputError(
                f"hardware {self._hardware.name}: expected frames that take time, got "
                f"{_PACE_FRAMES} in {(time_ns - self._pace_ns) * 1e-6:.3g} ms; give the profile a "
                "base cost, or limit the number of frames"
            )
        self._pace_ns = time_ns

    def _over(self, time_ns: int) -> bool:
        return time_ns > self._end_ns

    def _camera(self, time_s: float) -> Camera:
        pose = self._trace.pose_at(time_s)
        display = self._hardware.display
        return Camera(
            pose.position_m,
            pose.orientation_xyzw,
            display.width_px,
            display.height_px,
            self._fovy_rad,
        )

    def _centers(self, time_s: float) -> FloatArray:
        motion = self._scene.motion
        if motion is None:
            return self._rest_m
        centers_m = self._rest_m.copy()
        centers_m[:, motion.node] += motion.offset_m(time_s).T
        return centers_m

    def _select(self, view: View, truth: Truth | None) -> Selection:
        try:
            if self._oracle is not None and truth is not None:
                self._oracle.foresee(truth)
            selection = self._policy.select(view)
        except (Exception, SystemExit) as error:
            raise PolicyError(self._name, view.frame, _describe(error)) from error
        violation = find_violation(selection, view.ids, self._scene, self._tree)
        violation = violation or find_not_resident(selection, view)
        if violation is not None:
            raise PolicyError(self._name, view.frame, violation)
        return selection

    def _record(self, view: View, selection: Selection) -> tuple[int, int]:
        accounting = self._accounting
        if self._tree is not None:
            selection = _culled(selection, self._culler.inside)
        drawn = accounting.drawn(selection, view)
        switches = accounting.switches.record(view.frame, view.time_ns, drawn)
        if self._fronts is not None:
            switches += self._fronts.record(view.time_ns, drawn.ids, view)
        tally = accounting.tally(view.time_ns, drawn, selection.render_scale)
        share = selection.render_scale * selection.render_scale
        units = self._quality.units(view)
        quality = self._quality.score(drawn, units)
        sse_px_p95, sse_px_max = screen_errors(drawn)
        try:
            extraction = self._index_sets.record(selection, drawn)
        except ValueError as error:
            raise PolicyError(self._name, view.frame, str(error)) from error
        times = self._machine.run(Submitted(view, selection, drawn, tally, extraction))
        work, position = selection.work, view.camera.position_m
        loaded_bytes = self._memory.loaded_bytes - self._loaded_bytes
        self._loaded_bytes = self._memory.loaded_bytes
        self._counts.extend(tally.level_counts.tolist())
        self._counts.extend(
            (
                tally.shaded_samples,
                tally.rasterized_triangles,
                tally.state_changes,
                len(units.ids),
                len(drawn.ids),
                quality.missing,
                tally.fading,
                accounting.full_gpu_ms(units),
                tally.gpu_ms,
                selection.predicted_ms,
                times.cpu_ms,
                times.gpu_ms,
                times.select_ms,
                work.objects_visited,
                work.comparisons,
                work.iterations,
                extraction.levels,
                extraction.triangles,
                extraction.borrowed,
                switches.toggles,
                switches.reversals,
                switches.popping_px,
                sse_px_p95,
                sse_px_max,
                share * quality.benefit,
                quality.full_benefit,
                # The bound is that of pictures rendered at full size.
                self._bound.of(view, tally.gpu_ms) if share == 1.0 else math.nan,
                quality.degradation / share,
                quality.full_degradation,
                self._memory.memory_bytes,
                loaded_bytes,
                *position,
            )
        )
        cpu_ns, gpu_ns = round(times.cpu_ms * _NS_PER_MS), round(times.gpu_ms * _NS_PER_MS)
        return max(1, cpu_ns), max(1, gpu_ns)

    def log(self, pipeline: Pipeline) -> FrameLog:
        """Return the log of the finished replay."""
        options, hardware = self._options, self._hardware
        header = LogHeader(
            self._name,
            self._scene.name,
            self._trace.name,
            hardware.name,
            options.budget_ms,
            options.seed,
            hardware.display.mode,
            hardware.display.refresh_hz,
            self._bound_bytes,
            self._policy.capabilities.future,
        )
        columns = [np.frombuffer(getattr(pipeline, name), dtype=np.int64) for name in TIMES]
        times_ns = np.stack(columns, axis=1)
        np.maximum(times_ns, -1, out=times_ns)
        counts = np.frombuffer(self._counts, dtype=np.float64).reshape(-1, len(COUNTS))
        return FrameLog(header, times_ns, counts)


def _culled(selection: Selection, inside: BoolArray) -> Selection:
    """Return what is left of a front when its nodes outside the frustum are culled."""
    keep = inside[selection.ids]
    holder = None if selection.holder is None else selection.holder[keep]
    return replace(selection, ids=selection.ids[keep], detail=selection.detail[keep], holder=holder)


def _describe(error: BaseException) -> str:
    """Return an exception raised by a policy in one line."""
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
