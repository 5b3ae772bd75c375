"""A studio's own files end to end: levels, placements, an Unreal capture, a policy, a report.

The files are made here with known truth: the capture's GPU time is 1 ms, 1 µs a draw call and 2 ns
a triangle, with noise of 1 %; its camera goes round a circle of 20 m at 1.7 m height.
"""

import json
import math
import re
import shlex
import tomllib
from pathlib import Path

import numpy as np
import pytest
import trimesh

from lodbench.cli.main import run
from lodbench.models.scene.scene_catalog import load_scene

PAGE = Path(__file__).parents[2] / "docs" / "studio.md"
FENCE = re.compile(r"^```(\w+)(?: file=(\S+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FRAMES, FRAME_MS, RADIUS_M, EYE_M = 600, 1000.0 / 60.0, 20.0, 1.7
BASE_MS, CALL_MS, TRIANGLE_MS = 1.0, 1e-3, 2e-6
OBJECTS = 220


def make_meshes() -> None:
    """Write two types in centimetres with their levels: 1,280, 320 and 80; 320 and 80 triangles."""
    for name, subdivisions, radius_cm in (("rock", (3, 2, 1), 120.0), ("pine", (2, 1), 300.0)):
        for level, count in enumerate(subdivisions):
            ball = trimesh.creation.icosphere(subdivisions=count, radius=radius_cm)
            ball.apply_translation((0.0, 0.0, radius_cm))
            ball.export(f"{name}_LOD{level}.obj")


def make_instances() -> None:
    """Write where objects stand, in centimetres, in a ring about the path."""
    rng = np.random.default_rng(5)
    rows = ["type,x,y,z,yaw_deg,scale,importance"]
    for number in range(OBJECTS):
        angle, distance_cm = rng.uniform(0.0, 2.0 * math.pi), rng.uniform(400.0, 6000.0)
        x, y = distance_cm * math.cos(angle), distance_cm * math.sin(angle)
        kind = "rock" if number % 2 else "pine"
        rows.append(f"{kind},{x:.1f},{y:.1f},0,{rng.uniform(0, 360):.0f},1,1")
    Path("instances.csv").write_text("\n".join(rows) + "\n")


def make_capture() -> None:
    """Write a capture of Unreal's CSV profiler: left-handed centimetres, times of a known model."""
    rng = np.random.default_rng(6)
    parts = [f"View/{part}{axis}" for part in ("Pos", "Forward", "Up") for axis in "XYZ"]
    rows = [
        ",".join(["EVENTS", "FrameTime", "GPUTime", "RHI/DrawCalls", "RHI/PrimitivesDrawn", *parts])
    ]
    for frame in range(FRAMES):
        angle = 2.0 * math.pi * frame / FRAMES
        calls = round(800 + 300 * math.sin(3 * angle) + rng.uniform(-50, 50))
        triangles = round(1.5e6 + 6e5 * math.cos(5 * angle) + rng.uniform(-1e5, 1e5))
        gpu_ms = (BASE_MS + CALL_MS * calls + TRIANGLE_MS * triangles) * rng.normal(1.0, 0.01)
        x, y = 100 * RADIUS_M * math.cos(angle), -100 * RADIUS_M * math.sin(angle)
        ahead = f"{-math.sin(angle):.6f},{-math.cos(angle):.6f},0"
        times = f",{FRAME_MS:.4f},{gpu_ms:.4f},{calls},{triangles}"
        rows.append(f"{times},{x:.3f},{y:.3f},{100 * EYE_M:.1f},{ahead},0,0,1")
    Path("profile.csv").write_text("\n".join(rows) + "\n")


@pytest.mark.slow
def test_the_studio_page_holds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every command of the page does what it says, and the truth of the files comes out."""
    monkeypatch.chdir(tmp_path)
    make_meshes()
    make_instances()
    make_capture()
    for language, name, block in FENCE.findall(PAGE.read_text(encoding="utf-8")):
        if name:
            Path(name).write_text(block, encoding="utf-8")
        for line in block.replace("\\\n", " ").splitlines() if language == "sh" else ():
            assert run(shlex.split(line)[1:]) == 0, capsys.readouterr().err

    scene = load_scene("woods.lodscene")
    assert len(scene) == OBJECTS
    assert scene.types.names == ("rock", "pine")
    assert scene.types.levels.level_count.tolist() == [3, 2]
    assert scene.types.radius_m == pytest.approx([1.2, 3.0], rel=0.01)

    capsys.readouterr()
    assert run(["trace", "info", "profile.csv", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["format"], told["poses"], told["doubts"]) == ("unreal-view", FRAMES, [])
    speed_m_s = 2.0 * math.pi * RADIUS_M / (FRAMES * FRAME_MS / 1000.0)
    assert told["speed_m_s"]["p50"] == pytest.approx(speed_m_s, rel=0.01)
    assert told["low_m"][2] == pytest.approx(EYE_M)
    assert Path("path.png").stat().st_size > 1000

    profile = tomllib.loads(Path("console.toml").read_text())
    terms = {"base": profile["gpu"]["base"], **profile["gpu"]["linear"]}
    unit_ms = {"ms": 1.0, "us": 1e-3, "ns": 1e-6}
    cost_ms = {name: term["value"] * unit_ms[term["unit"]] for name, term in terms.items()}
    truth_ms = {"base": BASE_MS, "draw_calls": CALL_MS, "triangles": TRIANGLE_MS}
    assert cost_ms == pytest.approx(truth_ms, rel=0.05)

    record = json.loads(Path("report/comparison.json").read_text())
    assert {policy["label"]: policy["status"] for policy in record["policies"]} == {
        "screen_sizes.py:ScreenSizes": "ok",
        "static-screen": "ok",
        "full": "ok",
    }
    assert record["population"] == "this path"
    assert record["answer"][0].startswith("Take ")
    assert Path("report/report.html").is_file()
