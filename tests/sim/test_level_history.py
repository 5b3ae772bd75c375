"""Levels over time: what an observer takes down is what the simulator counts."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.policies.registry import parse_policy
from lodbench.sim import level_history
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.frame_log_file import read_frame_log, write_frame_log
from lodbench.sim.level_history import HIDDEN, LevelHistory
from lodbench.sim.replay import ReplayOptions, replay

Made = Callable[..., Any]


def history_of(changes: list[list[tuple[int, int]]]) -> LevelHistory:
    """Return a history from the (node, level) pairs of each frame."""
    flat = [pair for frame in changes for pair in frame]
    return LevelHistory(
        np.cumsum([0, *map(len, changes)]),
        np.array([node for node, _ in flat], dtype=np.int32),
        np.array([level for _, level in flat], dtype=np.int16),
        np.tile((0.0, 0.0, 0.0, 1.0), (len(changes), 1)),
    )


@pytest.fixture
def walk(make_scene: Made, make_trace: Made, make_hardware: Made) -> Callable[..., FrameLog]:
    """Return what replays a way towards four objects, past two of them."""
    scene = make_scene([(0.0, 0.5 * at, -15.0 * at) for at in (1, 2, 6, 8)])
    trace = make_trace([(0.0, 0.0, 0.0), (0.0, 0.0, -60.0)], time_s=[0.0, 3.0])
    options = ReplayOptions(budget_ms=16.0)

    def run(**more: Any) -> FrameLog:
        policy = parse_policy("static-distance").make()
        return replay(policy, scene, trace, make_hardware(), options, name="p", **more)

    return run


@pytest.fixture
def walked(walk: Callable[..., FrameLog]) -> FrameLog:
    """Return that walk with the levels kept."""
    return walk(keeps_levels=True)


def test_a_replay_keeps_levels_only_where_asked(
    walk: Callable[..., FrameLog], walked: FrameLog
) -> None:
    """Without the wish there is no history, and with it the frames are the same."""
    log = walk()
    assert log.levels is None
    assert np.array_equal(log.counts, walked.counts, equal_nan=True)
    assert np.array_equal(log.times_ns, walked.times_ns)


def test_switches_are_the_toggles_that_the_simulator_counts(walked: FrameLog) -> None:
    """Frame by frame: what a history calls a switch, the accounts call a toggle; also drawn."""
    levels = walked.levels
    assert levels is not None
    assert len(levels) == len(walked)
    flat_scene: Any = type("Flat", (), {"flat": True})()
    switched = np.bincount(levels.frame[levels.switches(flat_scene)], minlength=len(walked))
    assert switched.sum() >= 2
    assert switched.tolist() == walked["toggles"].tolist()
    shown = np.cumsum((levels.before() == HIDDEN).astype(int) - (levels.level == HIDDEN))
    assert levels.start[1] == 4
    drawn = np.concatenate(([0], shown))[levels.start[1:]]
    assert drawn.tolist() == walked["drawn"].tolist()
    assert drawn[-1] == 2, "two objects were passed"


def test_levels_of_a_frame_are_those_changed_last() -> None:
    """Of three nodes one changes twice and one is hidden again; a frame sees none that comes."""
    history = history_of([[(0, 2), (1, 1)], [], [(0, 0), (1, HIDDEN)], [(2, 3)]])
    assert [history.at(frame, 3).tolist() for frame in range(4)] == [
        [2, 1, HIDDEN],
        [2, 1, HIDDEN],
        [0, HIDDEN, HIDDEN],
        [0, HIDDEN, 3],
    ]


def test_levels_come_back_from_a_file(walked: FrameLog, tmp_path: Path) -> None:
    """Nodes, levels and the camera are read to the bit, and equal logs are equal files."""
    for name in ("a.parquet", "b.parquet"):
        write_frame_log(tmp_path / name, walked)
    assert (tmp_path / "a.parquet").read_bytes() == (tmp_path / "b.parquet").read_bytes()
    read, kept = read_frame_log(tmp_path / "a.parquet").levels, walked.levels
    assert read is not None
    assert kept is not None
    for name in ("start", "node", "level", "turn_xyzw"):
        assert np.array_equal(getattr(read, name), getattr(kept, name)), name


def test_a_history_ends_where_there_is_no_more_room(
    walk: Callable[..., FrameLog],
    walked: FrameLog,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    """Beyond the bound whole frames are left out, in the file too; the rest of the log is there."""
    monkeypatch.setattr(level_history, "MOST_CHANGES", 4)
    log = walk(keeps_levels=True)
    assert log.levels is not None
    assert walked.levels is not None
    frames = len(log.levels)
    assert len(log.levels.node) <= 4 < len(walked.levels.node)
    assert 0 < frames < len(log) == len(walked)
    assert log.levels.start.tolist() == walked.levels.start[: frames + 1].tolist()
    write_frame_log(tmp_path / "short.parquet", log)
    read = read_frame_log(tmp_path / "short.parquet")
    assert read.levels is not None
    assert len(read.levels) == frames
    assert len(read) == len(log)


def test_a_tree_switches_where_nodes_take_each_others_place(make_scene: Made) -> None:
    """A parent for its children and back are six switches; coming into view is none."""
    scene = make_scene(np.zeros((3, 3)), parent=[-1, 0, 0])
    levels = history_of([
        [(0, 0)],  # the parent comes into view
        [(0, HIDDEN), (1, 0), (2, 0)],  # and is refined
        [(2, HIDDEN)],  # one child leaves the view
        [(2, 0)],
        [(0, 0), (1, HIDDEN), (2, HIDDEN)],  # coarse again
    ])  # fmt: skip
    assert levels.switches(scene).tolist() == [False, *[True] * 3, False, False, *[True] * 3]
    flat = make_scene(np.zeros((3, 3)))
    assert not levels.switches(flat).any()
    added = replace(scene, additive=np.array([True, False, False]))
    both = history_of([[(0, 0)], [(1, 0)], [(1, HIDDEN)]])
    assert both.switches(added).tolist() == [False, True, True]


@pytest.mark.parametrize("changes", [[[(3, 0)]], [[(0, 3)]]], ids=["no such node", "no such level"])
def test_levels_of_another_scene_are_refused(
    make_scene: Made, changes: list[list[tuple[int, int]]]
) -> None:
    """Nodes and levels that a scene does not have are an error of the file."""
    with pytest.raises(InputError, match="expected nodes and levels of by-hand"):
        history_of(changes).require_nodes(make_scene(np.zeros((3, 3))))


def test_a_history_that_cannot_be_is_refused() -> None:
    """Starts that fall, negative nodes and orientations that are not there."""
    good = history_of([[(0, 0)], [(0, 1)]])
    for change in (
        {"start": np.array([0, 2, 1])},
        {"start": np.array([0, 1])},
        {"node": np.array([-1, 0], dtype=np.int32)},
        {"level": np.array([0, -2], dtype=np.int16)},
        {"turn_xyzw": np.full((2, 4), np.nan)},
    ):
        with pytest.raises(InputError, match="levels"):
            replace(good, **change)
