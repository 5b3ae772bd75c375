"""``predictive``: another policy, shown the pose that is expected when the frame is displayed."""

import math
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

from ...base.errors import InputError
from ...models.scene.camera import Camera
from ...models.scene.rig import Rig
from ...models.scene.scene import Scene
from ..knob import Knob, knob_of
from ..protocol import Capabilities, Claims, claims_of
from ..registry import parse_policy, vary_policy
from ..selection import Selection
from ..shared.ranges import Interval, Positive, check_parameters
from ..view import View

Quaternion = tuple[float, float, float, float]


def extrapolate(before: Camera, now: Camera, ahead: float) -> Camera:
    """Return the camera `ahead` times the step from `before` to `now` later.

    Velocity and turn rate stay those of the step.
    """
    ax, ay, az = before.position_m
    bx, by, bz = now.position_m
    position_m = (bx + ahead * (bx - ax), by + ahead * (by - ay), bz + ahead * (bz - az))
    orientation = _turn_on(before.orientation_xyzw, now.orientation_xyzw, ahead)
    return replace(now, position_m=position_m, orientation_xyzw=orientation)


def _near(before: Quaternion, now: Quaternion) -> tuple[Quaternion, float]:
    """Return `before` with the sign that is nearer to `now`, and half the turn between them."""
    if math.fsum(a * b for a, b in zip(before, now, strict=True)) < 0.0:
        x, y, z, w = before
        before = (-x, -y, -z, -w)
    # By the chord: the arc cosine has no digits left for small turns.
    return before, 2.0 * math.asin(0.5 * math.dist(before, now))


def _turn_on(before: Quaternion, now: Quaternion, ahead: float) -> Quaternion:
    """Return the orientation on the great arc from `before` to `now`, beyond it (slerp)."""
    before, half_rad = _near(before, now)
    sine = math.sin(half_rad)
    if sine == 0.0:
        return now
    a, b = -math.sin(ahead * half_rad) / sine, math.sin((1.0 + ahead) * half_rad) / sine
    x, y, z, w = (a * p + b * q for p, q in zip(before, now, strict=True))
    norm = math.hypot(x, y, z, w)
    return x / norm, y / norm, z / norm, w / norm


# Without slots: an instance has the capabilities and the knob of the policy that it wraps.
@dataclass
class Predictive:
    """Idea: let any policy decide on the pose at which its frame will be seen.

    The pose is extrapolated from the last two frames with constant velocity and turn rate.  The
    candidates are those of the frustum as it is; objects that move are not extrapolated.  The
    expected lag is the mean interval between frames, times the frames whose times are not known yet
    and one more; where timers are read long after completion this is too far, and `horizon_ms`
    sets it.  A step faster than the limits is taken for a cut and not continued.

    The policy and its parameters are written with a plus where a command line has a colon or a
    comma: ``predictive:policy=funkhouser+mode=greedy+skip=on``.

    Uses: poses of this and the last frame, number of frames under way; and what the policy uses.

    Parameters: as below.

    Cost per frame: that of the policy, and another projection of the candidates.

    Reference: lag and its compensation by prediction after Wloka, "Lag in multiprocessor virtual
    reality", Presence 1995; Zach's policies of 2002 predict poses for levels prepared ahead.
    """

    policy: str = "funkhouser"  # ours: the policy that a late pose hurts most is a predictive one
    horizon_ms: Annotated[float, Interval("[0, inf)")] | None = None  # None: by frames under way
    max_speed_m_s: Positive = 50.0  # ours: faster is a cut
    max_turn_deg_s: Positive = 720.0  # ours: faster is a cut
    setting: float | None = None  # of the policy's own knob; None: as the policy has it

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True, hierarchy=True)
    knob: ClassVar[Knob | None] = None  # an instance has that of its policy, if there is one

    def __post_init__(self) -> None:
        name, plus, given = self.policy.partition("+")
        spec = parse_policy(name + plus.replace("+", ":") + given.replace("+", ","))
        knob = knob_of(spec)
        if self.setting is not None:
            if knob is None:
                raise InputError(f"predictive: expected no setting, as {name} has no knob")
            spec = vary_policy(spec, {knob.name: self.setting})
        self._inner = spec.make()
        if self._inner.capabilities.future:
            raise InputError(f"predictive: expected a policy that sees no future, got {name}")
        self.__dict__["capabilities"] = self._inner.capabilities
        self.__dict__["knob"] = None if knob is None else replace(knob, name="setting")

    @property
    def claims(self) -> Claims:
        """That it comes to rest if the policy does; the rest holds for another pose."""
        frames = claims_of(self._inner).settles_frames
        return Claims(settles_frames=None if frames is None else frames + 1)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and reset the policy."""
        check_parameters(self, "predictive")
        self._inner.reset(scene, budget_ms)
        self._step_s = math.nan
        self._before: Camera | None = None
        self._all_before: tuple[Camera, ...] = ()

    def select(self, view: View) -> Selection:
        """Return what the policy selects on the predicted pose."""
        state = view.state
        camera = self._predict(view)
        seen = replace(state, camera=camera, previous_camera=self._before, rig=self._ahead(view))
        self._before = camera
        xyz_m = camera.to_camera(state.centers_m.take(view.ids, axis=1))
        return self._inner.select(seen.view(view.ids, xyz_m))

    def _predict(self, view: View) -> Camera:
        before, now, step_s = view.state.previous_camera, view.camera, view.state.step_s
        if before is None or step_s <= 0.0:
            return now
        self._step_s = step_s if math.isnan(self._step_s) else self._step_s
        self._step_s += (step_s - self._step_s) / 8.0  # a mean over some eight frames
        return self._go_on(before, now, view)

    def _go_on(self, before: Camera, now: Camera, view: View) -> Camera:
        """Return where a camera will be; where it is if it jumped there."""
        step_s = view.state.step_s
        speed_m_s = math.dist(before.position_m, now.position_m) / step_s
        _, half_rad = _near(before.orientation_xyzw, now.orientation_xyzw)
        turn_deg_s = math.degrees(2.0 * half_rad) / step_s
        if speed_m_s > self.max_speed_m_s or turn_deg_s > self.max_turn_deg_s:
            return now
        return extrapolate(before, now, self._horizon_s(view) / step_s)

    def _ahead(self, view: View) -> Rig | None:
        """Return where each camera will be, and was to be in the last frame, where several look."""
        rig = view.state.rig
        if rig is None:
            return None
        ahead, before = rig.cameras, self._all_before
        if rig.previous and view.state.step_s > 0.0:
            pairs = zip(rig.previous, rig.cameras, strict=True)
            ahead = tuple(self._go_on(*pair, view) for pair in pairs)
        self._all_before = ahead
        return replace(rig, cameras=ahead, previous=before)

    def _horizon_s(self, view: View) -> float:
        if self.horizon_ms is not None:
            return 1e-3 * self.horizon_ms
        return (view.frame - len(view.completed) + 1) * self._step_s
