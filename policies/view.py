"""What a policy sees of one frame: read-only, and never the future."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from ..models.arrays import BoolArray, FloatArray, IntArray
from ..models.camera import Camera, eccentricity_deg, projected_area_px
from ..models.scene import Scene
from .selection import Selection

__all__ = ["Completed", "FrameState", "View"]

_Array = TypeVar("_Array", bound=NDArray[Any])


class Completed:
    """Measured times of the frames whose measurement has reached the CPU so far, oldest first.

    Attributes
    ----------
    frame : (n,) int64
    cpu_ms, gpu_ms, work_ms : (n,) float64
        Work times as a timer reports them, faults included; work is the larger of the two.
    present_ms : (n,) float64
        Interval to the previous displayed frame, which vsync quantises; NaN if not displayed yet.
    """

    __slots__ = ("_count", "_times")

    def __init__(self, times: FloatArray, count: int) -> None:
        """Wrap the first `count` rows of (n, 4) times: cpu, gpu, work, present."""
        self._times = times.view()
        self._times.flags.writeable = False
        self._count = count

    def __len__(self) -> int:
        """Return the number of completed frames."""
        return self._count

    @property
    def frame(self) -> IntArray:
        """Frame indices, (n,)."""
        return np.arange(self._count, dtype=np.int32)

    @property
    def cpu_ms(self) -> FloatArray:
        """CPU time of each frame."""
        return self._times[: self._count, 0]

    @property
    def gpu_ms(self) -> FloatArray:
        """GPU time of each frame."""
        return self._times[: self._count, 1]

    @property
    def work_ms(self) -> FloatArray:
        """Larger of CPU and GPU time of each frame."""
        return self._times[: self._count, 2]

    @property
    def present_ms(self) -> FloatArray:
        """Interval between presents that each frame ended."""
        return self._times[: self._count, 3]

    def last_work_ms(self) -> float:
        """Return the newest work time, or NaN before any frame has completed."""
        return float(self._times[self._count - 1, 2]) if self._count else math.nan


@dataclass(frozen=True, slots=True)
class FrameState:
    """What one frame's views are computed from; built by whoever drives the policy.

    Attributes
    ----------
    scene : Scene
    camera : Camera
    centers_m : (3, N) float64
        Centres of the bounding spheres of all nodes at this frame's time.
    frame : int
    time_ns : int
        Simulated time at which the input was sampled.
    last_detail : (N,) float64
        Detail at which each node was last drawn; NaN if never.
    completed : Completed
    inside : (N,) bool
        Nodes whose bounding sphere meets the frustum; valid during this frame.
    previous : Selection or None
        The policy's own last selection.
    previous_camera : Camera or None
        Camera of the last frame, `step_s` seconds earlier.
    residency : (N,) bool or None
        Nodes whose data are in memory; None where nothing is streamed.
    previous_centers_m : (3, N) float64 or None
        Centres in the last frame; None where no node moves.
    """

    scene: Scene
    camera: Camera
    centers_m: FloatArray
    frame: int
    time_ns: int
    last_detail: FloatArray
    completed: Completed
    inside: BoolArray
    previous: Selection | None = None
    previous_camera: Camera | None = None
    step_s: float = 0.0
    residency: BoolArray | None = None
    previous_centers_m: FloatArray | None = None


class _PerNode(Generic[_Array]):
    """An array that is computed when first asked for, then kept, read-only.

    `functools.cached_property` takes a lock at that time in Python 3.11, which costs more than
    some of these arrays.
    """

    def __init__(self, compute: Callable[[Any], _Array]) -> None:
        self._compute, self._name = compute, compute.__name__
        self.__doc__ = compute.__doc__

    @overload
    def __get__(self, view: None, owner: type) -> "_PerNode[_Array]": ...
    @overload
    def __get__(self, view: "View", owner: type) -> _Array: ...
    def __get__(self, view: "View | None", owner: type) -> "_PerNode[_Array] | _Array":
        if view is None:
            return self
        array = self._compute(view)
        array.flags.writeable = False
        view.__dict__[self._name] = array  # found before this descriptor from now on
        return array


class View:
    """Candidates of one frame and what can be known about them.

    Per-node arrays are read-only, aligned with `ids` and computed when first asked for.

    Attributes
    ----------
    ids : (m,) int32
        Flat scenes: nodes whose bounding sphere meets the frustum.  Trees: the roots that do.
    xyz_m : (3, m) float64
        Right, up and forward coordinates of the bounding spheres' centres in the camera's frame.
    """

    def __init__(self, state: FrameState, ids: IntArray, xyz_m: FloatArray) -> None:
        self.state = state
        self.ids = ids
        self.xyz_m = xyz_m

    def __len__(self) -> int:
        """Return the number of candidates."""
        return len(self.ids)

    def at(self, ids: IntArray) -> "View":
        """Return the same frame seen at other nodes, such as children of the roots."""
        return View(self.state, ids, self.camera.to_camera(self.state.centers_m.take(ids, axis=1)))

    @property
    def scene(self) -> Scene:
        """The scene of the replay."""
        return self.state.scene

    @property
    def camera(self) -> Camera:
        """The camera at the time of input."""
        return self.state.camera

    @property
    def frame(self) -> int:
        """Index of the frame, from 0."""
        return self.state.frame

    @property
    def time_ns(self) -> int:
        """Simulated time at which the input was sampled."""
        return self.state.time_ns

    @property
    def completed(self) -> Completed:
        """Times of the frames completed so far."""
        return self.state.completed

    @property
    def previous(self) -> Selection | None:
        """The policy's own last selection."""
        return self.state.previous

    @_PerNode
    def type_index(self) -> IntArray:
        """Type of each node, (m,)."""
        return self.state.scene.type_index.take(self.ids)

    @_PerNode
    def radius_m(self) -> FloatArray:
        """Radius of each bounding sphere, (m,)."""
        return self.state.scene.radius_m.take(self.ids)

    @_PerNode
    def distance_m(self) -> FloatArray:
        """Distance from the eye to each bounding sphere's centre, (m,)."""
        x, y, z = self.xyz_m
        square = x * x
        square += y * y
        square += z * z
        return np.sqrt(square, out=square)

    @_PerNode
    def nearest_m(self) -> FloatArray:
        """Distance to each bounding sphere's surface, never below the near plane, (m,)."""
        gap = self.distance_m - self.radius_m
        return np.maximum(gap, self.camera.near_m, out=gap)

    @_PerNode
    def area_px(self) -> FloatArray:
        """Projected area of each bounding sphere, at most the viewport's, (m,)."""
        return projected_area_px(self.xyz_m[2], self.distance_m, self.radius_m, self.camera)

    @_PerNode
    def eccentricity_deg(self) -> FloatArray:
        """Angle between the view axis and each centre, (m,)."""
        return eccentricity_deg(self.xyz_m[2], self.distance_m)

    @_PerNode
    def speed_deg_s(self) -> FloatArray:
        """Apparent angular speed of each centre since the last frame, (m,); 0 in the first."""
        before, step_s = self.state.previous_camera, self.state.step_s
        if before is None or step_s <= 0.0:
            return np.zeros(len(self.ids))
        centers_m = self.state.previous_centers_m
        if centers_m is None:
            centers_m = self.state.centers_m
        old = before.to_camera(centers_m.take(self.ids, axis=1))
        sine = np.linalg.norm(np.cross(old, self.xyz_m, axis=0), axis=0)
        cosine = np.einsum("ij,ij->j", old, self.xyz_m)
        return np.degrees(np.arctan2(sine, cosine)) / step_s

    @_PerNode
    def previous_detail(self) -> FloatArray:
        """Detail at which each node was last drawn, NaN if never, (m,)."""
        return self.state.last_detail.take(self.ids)

    @_PerNode
    def inside(self) -> BoolArray:
        """Whether each bounding sphere meets the frustum, (m,); nodes outside are never drawn."""
        return self.state.inside.take(self.ids)

    @_PerNode
    def resident(self) -> BoolArray:
        """Whether each node's data are in memory, (m,)."""
        everything = self.state.residency
        if everything is None:
            return np.ones(len(self.ids), dtype=np.bool_)
        return everything.take(self.ids)
