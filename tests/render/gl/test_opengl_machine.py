"""The machine that measures: medians, warm-up, steps, and policies that hear what was measured."""

from collections.abc import Callable, Iterator
from typing import Any, ClassVar

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.bounds.full import Full
from lodbench.policies.protocol import Capabilities, Policy
from lodbench.policies.registry import parse_policy
from lodbench.policies.selection import Selection
from lodbench.policies.view import View
from lodbench.render.gl.context import Device
from lodbench.render.gl.draw_list import Counts
from lodbench.render.gl.image_comparison import PictureFolder, PictureMachine
from lodbench.render.gl.opengl_machine import GlMachine
from lodbench.render.gl.recorder import Recording, header_of, record, recorded_hardware
from lodbench.render.gl.renderer import Renderer, Timing
from lodbench.sim.replay import ReplayOptions

CARD = Device("A card", "1.0", software=False)
COUNTS = Counts(1, 2, 3, 4, 5, 6, 7, 8, 0)


class Scripted:
    """In place of a renderer: draws nothing, and takes times as told."""

    statistics: tuple[str, ...] = ("vertex_shader_invocations",)

    def __init__(self, frame_ms: Iterator[float], gpu_share: float = 0.9) -> None:
        self.frame_ms, self.gpu_share = frame_ms, gpu_share
        self.sizes: list[tuple[int, int]] = []
        self.drawn = 0

    def prepare(self, picture: Any) -> Any:
        """Keep the size that is asked for."""
        self.sizes.append(picture.size_px)

    def count(self, frame: Any) -> Counts:
        """Return the same counts."""
        return COUNTS

    def draw(self, frame: Any, *, counting: bool = False) -> Timing:
        """Return the next time, of which a tenth is the CPU's, and count the drawing."""
        self.drawn += 1
        took = next(self.frame_ms)
        counted = (100 + self.drawn,) if counting else ()
        return Timing(0.1 * took, self.gpu_share * took, took, 9, counted)


class Listener:
    """Draws everything at full detail and size, or some other, and notes what it is told."""

    capabilities: ClassVar[Capabilities] = Capabilities()

    def __init__(self, render_scale: float = 1.0) -> None:
        self.heard: list[float] = []
        self.render_scale = render_scale

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Forget what was heard."""
        self.heard = []

    def select(self, view: View) -> Selection:
        """Note the newest time."""
        self.heard.append(view.completed.last_work_ms())
        return Selection(view.ids, np.zeros(len(view)), render_scale=self.render_scale)


@pytest.fixture
def recording(
    make_scene: Callable[..., Scene],
    make_trace: Callable[..., Any],
    make_hardware: Callable[..., HardwareProfile],
) -> Callable[..., tuple[Recording, GlMachine]]:
    """Return a function that records a policy on a scripted renderer."""

    def recorded(
        policy: Policy, renderer: Any, frames: int, scene: Scene | None = None, **machine: Any
    ) -> tuple[Recording, GlMachine]:
        measuring = GlMachine(renderer, CARD, **machine)
        hardware = recorded_hardware(make_hardware(), (100, 60))
        found = record(
            policy,
            scene or make_scene([(0.0, 0.0, -10.0)]),
            make_trace(),
            hardware,
            ReplayOptions(budget_ms=10.0, frames=frames),
            measuring,
            measuring,
            name="a policy",
        )
        return found, measuring

    return recorded


def test_median_and_extremes_of_repeats(recording: Any) -> None:
    """After two drawings to warm up, each frame is drawn three times."""
    times = iter([90.0, 80.0, 5.0, 4.0, 30.0, 7.0, 6.0, 6.5])
    renderer = Scripted(times)
    found, machine = recording(Full(), renderer, 2, repeats=3, warmup=2)
    assert renderer.drawn == 8
    columns = found.columns
    assert columns["frame_ms"].tolist() == [5.0, 6.5]
    assert columns["frame_ms_low"].tolist() == [4.0, 6.0]
    assert columns["frame_ms_high"].tolist() == [30.0, 7.0]
    assert columns["gpu_ms"] == pytest.approx([4.5, 5.85])
    assert columns["cpu_ms"] == pytest.approx([0.5, 0.65])
    assert columns["shaded_samples"].tolist() == [9.0, 9.0]
    assert [columns[name][0] for name in Counts.__dataclass_fields__] == [1, 2, 3, 4, 5, 6, 7, 8, 0]
    assert columns["vertex_shader_invocations"].tolist() == [103, 106]  # the first of each three
    assert machine.doubt is None
    assert found.frames["gpu_ms"].tolist() == [5.0, 6.5]


def test_a_policy_hears_what_was_measured(recording: Any) -> None:
    """Before frame k it knows the times of all frames before it, and time goes on by them."""
    listener = Listener()
    found, _ = recording(listener, Scripted(iter([9.0, 3.0, 4.0, 5.0])), 3, repeats=1, warmup=1)
    assert np.isnan(listener.heard[0])
    assert listener.heard[1:] == [3.0, 4.0]
    assert found.columns["trace_s"] == pytest.approx([0.0, 0.003, 0.007])
    assert len(found.columns["policy_ms"]) == 3
    assert (found.columns["policy_ms"] > 0.0).all()


class Reference:
    """In place of a reference: takes 1, 2, 3 ms and so on, and notes what was drawn before it."""

    def __init__(self, renderer: Scripted) -> None:
        self.renderer, self.drawn_before = renderer, list[int]()

    def take_ms(self) -> float:
        """Return the next whole number."""
        self.drawn_before.append(self.renderer.drawn)
        return float(len(self.drawn_before))


def test_a_reference_before_and_after_the_drawings_of_a_frame(recording: Any) -> None:
    """Two frames of three drawings after one to warm up: at 1 and 4 drawings, at 4 and 7."""
    renderer = Scripted(iter([5.0] * 7))
    reference = Reference(renderer)
    found, _ = recording(Full(), renderer, 2, repeats=3, warmup=1, reference=reference)
    assert reference.drawn_before == [1, 4, 4, 7]
    assert found.columns["reference_before_ms"].tolist() == [1.0, 3.0]
    assert found.columns["reference_after_ms"].tolist() == [2.0, 4.0]


def test_render_scale_makes_a_smaller_framebuffer(recording: Any) -> None:
    """Half of 100 x 60 px."""
    renderer = Scripted(iter([1.0] * 2))
    recording(Listener(0.5), renderer, 1, repeats=1, warmup=1)
    assert renderer.sizes == [(50, 30)]


def test_a_timer_in_doubt_is_left_out(recording: Any) -> None:
    """A query that reports a tenth of the wait is no measurement; the header says so."""
    found, machine = recording(Full(), Scripted(iter([5.0] * 9), 0.05), 2, repeats=2, warmup=1)
    assert "gpu_ms" not in found.columns
    header = header_of(CARD, {"scene": "by hand"}, machine.doubt)
    assert header["gpu_ms"] == f"left out, {machine.doubt}"
    assert list(header)[:4] == ["renderer", "driver", "processor", "scene"]


def test_a_counter_that_runs_over_later(recording: Any) -> None:
    """Of a frame whose query reports more than the frame took, the GPU time is not known."""
    renderer = Scripted(iter([5.0] * 9))
    times = iter([4.0, 4.0, 4294.0])
    renderer.statistics = ()
    renderer.draw = lambda *_, **__: Timing(0.5, next(times), 5.0, 9)  # type: ignore[method-assign]
    found, _ = recording(Full(), renderer, 2, repeats=1, warmup=1)
    assert found.columns["gpu_ms"][0] == 4.0
    assert np.isnan(found.columns["gpu_ms"][1])


@pytest.mark.parametrize(
    ("policy", "reason"),
    [
        ("oracle", "sees the future, which a real machine does not show"),
        ("hlod-hysteresis", "it streams, and a recording has all meshes in memory"),
        ("screen-space-error", "it streams"),
    ],
)
def test_policies_that_cannot_be_recorded(recording: Any, policy: str, reason: str) -> None:
    """Each is refused in one line before anything is drawn."""
    renderer = Scripted(iter([]))
    with pytest.raises(InputError, match=f"a policy: expected a policy that can be.*{reason}"):
        recording(parse_policy(policy).make(), renderer, 1)
    assert renderer.drawn == 0


def test_a_policy_that_does_not_apply(recording: Any, make_scene: Callable[..., Scene]) -> None:
    """A policy without fronts is refused a hierarchy."""
    tree = make_scene([(0.0, 0.0, -10.0)] * 2, parent=[-1, 0])
    with pytest.raises(InputError, match="can be recorded; the scene is a hierarchy"):
        recording(parse_policy("static-distance").make(), Scripted(iter([])), 1, tree)


@pytest.mark.parametrize("repeats", [0, 100, -1])
def test_repeats_out_of_range(repeats: int) -> None:
    """One line names the option."""
    renderer: Any = Scripted(iter([]))
    with pytest.raises(InputError, match="--repeats: expected 1 to 99"):
        GlMachine(renderer, CARD, repeats=repeats)


def test_closed_loop_for_real(target: Any, plaza: Any, tour: Any, llvmpipe: Any) -> None:
    """The times that the feedback policy goes by are those in the log; software has no gpu_ms."""
    scene, geometry = plaza
    renderer = Renderer(target, scene, geometry, instancing=False)
    machine = GlMachine(renderer, target.device, repeats=1, warmup=1)
    hardware = recorded_hardware(llvmpipe, (160, 90))
    options = ReplayOptions(budget_ms=4.0, frames=10)
    policy = parse_policy("feedback").make()
    found = record(policy, scene, tour, hardware, options, machine, machine, name="feedback")
    frame_ms = found.columns["frame_ms"]
    assert found.frames["gpu_ms"].tolist() == frame_ms.tolist()
    assert np.diff(found.columns["trace_s"]) == pytest.approx(1e-3 * frame_ms[:-1], rel=1e-3)
    triangles = found.columns["triangles"]
    assert (frame_ms[0] > 4.0) == (triangles[1] < triangles[0])
    if target.device.software:
        assert machine.doubt is not None
        assert "gpu_ms" not in found.columns


def test_full_detail_is_the_full_picture(
    target: Any, plaza: Any, tour: Any, llvmpipe: Any, tmp_path: Any
) -> None:
    """The picture of a policy at full detail is the one that it is compared with: SSIM is 1."""
    scene, geometry = plaza
    renderer = Renderer(target, scene, geometry, instancing=False)
    hardware = recorded_hardware(llvmpipe, (160, 90))
    options = ReplayOptions(budget_ms=4.0, frames=3)
    for policy, same in (("full", True), ("static-distance", False)):
        measuring = GlMachine(renderer, target.device, repeats=1, warmup=1)
        machine = PictureMachine(measuring, renderer, PictureFolder(tmp_path, 2))
        made = parse_policy(policy).make()
        record(made, scene, tour, hardware, options, machine, measuring, name=policy)
        assert [picture.frame for picture in machine.compared] == [0, 2]
        assert all((picture.ssim == 1.0) is same for picture in machine.compared)
        assert all((picture.difference == 0.0) is same for picture in machine.compared)
        assert all(0.0 <= picture.differing < 0.2 for picture in machine.compared)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "frame-000000.png",
        "frame-000002.png",
    ]
