"""Pictures of worst moments: whose they are, of which frame, and that they never cost a result."""

import io
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from PIL import Image

from lodbench.analysis.report.render import render_report
from lodbench.analysis.study import moment_pictures
from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.comparison_folder import Compared, read_results, write_results
from lodbench.analysis.study.comparison_parts import PolicyResult, Status
from lodbench.analysis.study.moment_pictures import (
    Meshes,
    draw_moments,
    has_one_camera,
    pictured,
)
from lodbench.analysis.study.replays import Place
from lodbench.base.errors import InputError
from lodbench.models.meshes.geometry import Geometry
from lodbench.models.scene.rig import Eyes
from lodbench.policies.registry import parse_policy
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.replay import ReplayOptions

REPLAY = ReplayOptions(budget_ms=8.0, seed=3)
SETTINGS = CompareSettings(workers=1, draws=0, warmup_s=0.1, seeds=1)
POLICIES = ("static-screen:bias=1", "feedback:target=0.9", "full")
Drawn = dict[str, tuple[str, float, float]]
"""Of each picture by label: path, time and work of its frame."""


def compared(world: Any, meshes: Meshes | None) -> Compared:
    """Compare on three paths, the first of which sees nothing; with pictures where meshes are."""
    specs = [parse_policy(text) for text in POLICIES]
    blind = replace(world.trace.stretch(0.2, 0.7), name="blind")
    paths, settings = [blind, *world.short_paths(2)], SETTINGS
    return compare(specs, world.scene, paths, world.machine, REPLAY, settings, meshes=meshes)


@pytest.fixture(scope="module")
def found(world: Any) -> tuple[Compared, Drawn]:
    """Return a comparison with pictures, and which frames were drawn for it."""
    drawn: Drawn = {}
    whole: Any = getattr(moment_pictures, "_draw")  # noqa: B009 - private to all others

    def note(log: FrameLog, frame: int, *rest: Any) -> bytes:
        work_ms = max(float(log["gpu_ms"][frame]), float(log["cpu_ms"][frame]))
        time_s = 1e-9 * float(log["input_ns"][frame])
        drawn[log.header.policy] = (log.header.trace, time_s, work_ms)
        return whole(log, frame, *rest)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(moment_pictures, "_draw", note)
        return compared(world, tuple), drawn


def result(
    label: str, *, status: Status = "ok", oracle: bool = False, same_as: str | None = None
) -> PolicyResult:
    """Return what became of a policy."""
    return PolicyResult(label, label, {}, None, status, None, oracle, same_as=same_as)


def test_the_first_three_and_full_detail_have_pictures() -> None:
    """Neither an oracle, nor what did the same as another, nor what failed; full detail once."""
    policies = [
        result("a"),
        result("b", same_as="a"),
        result("oracle", oracle=True),
        result("c"),
        result("d", status="failed"),
        result("e"),
        result("f"),
        result("full"),
    ]
    assert pictured(policies) == ("a", "c", "e", "full")
    assert pictured(policies[-1:]) == ("full",)


def test_a_picture_is_of_the_worst_frame_of_all_judged_runs(found: tuple[Compared, Drawn]) -> None:
    """What is drawn is the frame that the record names, which need not be on the first path."""
    comparison, drawn = found[0].comparison, found[1]
    moments = comparison.worst_moments
    assert drawn.keys() == set(POLICIES)
    for label, (path, time_s, work_ms) in drawn.items():
        assert path == moments[label].path
        assert time_s == pytest.approx(moments[label].time_s)
        assert work_ms == pytest.approx(moments[label].work_ms)
    assert {moment.path for moment in moments.values()} != {comparison.paths[0]}


def test_pictures_change_no_number(world: Any, found: tuple[Compared, Drawn]) -> None:
    """The record, the frames and all runs are those of a comparison without pictures."""
    plain, drawn = compared(world, None), found[0]
    assert plain.pictures == {}
    assert drawn.comparison == plain.comparison
    assert drawn.runs == plain.runs
    assert plain.logs.keys() == drawn.logs.keys()
    for label, log in plain.logs.items():
        assert log.counts.tobytes() == drawn.logs[label].counts.tobytes()


def test_pictures_are_read_back(world: Any, found: tuple[Compared, Drawn], tmp_path: Path) -> None:
    """PNG of the display's shape, from the folder as they were; the page made again is the same."""
    compared, _ = found
    display = world.machine.display
    picture = Image.open(io.BytesIO(compared.pictures["full"]))
    assert picture.width == 640
    assert picture.height == round(640 * display.height_px / display.width_px)
    write_results(tmp_path / "run", compared)
    page = (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 3
    read = read_results(tmp_path / "run")
    assert read.pictures == compared.pictures
    assert page == render_report(read.comparison, read.logs, read.scene, read.pictures)
    (tmp_path / "run" / "moments" / "full.png").write_text("<script>", encoding="utf-8")
    with pytest.raises(InputError, match=r"full\.png: expected a PNG, got another file"):
        read_results(tmp_path / "run")


def test_meshes_that_are_gone_or_others_cost_no_result(
    world: Any, found: tuple[Compared, Drawn]
) -> None:
    """A file that is gone or changed in hours of replays: pictures have stand-ins for objects."""
    comparison, log = found[0].comparison, found[0].logs["full"]
    replays: Any = {Place("full", 0, 0, logged=True): SimpleNamespace(log=log)}

    def draw(meshes: Any) -> dict[str, bytes]:
        return draw_moments(comparison, replays, replays, world.scene, meshes)

    def gone() -> Geometry:
        raise InputError("expected a file that can be read, got none")

    bare = draw(tuple)
    assert bare.keys() == {"full"}
    assert draw(tuple) == bare, "the same bytes again"
    assert draw(gone) == bare
    assert draw(lambda: ("not", "these")) == bare
    unkept: Any = {at: SimpleNamespace(log=replace(log, levels=None)) for at in replays}
    assert draw_moments(comparison, unkept, unkept, world.scene, tuple) == {}


def test_the_page_says_why_there_is_no_picture(world: Any, found: tuple[Compared, Drawn]) -> None:
    """No single picture shows what two cameras saw, and records of before have none."""
    comparison, logs = found[0].comparison, found[0].logs
    eyes = Eyes(apart_m=0.06)
    paths = world.short_paths(1)
    assert has_one_camera(paths, REPLAY)
    assert not has_one_camera(paths, replace(REPLAY, eyes=eyes))
    assert "No pictures: this record keeps none." in render_report(comparison, logs)
    two = replace(comparison, conditions=replace(comparison.conditions, eyes=eyes))
    assert "No pictures: several cameras look at once" in render_report(two, logs)
