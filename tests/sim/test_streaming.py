"""Streaming in a replay: what may be drawn, what is asked for, and the columns of memory."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import pytest

from lodbench.base.errors import InputError, PolicyError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.scene.scene import Scene
from lodbench.policies.protocol import Capabilities
from lodbench.policies.selection import Selection
from lodbench.policies.view import View
from lodbench.sim.replay import ReplayOptions, replay

Make = Callable[..., Any]
ROOT_BYTES, CHILD_BYTES = 3_600, 36_000


@dataclass
class Eager:
    """Wants a list of nodes and draws the children as soon as told."""

    wanted: tuple[int, ...] = (1, 2)
    draw_at: int | None = None  # a frame; None: once they are in memory
    capabilities: ClassVar[Capabilities] = Capabilities(levels=False, hierarchy=True, loader=True)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Forget nothing: there is nothing to remember."""

    def select(self, view: View) -> Selection:
        """Return the root, or its children."""
        children = np.array([1, 2], dtype=np.int32)
        ready = view.at(children).resident.all() if self.draw_at is None else None
        go = bool(ready) if ready is not None else view.frame == self.draw_at
        ids = children if go else np.array([0], dtype=np.int32)
        return Selection(ids, np.zeros(len(ids)), wanted=np.array(self.wanted, dtype=np.int32))


class Patient(Eager):
    """The same without a loader: everything is in memory."""

    capabilities: ClassVar[Capabilities] = Capabilities(levels=False, hierarchy=True)


@pytest.fixture
def run(make_scene: Make, make_levels: Make, make_hardware: Make, make_trace: Make) -> Make:
    """Return a function that replays a root of 3,600 bytes and two children of 36,000."""
    levels = make_levels([[100.0], [1_000.0], [1_000.0]])
    position = [(0.0, 0.0, -10.0), (-1.0, 0.0, -10.0), (1.0, 0.0, -10.0)]
    scene = make_scene(position, kind=[0, 1, 2], parent=[-1, 0, 0], levels=levels)
    # 36,000 bytes take a seek of 1 ms and 9 ms of reading.
    hardware = replace(make_hardware(), disk_bytes_per_s=4e6, disk_latency_ms=1.0)

    def replayed(policy: Any, **options: Any) -> Any:
        settings = ReplayOptions(budget_ms=16.0, frames=30, **options)
        return replay(policy, scene, make_trace(), hardware, settings, name="eager")

    return replayed


def test_textures_of_trees_are_read_and_kept(
    make_scene: Make, make_levels: Make, make_hardware: Make, make_trace: Make
) -> None:
    """A child of 36,000 bytes and a texture of 4,000: with the root's 3,600, 43,600 in the end."""
    levels = make_levels([[100.0], [1_000.0]])
    counts = levels.counts.copy()
    counts[1, LEVEL_PREDICTORS.index("texture_bytes")] = 4_000.0
    position = [(0.0, 0.0, -10.0), (0.0, 0.0, -10.0)]
    textured = replace(levels, counts=counts)
    scene = make_scene(position, kind=[0, 1], parent=[-1, 0], levels=textured)
    settings = ReplayOptions(budget_ms=16.0, frames=30)
    log = replay(Eager((1,), 99), scene, make_trace(), make_hardware(), settings, name="eager")
    assert log["memory_bytes"][-1] == ROOT_BYTES + CHILD_BYTES + 4_000
    assert log["loaded_bytes"].sum() == log["memory_bytes"][-1]
    assert log.drawn_by_depth.tolist() == [[1, 0]] * 30


def test_children_are_drawn_when_they_have_been_read(run: Make) -> None:
    """Two reads of 10 ms: the children are drawn from the first frame after 20 ms on."""
    log = run(Eager())
    drawn_at_ms = log["input_ns"][log["drawn"] == 2] / 1e6
    before_ms = log["input_ns"][log["drawn"] == 1] / 1e6
    assert drawn_at_ms.min() >= 20.0
    assert before_ms.max() < 20.0
    assert log["missing"].max() == 0


def test_memory_and_bytes_read_are_logged(run: Make) -> None:
    """Memory starts with the root; what is read adds up to it, as nothing is evicted."""
    log = run(Eager())
    assert log["memory_bytes"][0] == log["loaded_bytes"][0] == ROOT_BYTES
    assert (np.cumsum(log["loaded_bytes"]) == log["memory_bytes"]).all()
    assert log["memory_bytes"][-1] == ROOT_BYTES + 2 * CHILD_BYTES


def test_bound_is_kept_and_logged(run: Make) -> None:
    """With room for one child only, that one is read and the children are never drawn."""
    bound = float(ROOT_BYTES + CHILD_BYTES + 100)
    log = run(Eager(), memory_bytes=bound)
    assert log.header.memory_bound_bytes == bound
    assert log["memory_bytes"].max() == ROOT_BYTES + CHILD_BYTES
    assert log["drawn"].max() == 1


def test_without_a_loader_everything_is_there_from_the_start(run: Make) -> None:
    """Memory is that of all levels, nothing is read, and a frame may draw anything."""
    log = run(Patient(draw_at=0))
    assert log["drawn"][0] == 2
    assert (log["memory_bytes"] == ROOT_BYTES + 2 * CHILD_BYTES).all()
    assert not log["loaded_bytes"].any()


def test_drawing_what_is_not_in_memory_fails_by_name_and_frame(run: Make) -> None:
    """The policy fails, and the message names the first node that was not there."""
    message = "policy eager, frame 1: ids: expected nodes in memory, got node 1"
    with pytest.raises(PolicyError, match=message):
        run(Eager(draw_at=1))


@pytest.mark.parametrize(
    ("wanted", "reason"),
    [((1, 3), "wanted: expected 0 to 2, got 1 to 3"), ((1, 1), "wanted: expected distinct nodes")],
)
def test_a_wrong_list_fails_by_name(run: Make, wanted: tuple[int, ...], reason: str) -> None:
    """A node that does not exist, or one wanted twice, is refused."""
    with pytest.raises(PolicyError, match=reason):
        run(Eager(wanted=wanted))


@pytest.mark.parametrize("memory_bytes", [0.0, float("nan"), float("inf")])
def test_a_bound_is_a_number_of_bytes(run: Make, memory_bytes: float) -> None:
    """No memory, or no number, is refused before the replay."""
    with pytest.raises(InputError, match="memory: expected bytes > 0"):
        run(Eager(), memory_bytes=memory_bytes)


def test_roots_have_to_fit(run: Make) -> None:
    """A bound below the roots' bytes is refused with what they need."""
    with pytest.raises(InputError, match="at least the 3600 bytes of the roots"):
        run(Eager(), memory_bytes=3_000.0)
