"""The viewer's page: what it holds is the record, within its bounds, and every name is text."""

import base64
import json
import re
import zlib
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.comparison_folder import Compared
from lodbench.analysis.view import view_meshes
from lodbench.analysis.view.packed_arrays import pack_arrays
from lodbench.analysis.view.view_meshes import choose_meshes
from lodbench.analysis.view.view_page import render_view
from lodbench.base.errors import InputError
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.meshes.geometry import LevelMesh
from lodbench.models.scene.rig import Eyes
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.level_history import LevelHistory
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.camera_trace import CameraTrace


@pytest.fixture(scope="module")
def compared(small_scene: Scene, turn_trace: CameraTrace, machine: HardwareProfile) -> Compared:
    """Return a comparison of two policies along a turn."""
    policies = [parse_policy("static-screen:bias=1"), parse_policy("full")]
    settings = CompareSettings(workers=1, warmup_s=0.2)
    return compare(policies, small_scene, [turn_trace], machine, ReplayOptions(budget_ms=8.0),
                   settings)  # fmt: skip


def read_page(html: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the head and the arrays of a page, as its script reads them."""
    head = json.loads(re.findall(r'id="head">(.*?)</script>', html, re.DOTALL)[0])
    data = re.findall(r'id="data">(.*?)</script>', html, re.DOTALL)[0]
    raw = zlib.decompress(base64.b64decode(data))
    kinds: dict[str, Any] = {
        "Float32Array": np.float32,
        "Int16Array": np.int16,
        "Int32Array": np.int32,
        "Uint8Array": np.uint8,
        "Uint16Array": np.uint16,
        "Uint32Array": np.uint32,
    }
    arrays = {
        name: np.frombuffer(raw, kinds[kind], length, at)
        for name, (kind, at, length) in head["arrays"].items()
    }
    return head, arrays


def mesh_of(triangles: int) -> LevelMesh:
    """Return a fan of triangles about the origin."""
    turn = np.linspace(0.0, 1.0, triangles + 1)
    rim = np.stack((np.cos(turn), np.sin(turn), turn), axis=1)
    points = np.concatenate((np.zeros((1, 3)), rim))
    faces = np.stack((np.zeros(triangles), np.arange(triangles) + 1, np.arange(triangles) + 2))
    arrays: tuple[Any, ...] = (points, np.zeros_like(points), faces.T, np.array([0, triangles]))
    return LevelMesh(*arrays)


def test_a_page_holds_the_record(compared: Compared) -> None:
    """Frames, cameras, levels and switches are those of the logs, in the order of the ranking."""
    head, arrays = read_page(render_view(compared))
    labels = [policy.label for policy in compared.comparison.ok]
    assert head["policies"] == labels
    assert head["budget_ms"] == 8.0
    for at, label in enumerate(labels):
        log = compared.logs[label]
        assert log.levels is not None
        assert arrays[f"p{at}/time_s"] == pytest.approx(log["input_ns"] * 1e-9)
        assert arrays[f"p{at}/work_ms"] == pytest.approx(np.maximum(log["cpu_ms"], log["gpu_ms"]))
        assert arrays[f"p{at}/camera_m"][3:6] == pytest.approx(
            [log[c][1] for c in ("x_m", "y_m", "z_m")]
        )
        assert arrays[f"p{at}/node"].tolist() == log.levels.node.tolist()
        assert arrays[f"p{at}/level"].tolist() == log.levels.level.tolist()
        assert arrays[f"p{at}/switch"].sum() == log["toggles"].sum()
    assert compared.scene is not None
    assert arrays["center_m"].reshape(-1, 3) == pytest.approx(compared.scene.center_m, rel=1e-6)


def test_the_same_comparison_is_the_same_page(compared: Compared) -> None:
    """No dates, no random numbers; and nothing is loaded from anywhere."""
    html = render_view(compared)
    assert html == render_view(compared)
    assert not re.search(
        r'\b(?:src|href)="', re.sub(r"<script>.*?</script>", "", html, flags=re.DOTALL)
    )


def test_three_js_comes_with_its_licence(compared: Compared) -> None:
    """The text of the licence and the notice in the code are on every page."""
    html = render_view(compared)
    assert "Copyright © 2010-2024 three.js authors" in html
    assert "The above copyright notice and this permission notice shall be included" in html
    assert "SPDX-License-Identifier: MIT" in html


def test_policies_can_be_named(compared: Compared) -> None:
    """Those named are shown in that order; another is an error that lists them."""
    head, _ = read_page(render_view(compared, labels=["full"]))
    assert head["policies"] == ["full"]
    with pytest.raises(InputError, match=r"expected one of .*full.*, got other"):
        render_view(compared, labels=["other"])


def test_a_record_without_levels_is_refused(compared: Compared) -> None:
    """A folder that was written before says what to do."""
    logs = {label: replace(log, levels=None) for label, log in compared.logs.items()}
    for old in (replace(compared, logs=logs), replace(compared, scene=None)):
        with pytest.raises(InputError, match="keep levels, got none; run `lodbench compare --out`"):
            render_view(old)


def test_meshes_are_those_that_are_drawn(make_scene: Callable[..., Scene]) -> None:
    """A mesh is kept for each drawn row, to a 65,536th of its box; others have none."""
    geometry = (mesh_of(40), mesh_of(20), mesh_of(10))
    chosen = choose_meshes(make_scene([(0, 0, 0)]), geometry, np.array([2, 0, 2]))
    assert chosen.mesh_of_row.tolist() == [1, -1, 0]
    assert (chosen.wanted, chosen.own) == (2, 2)
    low, size = chosen.boxes[0]
    grid = chosen.arrays["mesh0/vertices"] / 65535.0
    assert low + size * grid == pytest.approx(geometry[2].vertices, abs=1e-5)
    assert chosen.arrays["mesh0/faces"].tolist() == geometry[2].faces.tolist()
    assert not choose_meshes(make_scene([(0, 0, 0)]), (), np.array([0])).boxes


def test_meshes_beyond_the_bound_are_shown_by_coarser_ones(
    make_scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Small ones go first; the finest, without room, is shown by the next, and the page says so."""
    geometry = (mesh_of(4000), mesh_of(20), mesh_of(10))
    monkeypatch.setattr(view_meshes, "MOST_BYTES", 2_000)
    chosen = choose_meshes(make_scene([(0, 0, 0)]), geometry, np.array([0, 1, 2]))
    assert chosen.mesh_of_row.tolist() == [1, 1, 0]
    assert (chosen.wanted, chosen.own) == (3, 2)


def first_ten(log: FrameLog) -> LevelHistory:
    """Return what a log keeps of its first ten frames."""
    levels = log.levels
    assert levels is not None
    count = levels.start[10]
    return LevelHistory(
        levels.start[:11], levels.node[:count], levels.level[:count], levels.turn_xyzw[:10]
    )


def test_a_cut_is_told(compared: Compared, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where meshes or frames are left out, the page tells how many and whose."""
    assert "Objects are spheres" in render_view(compared)
    assert compared.scene is not None
    geometry = tuple(mesh_of(500 - at) for at in range(len(compared.scene.types.levels.error_m)))
    assert "are shown by their own mesh" not in render_view(compared, geometry)
    monkeypatch.setattr(view_meshes, "MOST_BYTES", 10)
    html = render_view(compared, geometry)
    assert re.search(r"Of \d+ levels that are drawn, 0 are shown by their own mesh", html)
    short = {label: replace(log, levels=first_ten(log)) for label, log in compared.logs.items()}
    assert "ends early, where it is full" in render_view(replace(compared, logs=short))


HOSTILE = "</script><script>alert('\"')</script><!--" + "é" * 10_000


def test_a_picture_has_the_shape_of_one_cameras(compared: Compared) -> None:
    """Half a screen of each eye, all of its width of two players, a quarter of three; and whose."""
    had = compared.comparison.conditions
    screen = had.width_px / had.height_px
    assert read_page(render_view(compared))[0]["aspect"] == pytest.approx(screen)
    for changes, aspect, whose in (
        ({"eyes": Eyes(apart_m=0.06)}, screen / 2, "of the head, between its two eyes"),
        ({"eyes": Eyes(apart_m=0.06, size_px=(300, 400))}, 0.75, "of the head, between its two"),
        ({"players": 2}, screen * 2, "of the first of 2 players"),
        ({"players": 3}, screen, "of the first of 3 players"),
    ):
        conditions = replace(had, **changes)
        comparison = replace(compared.comparison, conditions=conditions)
        page = render_view(replace(compared, comparison=comparison))
        assert read_page(page)[0]["aspect"] == pytest.approx(aspect)
        assert f"The picture is that {whose}" in page


def test_names_of_any_kind_are_text(compared: Compared) -> None:
    """Markup in names of policy, scene, path and type ends no script, and long ones are cut."""
    assert compared.scene is not None
    first = compared.comparison.ok[0]
    kinds = len(compared.scene.types.names)
    hostile = Compared(
        replace(compared.comparison, scene=HOSTILE, hardware=HOSTILE, paths=(HOSTILE,),
                policies=(replace(first, label=HOSTILE),)),
        {HOSTILE: compared.logs[first.label]}, None,
        replace(compared.scene, types=replace(compared.scene.types, names=(HOSTILE,) * kinds)),
    )  # fmt: skip
    html, plain = render_view(hostile), render_view(compared)
    assert "alert('" not in html.replace("\\u003cscript>alert('", "")
    assert html.count("<script") == plain.count("<script")
    assert html.count("<!--") == plain.count("<!--")
    assert not re.search("é{200,}", html)


def test_arrays_are_packed_in_place() -> None:
    """Each begins at a multiple of eight bytes, little-endian, and comes back as it was."""
    given = {"a": np.array([1, 2, 3], dtype=np.uint8), "b": np.array([0.5], dtype=np.float32)}
    text, places = pack_arrays(given)
    assert places == {"a": ("Uint8Array", 0, 3), "b": ("Float32Array", 8, 1)}
    assert zlib.decompress(base64.b64decode(text)) == b"\1\2\3" + bytes(5) + b"\0\0\0\x3f" + bytes(
        4
    )
    with pytest.raises(KeyError):
        pack_arrays({"a": np.array([1.0])})
