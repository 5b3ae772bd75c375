"""The commands `compare` and `report`, as a user types them."""

import errno
import json
import os
import shlex
from pathlib import Path
from typing import Any

import pytest

from lodbench.cli.main import run

WORLD = ["--scene", "plaza", "--trace", "tour"]
SHORT = ["compare", *WORLD, "--seconds", "0:2", "--workers", "1"]
SCREEN = "static-screen:bias=1"
AT_LEVEL = """
import numpy as np
from lodbench import Capabilities, Selection


class Mine:
    capabilities = Capabilities()

    def reset(self, scene, budget_ms):
        pass

    def select(self, view):
        return Selection(view.ids, np.full(len(view.ids), {}.0))
"""
BROKEN = """
import numpy as np
from lodbench.policies.protocol import Capabilities
from lodbench.policies.selection import Selection


class Broken:
    capabilities = Capabilities()

    def reset(self, scene, budget_ms):
        pass

    def select(self, view):
        detail = np.full(len(view.ids), np.nan if view.frame == 40 else 0.0)
        return Selection(view.ids, detail)
"""


def test_table_of_two_policies(capsys: pytest.CaptureFixture[str]) -> None:
    """The table fits in 100 columns and says what was replayed."""
    assert run([*SHORT, "--policy", "full", "--policy", SCREEN]) == 0
    out = capsys.readouterr().out
    assert "plaza, 3,000 nodes · tour 0:2 s, 1 to 2 s" in out
    assert SCREEN in out
    assert max(map(len, out.splitlines())) <= 100


def test_json_is_one_document(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """With --json stdout is the document that is also written to the folder."""
    out = tmp_path / "run"
    assert run([*SHORT, "--policy", "full", "--seed", "5", "--json", "--out", str(out)]) == 0
    text = capsys.readouterr().out
    document = json.loads(text)
    assert (document["schema"], document["seed"]) == ("lodbench.compare/2", 5)
    assert (document["window_s"], document["visible"]) == ([[1.0, 2.0]], 1.0)
    assert document["budget_ms"] == pytest.approx(1000 / 60)
    assert (out / "comparison.json").read_text(encoding="utf-8") == text
    assert (out / "frames" / "full.parquet").is_file()


def test_failed_policy_ends_with_1_and_everything_is_written(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """A policy that returns NaN in frame 40 is told, and the other policy's results are there."""
    mine = tmp_path / "mine.py"
    mine.write_text(BROKEN, encoding="utf-8")
    out = tmp_path / "run"
    policies = ["--policy", f"{mine}:Broken", "--policy", "full"]
    assert run([*SHORT, *policies, "--out", str(out)]) == 1
    assert "Broken: frame 40: detail" in " ".join(capsys.readouterr().out.split())
    assert {path.name for path in out.iterdir()} == {
        "report.html",
        "comparison.json",
        "runs.parquet",
        "scene.lodscene",
        "frames",
        "moments",
        "study.json",
        "run-info.json",
    }
    assert [path.name for path in (out / "frames").iterdir()] == ["full.parquet"]


UNMADE = """
from lodbench.policies.bounds.full import Full


class Unmade(Full):
    def __init__(self, number: int = 0) -> None:
        raise ValueError(f"no {number}")
"""


def test_a_constructor_that_raises_fails_its_policy_alone(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Whether it has parameters or not; the other policy is scored, and the exit code is 1."""
    mine = tmp_path / "mine.py"
    mine.write_text(UNMADE, encoding="utf-8")
    policies = [f"{mine}:Unmade", f"{mine}:Unmade:number=7", "full"]
    words = [word for policy in policies for word in ("--policy", policy)]
    assert run([*SHORT, *words, "--json"]) == 1
    found = {it["label"]: it for it in json.loads(capsys.readouterr().out)["policies"]}
    assert [found[label]["status"] for label in policies] == ["failed", "failed", "ok"]
    assert found[policies[1]]["reason"].endswith("cannot be made: ValueError: no 7")


def test_a_refused_parameter_ends_with_2_before_any_replay(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """In one line, and no engine is opened for the policy beside it."""

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("an engine was opened")

    monkeypatch.setattr("lodbench.analysis.study.compare.open_engine", refuse)
    assert run([*SHORT, "--policy", "full", "--policy", "static-screen:first=-1"]) == 2
    expected = "error: static-screen: expected first in (0, inf], got -1.0\n"
    assert tuple(capsys.readouterr()) == ("", expected)


def test_a_full_disk_keeps_no_scores_back(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The table is printed, one line says why nothing is written, and the exit code is 2."""

    def refuse(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", refuse)
    assert run([*SHORT, "--policy", SCREEN, "--out", str(tmp_path / "run")]) == 2
    out, err = capsys.readouterr()
    assert SCREEN in out
    assert err.splitlines()[-1].endswith("got No space left on device; check the folder")
    assert not list(tmp_path.iterdir())


def test_conditions_are_passed_on(capsys: pytest.CaptureFixture[str]) -> None:
    """What is asked of display, pipeline, view and timers is what was replayed."""
    arguments = ["--display", "vsync", "--refresh-hz", "120", "--frames-in-flight", "3"]
    arguments += ["--fovy-deg", "50", "--crossfade-ms", "200", "--measurement-delay", "2"]
    arguments += ["--faults", "missing=0.5,stale=0.1", "--budget-ms", "5", "--warmup", "0.5"]
    arguments += ["--seconds", "5:7", "--visible", "2"]
    arguments += ["--pacing", "just-in-time", "--latency-limit", "0"]
    assert run([*SHORT, "--policy", "feedback:target=0.9", *arguments, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    conditions = document["conditions"]
    wanted = {
        "display": "vsync",
        "refresh_hz": 120.0,
        "frames_in_flight": 3,
        "pacing": "just-in-time",
        "latency_limit": 0,
        "fovy_deg": 50.0,
        "crossfade_ms": 200.0,
        "measurement_delay": 2,
        "hardware_assumed": True,
    }
    assert {key: conditions[key] for key in wanted} == wanted
    assert (document["budget_ms"], document["window_s"]) == (5.0, [[0.5, 2.0]])
    assert (document["paths"], document["visible"]) == (["tour 5:7 s"], 2.0)
    metrics = document["policies"][0]["metrics"]
    assert metrics["missed_vsync_fraction"]["value"] is not None


def test_report_is_made_again(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """`report DIR` brings back the same page; of another folder it says what it wants."""
    out = tmp_path / "run"
    assert run([*SHORT, "--policy", "full", "--out", str(out)]) == 0
    before = (out / "report.html").read_bytes()
    (out / "report.html").unlink()
    capsys.readouterr()
    assert run(["report", str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["report"] == str(out / "report.html")
    assert (out / "report.html").read_bytes() == before
    assert run(["report", str(tmp_path)]) == 2
    assert "give a folder that `lodbench compare --out` wrote" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--scene", "plazza"], "did you mean plaza?"),
        (["--trace", "tuor"], "did you mean tour?"),
        (["--hardware", "desktop"], "desktop-assumed"),
        (["--policy", "ful"], "did you mean full?"),
        (["--budget-ms", "0"], "budget: expected milliseconds > 0"),
        (["--budget-ms", "nan"], "budget: expected milliseconds > 0"),
        (["--seconds", "5"], "seconds: expected A:B, A: or :B in seconds of the path, got '5'"),
        (["--seconds", "5:x"], "seconds: expected A:B, A: or :B"),
        (["--seconds", "5:5"], "seconds: expected a stretch of tour within 0:"),
        (["--seconds", ":900"], "seconds: expected a stretch of tour within 0:"),
        (["--warmup", "-1"], "warmup: expected"),
        (["--warmup", "2"], "warmup: expected seconds >= 0 and less than the path's 2, got 2"),
        (["--visible", "-1"], "visible: expected pixels >= 0"),
        (["--display", "crt"], "immediate, vsync, mailbox or vrr"),
        (["--refresh-hz", "0"], "refresh_hz"),
        (["--frames-in-flight", "9"], "1 to 4"),
        (["--pacing", "fast"], "pacing: expected none, limiter, just-in-time, got fast"),
        (["--latency-limit", "17"], "latency_limit: expected 0 to 16, got 17"),
        (["--faults", "missing=2"], "faults"),
        (["--faults", "lost=0.1"], "faults: expected"),
        (["--faults", "missing=lots"], "faults: expected"),
        (["--place", "middle"], "fit, center, none"),
        (["--policy", "full", "--policy", "full"], "full twice"),
        (["--paths", "0"], "paths: expected"),
        (["--seeds", "0"], "seeds: expected"),
        (["--miss", "0.7"], "miss: expected a share from 0 to 0.5, got 0.7"),
        (["--margin", "-1"], "margin: expected"),
        (["one"], "expected two folders or none, got 1; name two"),
        (["one", "two"], "one"),
    ],
)
def test_bad_input_ends_with_2_and_one_line(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Whatever is wrong is told in one line that begins with error, and nothing is printed."""
    assert run([*SHORT, *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("error: ")
    assert captured.err.count("\n") == 1
    assert message in captured.err


def test_a_display_slower_than_the_profiles_range(capsys: pytest.CaptureFixture[str]) -> None:
    """30 Hz is a display, though the profile's variable rates end at 48."""
    arguments = ["--policy", "full", "--display", "vsync", "--refresh-hz", "30", "--json"]
    assert run([*SHORT, *arguments]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["budget_ms"] == pytest.approx(1000 / 30)
    assert document["policies"][0]["metrics"]["frame_ms_p50"]["value"] == pytest.approx(1000 / 30)


def test_folder_in_the_way_is_refused_before_the_replays(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """A folder with other files is refused at once and stays as it is."""
    (tmp_path / "thesis.tex").write_text("mine", encoding="utf-8")
    assert run([*SHORT, "--seconds", "0:", "--out", str(tmp_path)]) == 2
    assert "thesis.tex" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def document_of(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, Any]:
    """Return the document that a command prints with --json."""
    assert run([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_quick_is_of_fewer_and_shorter_paths(capsys: pytest.CaptureFixture[str]) -> None:
    """Four paths of six seconds each, all of the kind that is named."""
    line = ["compare", "--scene", "plaza", "--trace", "walk", "--policy", "full", "--quick"]
    document = document_of(capsys, *line, "--seconds", "5.4:", "--warmup", "0.2", "--draws", "0")
    assert len(set(document["paths"])) == 4
    for _, end in document["window_s"]:
        assert end == pytest.approx(0.6)
    assert document["population"] == "such paths"
    assert "--quick" in document["provenance"]["command"]
    more = document_of(
        capsys, *line, "--paths", "2", "--seconds", "5.4:", "--warmup", "0.2", "--draws", "0"
    )
    assert more["paths"] == document["paths"][:2]


def test_as_shipped_tunes_nobody(capsys: pytest.CaptureFixture[str]) -> None:
    """A policy named bare is brought to the budget; with --as-shipped it is as it ships."""
    line = [*SHORT, "--policy", "static-distance", "--seconds", "0:0.4", "--warmup", "0.1"]
    tuned = document_of(capsys, *line)["policies"][0]["knob"]
    shipped = document_of(capsys, *line, "--as-shipped")["policies"][0]["knob"]
    assert (tuned["name"], tuned["tuned"]) == ("scale", True)
    assert (shipped["name"], shipped["value"], shipped["tuned"]) == ("scale", 1.0, False)


def test_the_command_that_is_told_gives_the_same_again(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The provenance's line, typed into a shell, makes the same document."""
    policies = ["--policy", "full", "--policy", "feedback:target=0.9,gain=0.25"]
    line = [*SHORT, *policies, "--budget-ms", "2.5", "--as-shipped", "--seeds", "2"]
    document = document_of(capsys, *line, "--visible", "2", "--warmup", "0.5")
    told = shlex.split(document["provenance"]["command"])
    assert told[0] == "lodbench"
    assert "--workers" not in told
    assert document_of(capsys, *told[1:]) == document


def test_two_folders_are_compared(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What got dearer on every path is told with the cost that grew, and so is no change."""
    line = ["compare", "--scene", "plaza", "--trace", "walk", "--paths", "16"]
    line += ["--warmup", "0.1", "--seconds", "0:0.3", "--seeds", "1", "--policy"]
    folders = [str(tmp_path / name) for name in ("before", "after", "again")]
    for level in (0, 1):
        (tmp_path / f"level-{level}").mkdir()
        own = tmp_path / f"level-{level}" / "mine.py"
        own.write_text(AT_LEVEL.format(level), encoding="utf-8")
    for folder, level in zip(folders, (1, 0, 0), strict=True):
        monkeypatch.chdir(tmp_path / f"level-{level}")
        assert run([*line, "mine.py:Mine", "--out", folder]) == 0
    capsys.readouterr()
    assert run(["compare", *folders[:2]]) == 0
    out = capsys.readouterr().out
    assert "changed beyond noise, compared path by path" in out
    assert "work_ms_mean" in out
    assert max(map(len, out.splitlines())) <= 100
    document = document_of(capsys, "compare", *folders[:2])
    assert document["schema"] == "lodbench.compare-changes/2"
    assert document["paired"]
    work = next(item for item in document["metrics"] if item["metric"] == "work_ms_mean")
    assert work["beyond_noise"]
    assert work["after"] > work["before"]
    assert document["policies"][0]["term_ms"] > 0.0
    same = document_of(capsys, "compare", *folders[1:])
    assert not any(item["beyond_noise"] for item in same["metrics"])
    assert same["policies"][0]["term"] == ""
    assert run(["compare", folders[0], str(tmp_path / "absent")]) == 2
    assert "absent" in capsys.readouterr().err


@pytest.fixture(scope="module")
def mesh_scene(data_dir: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build a scene of 60 objects from two real meshes."""
    target = tmp_path_factory.mktemp("scene") / "real.lodscene"
    meshes = [str(data_dir / "meshes" / name) for name in ("spot.obj", "suzanne.obj")]
    layout = ["--layout", "scatter", "--count", "60", "--seed", "1", "--out", str(target)]
    assert run(["scene", "build", *meshes, *layout]) == 0
    return target


@pytest.mark.slow
@pytest.mark.realdata
@pytest.mark.parametrize(
    "trace", ["tum-freiburg1-xyz.txt", "euroc-v102.csv", "kitti-00.txt", "hmd-6dof-h1.csv#first"]
)
def test_real_trace_over_real_meshes_on_measured_hardware(
    trace: str, mesh_scene: Path, data_dir: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A path, meshes and costs that were all measured: objects come into view and cost time."""
    where = ["--scene", str(mesh_scene), "--trace", str(data_dir / "traces" / trace)]
    policies = ["--policy", "full", "--policy", SCREEN, "--hardware", "llvmpipe"]
    capsys.readouterr()
    assert run([*SHORT, *where, *policies, "--draws", "2", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    drawn = {
        policy["label"]: policy["metrics"]["triangles_mean"]["value"]
        for policy in document["policies"]
    }
    assert 0 < drawn[SCREEN] <= drawn["full"]
    assert not document["conditions"]["hardware_assumed"]
    assert document["sampling"]["draws"] == 2
