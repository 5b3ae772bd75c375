"""Asserting a budget on worlds made by hand, and what a policy class is called."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.bounds.full import Full
from lodbench.policies.registry import parse_policy
from lodbench.testing import FrameBudget, assert_budget
from lodbench.testing.budget import replay_policy
from lodbench.testing.naming import name_policy
from lodbench.traces.cameras.camera_trace import CameraTrace


@pytest.fixture
def world(
    make_scene: Callable[..., Scene], make_trace: Callable[..., CameraTrace]
) -> tuple[Scene, CameraTrace]:
    """Return three objects of 1,000 triangles before a camera that looks at them for a second."""
    scene = make_scene([(-2.0, 0.0, -8.0), (0.0, 0.0, -9.0), (2.0, 0.0, -10.0)])
    return scene, make_trace([(0.0, 0.0, 0.0)] * 2)


@pytest.fixture
def budget(make_hardware: Callable[..., HardwareProfile], tmp_path: Path) -> FrameBudget:
    """Return a budget that full detail breaks: 1 µs a triangle, 1 ms a frame, without noise."""
    limits = tmp_path / "budget.toml"
    limits.write_text(
        'population = "this-path"\n[limits]\nwork_ms_p99 = { max = "budget" }\n', encoding="utf-8"
    )
    return FrameBudget(
        limits=limits, hardware=make_hardware(), seeds=2, warmup_s=0.1, budget_ms=3.9
    )


def test_what_fits_passes_and_what_does_not_fails(
    world: tuple[Scene, CameraTrace], budget: FrameBudget
) -> None:
    """Three objects in full take 4 ms, not within 3.9 ms; the coarsest levels take 1.15."""
    assert_budget("static-screen:bias=0.001", *world, budget)
    with pytest.raises(AssertionError) as failed:
        assert_budget("full", *world, budget)
    assert str(failed.value).startswith(
        "FAILS: full in by-hand on by-hand: work_ms_p99 4.00 ms [< 4.00], limit max budget "
        "(3.9 ms) on these paths, p < .0001; worst 4.00 on by-hand, seed 0: at 0."
    )


def test_a_budget_that_nothing_could_break_is_no_budget(
    world: tuple[Scene, CameraTrace], budget: FrameBudget
) -> None:
    """Within 4.5 ms full detail fits, so that no policy could fail."""
    with pytest.raises(InputError, match=r"takes 4 ms at most, within the budget of 4.5 ms"):
        assert_budget(Full, *world, replace(budget, budget_ms=4.5))


def test_undecided_is_a_warning_or_a_failure(
    world: tuple[Scene, CameraTrace], budget: FrameBudget, tmp_path: Path
) -> None:
    """What could not be judged is never silent."""
    limits = tmp_path / "limits.toml"
    limits.write_text(
        'population = "this-path"\n[limits]\nsettle_ms = { max = 1 }\n', encoding="utf-8"
    )
    unsure = replace(budget, limits=limits)
    with pytest.warns(UserWarning, match="undecided: full in by-hand on by-hand: settle_ms"):
        assert_budget("full", *world, unsure)
    with pytest.raises(AssertionError, match="undecided: full"):
        assert_budget("full", *world, replace(unsure, strict=True))


def test_a_replay_takes_seed_and_stretch_of_the_budget_or_its_own(
    world: tuple[Scene, CameraTrace], budget: FrameBudget
) -> None:
    """A log is of the budget's stretch of the path unless another is asked for."""
    log = replay_policy(Full, *world, replace(budget, seed=4, seconds=(0.0, 0.5)))
    assert (log.header.seed, log.header.budget_ms) == (4, 3.9)
    assert log["input_ns"].max() < 0.5e9
    log = replay_policy(Full, *world, budget, seed=9, seconds=(0.0, 0.25))
    assert log.header.seed == 9
    assert log["input_ns"].max() < 0.25e9
    refresh = replay_policy("full", *world, replace(budget, budget_ms=None))
    assert refresh.header.budget_ms == pytest.approx(1e3 / 60.0)


def test_names_of_policies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A class of a package goes by its module, one of a file by the path from here."""
    assert name_policy("feedback:gain=1") == "feedback:gain=1"
    assert name_policy(Full) == "lodbench.policies.bounds.full:Full"
    (tmp_path / "mine.py").write_text(
        "class Mine:\n    def reset(self, scene, budget_ms): ...\n    select = reset\n",
        encoding="utf-8",
    )
    (tmp_path / "below").mkdir()
    mine = parse_policy(f"{tmp_path / 'mine.py'}:Mine").cls
    for folder, name in (
        (tmp_path, "mine.py:Mine"),
        (tmp_path / "below", f"{tmp_path}/mine.py:Mine"),
    ):
        monkeypatch.chdir(folder)
        assert name_policy(mine) == name
        assert parse_policy(name).cls.__qualname__ == "Mine"
