"""What the cameras of a replay see: where they stand at a time, and which nodes are before them."""

import math
from typing import NamedTuple

import numpy as np

from ..base.arrays import FloatArray
from ..base.errors import InputError
from ..models.machine.hardware import Display
from ..models.scene.camera import Camera
from ..models.scene.frustum import Culler
from ..models.scene.motion import Centers, Placed
from ..models.scene.nodes import Nodes
from ..models.scene.rig import Eyes, Rig, RigCuller
from ..models.scene.scene import Scene
from ..traces.cameras.camera_trace import CameraTrace
from ..traces.cameras.shared_screen import split
from .replay_options import ReplayOptions


class Seen(NamedTuple):
    """What is seen at one time.

    Attributes
    ----------
    camera : Camera
        The only one, the head between two eyes, or the first player's.
    rig : Rig or None
        The cameras where several look at once.
    centers : Placed
    nodes : Nodes
        What any camera sees; the same object as before where they are the same.
    xyz_m : (3, m) float64
        Their centres in the frame of `camera`.
    """

    camera: Camera
    rig: Rig | None
    centers: Placed
    nodes: Nodes
    xyz_m: FloatArray


class Sight:
    """The cameras of one replay, and what they see frame by frame.

    Attributes
    ----------
    first : Camera
        The head, or the only camera, at the path's beginning; all have its lens.
    cameras, passes, players : int
        How many look at once, how many of them draw by themselves, and for how many players.
    inside : (N,) bool
        Nodes that any camera sees, read-only; the next look overwrites it.
    """

    def __init__(
        self, scene: Scene, trace: CameraTrace, display: Display, options: ReplayOptions
    ) -> None:
        """Raise InputError if players who share a screen are to have two eyes each."""
        self._scene, self._eyes = scene, options.eyes
        self._paths = split(trace)
        self._fovy_rad = math.radians(options.fovy_deg)
        self.players = self.cameras = self.passes = len(self._paths)
        if options.eyes is not None:
            if self.players > 1:
                raise InputError(
                    f"eyes: expected one player with two eyes, got {self.players} who share a "
                    "screen; leave out one of the two"
                )
            self.cameras = 2
            self.passes = 1 if options.eyes.single_pass else 2
        size_px = (display.width_px, display.height_px)
        self._size_px = picture_size(size_px, self.players, options.eyes)
        self.first = self._camera(self._paths[0], 0.0)
        self._centers = Centers(scene.center_m, scene.motion)
        cullers = [
            Culler(self._centers, scene.radius_m, scene.blocks, scene.cells)
            for _ in range(self.cameras)
        ]
        self._culler, self._rig_culler = cullers[0], None
        if self.cameras > 1:
            self._rig_culler = RigCuller(cullers)
        self.inside = (self._rig_culler or self._culler).inside
        self._nodes = Nodes(scene, np.zeros(0, dtype=np.int32))
        self._before: tuple[Camera, ...] = ()

    def look(self, time_s: float) -> Seen:
        """Return what is seen at a time; times are asked for in their order."""
        camera, centers = self._camera(self._paths[0], time_s), self._centers.at(time_s)
        if self._rig_culler is None:
            ids, xyz_m = self._culler.cull(centers, camera)
            if ids is not self._nodes.ids:
                self._nodes = Nodes(self._scene, ids, self._culler.at)
            return Seen(camera, None, centers, self._nodes, xyz_m)
        if self._eyes is None:
            others = (self._camera(path, time_s) for path in self._paths[1:])
            cameras = (camera, *others)
        else:
            cameras = self._eyes.of(camera)
        culler = self._rig_culler
        ids = culler.cull(centers, cameras)
        if ids is not self._nodes.ids:
            self._nodes = Nodes(self._scene, ids, culler.at)
        rig = Rig(cameras, self._before, culler.each)
        self._before = cameras
        xyz_m = camera.to_camera(centers.all_m.take(culler.at, axis=1))
        return Seen(camera, rig, centers, self._nodes, xyz_m)

    def _camera(self, path: CameraTrace, time_s: float) -> Camera:
        pose = path.pose_at(time_s)
        return Camera(pose.position_m, pose.orientation_xyzw, *self._size_px, self._fovy_rad)


def picture_size(screen_px: tuple[int, int], players: int, eyes: Eyes | None) -> tuple[int, int]:
    """Return width and height of each camera's picture on a screen.

    Of two players one is above the other, as in games; three and four have a quarter each.
    """
    width_px, height_px = screen_px
    if eyes is not None:
        return eyes.size_px or (width_px // 2, height_px)
    across, down = (1, players) if players < 3 else (2, 2)
    return width_px // across, height_px // down
