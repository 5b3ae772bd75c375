"""`lodbench record`: what it writes and prints on a software rasteriser, and what it refuses."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.cli.main import run
from lodbench.cli.shared.picture_size import parse_size
from lodbench.sim.frame_log_file import read_frame_log
from lodbench.traces.logs.read_log import read_render_log

pytestmark = pytest.mark.usefixtures("egl")

QUICK = ["--trace", "walk", "--repeats", "1", "--size", "160x90", "--seconds", "0:0.05"]
STATIC = ["--policy", "static-screen"]
Record = Callable[..., int]


def refusal(capsys: pytest.CaptureFixture[str]) -> str:
    """Return the one line on stderr; nothing else is printed and nothing written."""
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("error: ")
    assert printed.err.count("\n") == 1
    assert list(Path().iterdir()) == []
    return printed.err


@pytest.mark.parametrize("name", ["log.csv", "log.parquet"])
def test_a_log_that_fit_can_read(record: Record, name: str) -> None:
    """Every predictor and time of a frame, and in the header what was recorded."""
    assert record(*STATIC, out=name) == 0
    log = read_render_log(Path(name))
    header = dict(log.header)
    assert header["scene"] == "balls"
    assert header["policy"] == "static-screen"
    assert header["resolution"] == "160x90"
    assert header["repeats"] == "1"
    assert len(log) > 1
    assert (log.columns(["draw_calls", "triangles", "shaded_samples"]) >= 1.0).all()
    assert (log.columns(["framebuffer_pixels"]) == 160 * 90).all()
    assert (log.time("frame_ms") > log.time("cpu_ms")).all()
    assert log.warnings == ()
    assert [path.name for path in Path().iterdir()] == [name]
    if "llvmpipe" in header["renderer"]:
        assert header["gpu_ms"].startswith("left out, a software rasteriser")


def test_what_json_says(record: Record, capsys: pytest.CaptureFixture[str]) -> None:
    """One document that is told from others by its schema."""
    assert record(*STATIC, "--json", "--instancing") == 0
    document = json.loads(capsys.readouterr().out)
    assert document.pop("schema") == "lodbench.record/1"
    assert sorted(document) == [
        "frame_ms_mean",
        "frame_ms_p95",
        "frame_ms_sd",
        "frames",
        "log",
        "means",
        "reference_ms_mean",
        "reference_ms_sd",
        "repeats_spread_pct",
    ]
    assert document["frames"] > 1
    assert document["log"]["draws"] == "instanced"
    columns = {"draw_calls", "triangles", "shaded_samples", "cpu_ms", "policy_ms"}
    assert set(document["means"]) == columns
    assert document["means"]["draw_calls"] <= 8  # levels, however many objects


def test_what_a_reader_is_told(record: Record, capsys: pytest.CaptureFixture[str]) -> None:
    """The device, the times and the counts, in a few lines."""
    assert record(*STATIC, "--images", "pictures") == 0
    printed = capsys.readouterr().out
    for part in ("160x90", "frames of", "draw calls", "of the policy, apart", "SSIM"):
        assert part in printed


def test_frames_as_compare_writes_them(record: Record) -> None:
    """The frame log holds the measured times as those of the GPU, and the same counts."""
    assert record("--policy", "feedback", "--frame-log", "frames.parquet", out="log.parquet") == 0
    frames, log = read_frame_log(Path("frames.parquet")), read_render_log(Path("log.parquet"))
    assert frames.header.policy == "feedback"
    assert frames["gpu_ms"] == pytest.approx(log.time("frame_ms"), rel=1e-6)
    assert frames["triangles"].tolist() == log.columns(["triangles"])[:, 0].tolist()


def test_pictures_of_full_detail(record: Record, capsys: pytest.CaptureFixture[str]) -> None:
    """They are the pictures that they are compared with; a second recording replaces the first."""
    full = ["--policy", "full", "--images", "pictures", "--json"]
    assert record(*full, "--image-every", "1") == 0
    capsys.readouterr()
    assert record(*full, "--image-every", "2") == 0
    document = json.loads(capsys.readouterr().out)
    drawn = range(0, document["frames"], 2)  # as many frames as this machine draws in the time
    alike = {"count": len(drawn), "ssim_mean": 1.0, "ssim_min": 1.0, "difference_mean": 0.0}
    alike |= {"flip_mean": 0.0, "switch_flip_mean": 0.0}  # full detail never switches
    assert document["pictures"] == alike
    names = sorted(path.name for path in Path("pictures").iterdir())
    assert names == [*(f"frame-{frame:06}.png" for frame in drawn), "images.csv"]
    header, *rows = Path("pictures/images.csv").read_text(encoding="utf-8").splitlines()
    assert header.startswith(
        "frame,trace_s,ssim,difference,differing,flip,step_flip,held_step_flip,"
    )
    assert ",switch_flip,benefit_share,sse_px_p95,sse_px_max,popping_px," in header
    assert [row.split(",")[0] for row in rows] == [str(frame) for frame in drawn]
    for row in rows:
        assert row.split(",")[2:6] == ["1", "0", "0", "0"]
        assert row.split(",")[9] == "1"
        assert len(row.split(",")) == len(header.split(","))


def test_a_calibration_can_be_fitted(record: Record, capsys: pytest.CaptureFixture[str]) -> None:
    """120 frames that spread the predictors give a profile."""
    assert record("--calibrate", "--steps", "120", out="log.parquet") == 0
    log = read_render_log(Path("log.parquet"))
    assert dict(log.header)["policy"] == "calibration"
    assert len(np.unique(log.columns(["framebuffer_pixels"]))) > 1
    capsys.readouterr()
    terms = ["draw_calls", "triangles", "rasterized_triangles", "framebuffer_pixels"]
    quick = ["--steps", "500", "--heldout", "none", "--json"]
    assert run(["fit", "log.parquet", "--terms", ",".join(terms), *quick]) == 0
    fitted = json.loads(capsys.readouterr().out)
    assert fitted["target"] == "frame_ms"
    assert fitted["terms"] == terms
    assert all(fitted["coefficients"][name]["q95"] > 0.0 for name in terms)


def test_a_tree_under_a_policy_of_fronts(record: Record) -> None:
    """What selects fronts in memory is recorded."""
    assert record("--policy", "cluster-cut", scene="tree") == 0
    assert len(read_render_log(Path("log.csv"))) > 1


@pytest.mark.parametrize(
    ("scene", "arguments", "message"),
    [
        ("balls", [], "expected --policy or --calibrate, got neither"),
        ("balls", [*STATIC, "--calibrate"], "expected --policy or --calibrate, got both"),
        ("balls", [*STATIC, "--size", "160"], "--size: expected WIDTHxHEIGHT"),
        ("balls", [*STATIC, "--size", "8x8"], "from 16x16 to 16384x16384, got 8x8"),
        ("balls", [*STATIC, "--out", "log.txt"], "expected a .parquet or .csv file"),
        ("balls", [*STATIC, "--out", "no/log.csv"], "in a folder that exists"),
        ("balls", [*STATIC, "--out", "/proc/log.csv"], "a path that can be written"),
        ("balls", [*STATIC, "--frame-log", "no/log.parquet"], "expected a .parquet file in a"),
        ("balls", [*STATIC, "--frame-log", "frames.csv"], "expected a .parquet file in a"),
        (
            "balls",
            [*STATIC, "--out", "a.parquet", "--frame-log", "a.parquet"],
            "--frame-log: expected another file than --out",
        ),
        ("balls", [*STATIC, "--images", "no/pictures"], "expected a folder that can be written to"),
        ("balls", [*STATIC, "--images", "p", "--image-every", "0"], "--image-every: expected"),
        (
            "balls",
            [*STATIC, "--images", "pictures", "--out", "/proc/log.csv"],
            "a path that can be written",
        ),
        ("balls", [*STATIC, "--repeats", "0"], "--repeats: expected 1 to 99"),
        ("balls", [*STATIC, "--threads", "-1"], "--threads: expected 0 to 32, got -1"),
        ("balls", ["--calibrate", "--steps", "0"], "--steps: expected 1 or more, got 0"),
        ("balls", [*STATIC, "--backend", "vulkan"], "--backend: expected one of egl, window"),
        ("balls", ["--policy", "oracle"], "it sees the future"),
        ("balls", ["--policy", "none"], "got none; name one of them"),
        ("tree", ["--policy", "hlod-hysteresis"], "it streams"),
        ("tree", STATIC, "the scene is a hierarchy"),
        ("tree", ["--calibrate"], "--calibrate: expected a flat scene, got balls"),
        ("bare", STATIC, "meshes to draw, one for each level, got 0"),
    ],
)
def test_refusals(
    record: Record,
    scene: str,
    arguments: list[str],
    message: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """One line on stderr, exit code 2, and nothing written."""
    assert record(*arguments, scene=scene) == 2
    assert message in refusal(capsys)


def test_a_folder_of_other_things_is_left_alone(
    record: Record, capsys: pytest.CaptureFixture[str]
) -> None:
    """Whoever names their holiday pictures keeps them."""
    Path("mine").mkdir()
    Path("mine/frame-1.png").touch()
    Path("mine/notes.txt").touch()
    assert record(*STATIC, "--images", "mine") == 2
    assert "one that holds notes.txt; name another" in capsys.readouterr().err
    assert sorted(path.name for path in Path("mine").iterdir()) == ["frame-1.png", "notes.txt"]
    assert not Path("log.csv").exists()
    assert record(*STATIC, "--images", "mine/notes.txt") == 2
    assert "mine/notes.txt: expected a folder to write to, got a file" in capsys.readouterr().err


def test_a_policy_that_fails_leaves_what_was_there(
    record: Record, capsys: pytest.CaptureFixture[str]
) -> None:
    """In the middle of a recording: an earlier log and pictures stay, and no others appear."""
    Path("policy.py").write_text(
        "import numpy as np\n"
        "class Fails:\n"
        "    from lodbench.policies.protocol import Capabilities\n"
        "    capabilities = Capabilities()\n"
        "    def reset(self, scene, budget_ms): pass\n"
        "    def select(self, view):\n"
        "        from lodbench.policies.selection import Selection\n"
        "        if view.frame == 1: raise ValueError('enough')\n"
        "        return Selection(view.ids, np.zeros(len(view)))\n",
        encoding="utf-8",
    )
    Path("log.csv").write_text("earlier", encoding="utf-8")
    assert record("--policy", "policy.py:Fails", "--images", "pictures") == 1
    assert "enough" in capsys.readouterr().err
    assert Path("log.csv").read_text(encoding="utf-8") == "earlier"
    left = sorted(path.name for path in Path().iterdir() if path.name != "__pycache__")
    assert left == ["log.csv", "policy.py"]


@pytest.mark.parametrize(
    ("backend", "broken", "advice"),
    [
        ("egl", {"GLCONTEXT_LINUX_LIBEGL": "libnone.so"}, "libegl1, libgl1 and libgl1-mesa-dri"),
        (
            "egl",
            {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nonexistent"},
            "libegl1, libgl1 and libgl1-mesa-dri",
        ),
        ("window", {"DISPLAY": "", "WAYLAND_DISPLAY": ""}, "record with --backend egl"),
    ],
)
def test_without_a_driver(
    scenes: Path, tmp_path: Path, backend: str, broken: dict[str, str], advice: str
) -> None:
    """A machine without EGL, without drivers, or without a display: one line says what to do."""
    scene, out = str(scenes / "balls.lodscene"), str(tmp_path / "log.csv")
    arguments = ["record", "--scene", scene, "--out", out, *QUICK, *STATIC, "--backend", backend]
    result = subprocess.run(
        [sys.executable, "-m", "lodbench", *arguments],
        env=os.environ | broken,
        capture_output=True,
        text=True,
    )
    assert result.returncode == 2
    last = result.stderr.splitlines()[-1]
    assert last.startswith("error: expected ")
    assert advice in last
    assert "Traceback" not in result.stderr
    assert result.stdout == ""
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "text", ["", "x", "1280", "1280X720", "0x0", "-16x16", "1e3x9", "16x16x16"]
)
def test_sizes_that_are_none(text: str) -> None:
    """The right form is shown."""
    with pytest.raises(InputError, match="WIDTHxHEIGHT from 16x16 to 16384x16384"):
        parse_size(text)


def test_sizes() -> None:
    """Width comes first."""
    assert parse_size("1280x720") == (1280, 720)


def test_a_log_inside_the_folder_of_pictures_is_refused(
    record: Record, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The folder is replaced as a whole, and a log in it would be lost."""
    (tmp_path / "pictures").mkdir()
    for out, images in (("pictures/log.csv", "pictures"), ("log.csv", "log.csv")):
        assert record(*STATIC, "--images", images, out=out) == 2
        assert "expected a log outside of the folder of pictures" in capsys.readouterr().err
    assert record(*STATIC, "--images", ".", out="../log.csv") == 2
    assert not (tmp_path.parent / "log.csv").exists()


def test_only_pictures_are_replaced(
    record: Record, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A file whose name only begins like that of a picture is no picture of ours."""
    (tmp_path / "pictures").mkdir()
    (tmp_path / "pictures" / "frame-notes.txt").write_text("mine", encoding="utf-8")
    assert record(*STATIC, "--images", "pictures") == 2
    assert "frame-notes.txt" in capsys.readouterr().err


def test_a_policy_without_capabilities_is_refused(
    record: Record, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A user's class that says nothing of what it can drive is named in one line."""
    text = "class Bare:\n    def reset(self, *_): ...\n    def select(self, *_): ...\n"
    (tmp_path / "bare.py").write_text(text, encoding="utf-8")
    assert record("--policy", "bare.py:Bare") == 2
    assert "expected a class with capabilities" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.realdata
def test_real_meshes_along_a_real_trace(
    data_dir: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A textured model and a plain one, along a hand-held camera, are drawn and can be fitted."""
    scene, log = tmp_path / "real.lodscene", tmp_path / "log.parquet"
    meshes = [str(data_dir / "meshes" / name) for name in ("CesiumMilkTruck.glb", "cow.obj")]
    assert (
        run(["scene", "build", *meshes, "--count", "40", "--levels", "3", "--out", str(scene)]) == 0
    )
    trace = str(data_dir / "traces" / "tum-freiburg1-xyz.txt")
    capsys.readouterr()
    arguments = ["--scene", str(scene), "--trace", trace, "--calibrate", "--size", "160x90"]
    drawn = [*arguments, "--steps", "48", "--repeats", "1", "--out", str(log), "--json"]
    assert run(["record", *drawn]) == 0
    assert json.loads(capsys.readouterr().out)["frames"] == 48
    recorded = read_render_log(log)
    assert len(recorded) == 2 * 48
    assert recorded.columns(["textured_triangles"]).max() > 0.0
    assert recorded.columns(["shaded_samples"]).max() > 0.0
