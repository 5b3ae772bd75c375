"""`lodbench view`: a file or an address, and one line about what cannot be shown."""

import json
import os
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest

from lodbench.cli.main import run


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a comparison of one policy along two seconds of a path."""
    out = tmp_path_factory.mktemp("view") / "run"
    words = "compare --scene atlas --trace tour --seconds 0:2 --seeds 1 --draws 0 --warmup 0.5"
    assert run([*words.split(), "--policy", "full", "--workers", "1", "--out", str(out)]) == 0
    return out


def test_a_viewer_is_exported(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The file has the meshes of the bundled scene; the same folder is the same file."""
    files = [tmp_path / "a.html", tmp_path / "b.html"]
    for out in files:
        capsys.readouterr()
        assert run(["view", str(folder), "--export", str(out), "--json"]) == 0
        record = json.loads(capsys.readouterr().out)
        assert record == {"schema": "lodbench.view/1", "view": str(out)}
    page = files[0].read_text(encoding="utf-8")
    assert page == files[1].read_text(encoding="utf-8")
    assert '"mesh0/vertices"' in page
    assert "Objects are spheres" not in page


def test_a_scene_of_ones_own_is_named(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The scene that was kept is the one that was compared, if without meshes; others are not."""
    out, kept = tmp_path / "own.html", folder / "scene.lodscene"
    assert run(["view", str(folder), "--scene", str(kept), "--export", str(out)]) == 0
    assert "Objects are spheres" in out.read_text(encoding="utf-8")
    assert run(["view", str(folder), "--scene", "plaza", "--export", str(out)]) == 2
    assert "expected atlas as it was compared, got another" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--policy", "full", "--policy", "oracle"], "policy: expected one of full, got oracle"),
        (["--export", "view.txt"], "expected a name that ends in .html, got 'view.txt'"),
        (["--port", "1"], "port: expected one that is free at 127.0.0.1, got 1"),
    ],
)
def test_what_cannot_be_shown_is_one_line(
    folder: Path, capsys: pytest.CaptureFixture[str], words: list[str], message: str
) -> None:
    """Exit code 2 and what to do."""
    if words[0] == "--port" and os.geteuid() == 0:
        pytest.skip("root may serve at any port")
    assert run(["view", str(folder), *words]) == 2
    assert message in capsys.readouterr().err


def test_a_folder_of_before_says_what_to_do(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without the scene that compare keeps now, there is nothing to show."""
    old = tmp_path / "old"
    (old / "frames").mkdir(parents=True)
    for name in ("comparison.json", "runs.parquet", "frames/full.parquet"):
        (old / name).write_bytes((folder / name).read_bytes())
    assert run(["view", str(old)]) == 2
    told = capsys.readouterr().err
    assert told.startswith("error: expected frame logs that keep levels, got none; run `lodbench")


@pytest.mark.slow
def test_it_serves_until_it_is_interrupted(folder: Path) -> None:
    """The address that is printed answers with the page, and Ctrl-C ends it, which is no error."""
    command = [sys.executable, "-m", "lodbench", "view", str(folder), "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        try:
            assert process.stdout is not None
            url = json.loads(process.stdout.readline())["url"]
            assert url.startswith("http://127.0.0.1:")
            with urllib.request.urlopen(url, timeout=10) as answer:
                assert b"<title>atlas along tour" in answer.read()
            process.send_signal(signal.SIGINT)
            assert process.wait(timeout=20) == 0
            assert process.stderr is not None
            assert process.stderr.read() == b""
        finally:
            process.kill()
