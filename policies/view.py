"""What a policy sees of one frame: read-only, and never the future."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import BoolArray, FloatArray, IntArray
from ..models.machine.cost_terms.term import Pass
from ..models.scene.camera import Camera, area_of_spheres, eccentricity_deg
from ..models.scene.motion import Placed
from ..models.scene.nodes import Lens, Nodes, per_node
from ..models.scene.rig import Rig
from ..models.scene.scene import Scene
from .frame_times import Completed
from .selection import Selection

_ROUND = np.array((0, 1, 2, 0, 1))  # x, y, z and once more: a cross product of whole rows


@dataclass(frozen=True, slots=True)
class FrameState:
    """What one frame's views are computed from; built by whoever drives the policy.

    Attributes
    ----------
    scene : Scene
    camera : Camera
    centers : Placed
        Where the centres of all bounding spheres are at this frame's time.
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
    previous_centers : Placed or None
        Centres in the last frame; None where no node moves.
    last_placed : (Nodes, (3, m) float64) or None
        Candidates of the last frame, and where they were in its camera's frame.
    rig : Rig or None
        The cameras where several look at once, of which `camera` is the head or the first.
    """

    scene: Scene
    camera: Camera
    centers: Placed
    frame: int
    time_ns: int
    last_detail: FloatArray
    completed: Completed
    inside: BoolArray
    previous: Selection | None = None
    previous_camera: Camera | None = None
    step_s: float = 0.0
    residency: BoolArray | None = None
    previous_centers: Placed | None = None
    last_placed: tuple[Nodes, FloatArray] | None = None
    rig: Rig | None = None

    @property
    def centers_m(self) -> FloatArray:
        """Centres of the bounding spheres of all nodes at this frame's time, (3, N), read-only."""
        return self.centers.all_m

    def view(self, ids: IntArray, xyz_m: FloatArray, nodes: Nodes | None = None) -> "View":
        """Return the view of some nodes, see `View`: a `RigView` where several cameras look."""
        if self.rig is None:
            return View(self, ids, xyz_m, nodes)
        from .rig_view import RigView  # which is a view itself

        return RigView(self, ids, xyz_m, nodes)


class View:
    """Candidates of one frame and what can be known about them.

    Per-node arrays are read-only, aligned with `ids` and computed when first asked for.

    Attributes
    ----------
    ids : (m,) int32
        Flat scenes: nodes whose bounding sphere meets the frustum.  Trees: the roots that do.
    xyz_m : (3, m) float64
        Right, up and forward coordinates of the bounding spheres' centres in the camera's frame.
    state : FrameState
        What the view is computed from.
    nodes : Nodes
        The candidates and what is the same of them in every frame; shared by frames that have the
        same candidates.
    scene, camera, frame, time_ns, completed, previous
        Those of the state.
    """

    def __init__(
        self, state: FrameState, ids: IntArray, xyz_m: FloatArray, nodes: Nodes | None = None
    ) -> None:
        self.state = state
        self.ids = ids
        self.nodes = nodes or Nodes(state.scene, ids)
        self.xyz_m = xyz_m
        self.scene, self.camera = state.scene, state.camera
        self.frame, self.time_ns = state.frame, state.time_ns
        self.completed, self.previous = state.completed, state.previous

    def __len__(self) -> int:
        """Return the number of candidates."""
        return len(self.ids)

    def at(self, ids: IntArray) -> "View":
        """Return the same frame seen at other nodes, such as children of the roots."""
        nodes = Nodes(self.state.scene, ids)
        points_m = self.state.centers_m.take(nodes.at, axis=1)
        return self.state.view(ids, self.camera.to_camera(points_m), nodes)

    @property
    def viewport_px(self) -> float:
        """Pixels of the viewport, of all cameras' together where several look."""
        return float(self.camera.viewport_px)

    @property
    def passes(self) -> tuple[Pass, ...]:
        """What each camera draws, and where it sees it; here the only one draws all."""
        return (Pass(np.ones(len(self.ids), dtype=np.bool_), self),)

    @property
    def areas_px(self) -> tuple[FloatArray, ...]:
        """`area_px` in each camera's picture alone, (m,) each."""
        return (self.area_px,)

    @per_node
    def type_index(self) -> IntArray:
        """Type of each node, (m,)."""
        return self.nodes.type_index

    @per_node
    def radius_m(self) -> FloatArray:
        """Radius of each bounding sphere, (m,)."""
        return self.nodes.radius_m

    @property
    def lens(self) -> Lens:
        """What the nodes are in the camera's lens."""
        camera = self.camera
        return self.nodes.in_lens(camera.focal_px, camera.near_m)

    @per_node
    def distance_m(self) -> FloatArray:
        """Distance from the eye to each bounding sphere's centre, (m,)."""
        return np.sqrt(self._squares_m2[3])

    @per_node
    def _squares_m2(self) -> FloatArray:
        """Return the squares of coordinates, and last of distances, (4, m)."""
        xyz_m = self.xyz_m
        squares = np.empty((4, xyz_m.shape[1]))
        np.multiply(xyz_m, xyz_m, out=squares[:3])
        np.add.reduce(squares[:3], axis=0, out=squares[3])
        return squares

    @per_node
    def nearest_m(self) -> FloatArray:
        """Distance to each bounding sphere's surface, never below the near plane, (m,)."""
        gap = self.distance_m - self.lens.radius_m
        return np.maximum(gap, self.camera.near_m, out=gap)

    def px_per_m_at(self, at: NDArray[np.intp]) -> FloatArray:
        """Return pixels of one metre before scale at the nearest points of some spheres, (c,)."""
        lens = self.lens
        gap = self.distance_m.take(at)
        gap -= lens.radius_m.take(at)
        np.maximum(gap, self.camera.near_m, out=gap)
        return np.divide(lens.scale_px.take(at), gap, out=gap)

    @per_node
    def area_px(self) -> FloatArray:
        """Projected area of each bounding sphere, at most the viewport's, (m,)."""
        lens = self.lens
        gaps_m2 = self._squares_m2[2:] - lens.square_m2  # of depths and of distances
        near = self.xyz_m[2] <= lens.reach_m
        return area_of_spheres(
            gaps_m2[0], gaps_m2[1], lens.disc, near, float(self.camera.viewport_px)
        )

    @per_node
    def inside_share(self) -> FloatArray:
        """Share of each sphere's box in the picture that lies within the viewport, (m,).

        A sphere that reaches the near plane has no such box, and counts half.
        """
        camera, radius = self.camera, self.radius_m
        depth = np.maximum(self.xyz_m[2], camera.near_m)
        half = radius * camera.focal_px / depth
        share = np.ones(len(self.ids))
        for axis, side_px in ((0, camera.width_px), (1, camera.height_px)):
            middle = self.xyz_m[axis] * camera.focal_px / depth
            edge = side_px / 2.0
            length = np.minimum(middle + half, edge) - np.maximum(middle - half, -edge)
            share *= np.clip(length / (2.0 * half), 0.0, 1.0)
        share[self.xyz_m[2] - radius <= camera.near_m] = 0.5
        return share

    @per_node
    def covered_px(self) -> FloatArray:
        """Pixels that each node should cover of its disc in the viewport, (m,)."""
        camera, radius = self.camera, self.radius_m
        limit = float(camera.viewport_px)
        gap = np.maximum(self.xyz_m[2] ** 2 - radius**2, 1e-30)
        seen_px = self.inside_share * (math.pi * (camera.focal_px * radius) ** 2 / gap)
        np.minimum(seen_px, limit, out=seen_px)
        seen_px[self.xyz_m[2] - radius <= camera.near_m] = limit
        return self.state.scene.types.disc_share.take(self.nodes.type_at) * seen_px

    @per_node
    def eccentricity_deg(self) -> FloatArray:
        """Angle between the view axis and each centre, (m,)."""
        return eccentricity_deg(self.xyz_m[2], self.distance_m)

    @per_node
    def speed_deg_s(self) -> FloatArray:
        """Apparent angular speed of each centre since the last frame, (m,); 0 in the first."""
        before, step_s = self.state.previous_camera, self.state.step_s
        if before is None or step_s <= 0.0:
            return np.zeros(len(self.ids))
        last = self.state.last_placed
        if last is not None and last[0] is self.nodes:
            old = last[1]
        else:
            centers = self.state.previous_centers or self.state.centers
            old = before.to_camera(centers.all_m.take(self.nodes.at, axis=1))
        angle = _angle(old.take(_ROUND, axis=0), self.xyz_m.take(_ROUND, axis=0))
        angle *= math.degrees(1.0) / step_s
        return angle

    @per_node
    def previous_detail(self) -> FloatArray:
        """Detail at which each node was last drawn, NaN if never, (m,)."""
        return self.state.last_detail.take(self.nodes.at)

    @per_node
    def inside(self) -> BoolArray:
        """Whether each bounding sphere meets the frustum, (m,); nodes outside are never drawn."""
        return self.state.inside.take(self.nodes.at)

    @per_node
    def resident(self) -> BoolArray:
        """Whether each node's data are in memory, (m,)."""
        everything = self.state.residency
        if everything is None:
            return np.ones(len(self.ids), dtype=np.bool_)
        return everything.take(self.nodes.at)


def _angle(old: FloatArray, new: FloatArray) -> FloatArray:
    """Return the angles between directions whose rows are x, y, z, x, y, (5, m) each, (m,)."""
    # The length of the cross product keeps the digits of small angles.
    cross = old[1:4] * new[2:]
    cross -= old[2:] * new[1:4]
    cross *= cross
    sine = np.add.reduce(cross, axis=0)
    np.sqrt(sine, out=sine)
    cosine = np.einsum("ij,ij->j", old[:3], new[:3])
    return np.arctan2(sine, cosine, out=sine)
