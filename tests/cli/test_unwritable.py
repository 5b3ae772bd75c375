"""What cannot be written is told in one line: before the work, or else after its scores."""

import json
import os
import re
import resource
import subprocess
import sys
from pathlib import Path

import pytest

from lodbench.analysis.study import comparison_folder
from lodbench.cli.main import run

WORLD = ["--scene", "plaza", "--trace", "tour"]
SHORT = ["compare", *WORLD, "--seconds", "0:2", "--workers", "1", "--policy", "full"]
SMALL = [*SHORT, "--scene", "crowd-32", "--trace", "orbit", "--paths", "1"]
ENDLESS = ["--seconds", "0:"]  # a refusal after the work would be noticed

MOVES = """
import shutil
from pathlib import Path
import numpy as np
from lodbench import Capabilities, Selection


class Moves:
    capabilities = Capabilities()

    def reset(self, scene, budget_ms):
        pass

    def select(self, view):
        if view.frame == 40 and Path(PLACE).is_dir():
            shutil.rmtree(PLACE)
            Path(PLACE).write_text("a file now")
        return Selection(view.ids, np.zeros(len(view.ids)))
"""


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("file", "expected a folder to write to, got a file"),
        ("file/run", "expected a folder that can be written to"),
        ("loop", "expected a folder to write to, got a file"),
        ("to-file", "expected a folder to write to, got a file"),
        ("n" * 300, "File name too long"),
        ("/dev/full", "expected a folder to write to, got a file"),
        ("/dev/null/run", "expected a folder that can be written to"),
        ("/proc/run", "expected a folder beside which a lock can be written"),
    ],
)
def test_a_place_for_no_folder_is_told_before_the_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], place: str, message: str
) -> None:
    """A million frames are not begun, and nothing is left behind."""
    (tmp_path / "file").touch()
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "to-file").symlink_to("file")
    before = sorted(path.name for path in tmp_path.iterdir())
    assert run([*SHORT, *ENDLESS, "--out", str(tmp_path / place)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert message in captured.err
    assert sorted(path.name for path in tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    "command",
    [
        ["check", "--policy", "full", *ENDLESS, "--junit"],
        ["check", "--policy", "full", *ENDLESS, "--update-baseline", "--baseline"],
        ["stress", "full", "--evaluations", "1000000", "--out"],
        ["fit", "--bundled", "llvmpipe", "--steps", "1000000", "--out"],
        ["fit", "--bundled", "llvmpipe", "--steps", "1000000", "--resume"],
        ["fit", "--bundled", "llvmpipe", "--steps", "1000000", "--plots"],
    ],
)
def test_other_outputs_are_told_before_the_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: list[str]
) -> None:
    """Each command that works long looks first where its result is to go."""
    (tmp_path / "file").touch()
    (tmp_path / "limits.toml").write_text(
        "population = 'this-path'\n[limits]\nframe_ms_p99 = { max = 50.0, max_increase = '5%' }\n",
        encoding="utf-8",
    )
    limits = ["--limits", str(tmp_path / "limits.toml")] if command[0] == "check" else []
    name = {"stress": "path.csv", "fit": "profile.toml"}.get(command[0], "result")
    assert run([command[0], *limits, *command[1:], str(tmp_path / "file" / name)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert re.search(
        "expected a (folder that can be written to|.toml file in a folder)", captured.err
    )


def test_a_folder_that_another_run_writes_is_told_before_the_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The second of two writers is told which process writes there."""
    code = (
        "import sys, time\n"
        "from pathlib import Path\n"
        "from lodbench.base.files.folder_lock import locked\n"
        "with locked(Path(sys.argv[1])):\n"
        "    print('held', flush=True)\n"
        "    time.sleep(60)\n"
    )
    folder = tmp_path / "run"
    with subprocess.Popen(
        [sys.executable, "-c", code, str(folder)], stdout=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()
        assert run([*SHORT, *ENDLESS, "--out", str(folder)]) == 2
        process.kill()
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert f"got one that process {process.pid} on" in error
    assert run([*SHORT, "--out", str(folder)]) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


@pytest.mark.parametrize("how", ["table", "json"])
def test_a_full_disk_is_told_after_the_scores(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    how: str,
) -> None:
    """The limit on file sizes stands for a disk that is full by then; the earlier result stays."""
    monkeypatch.setenv("LODBENCH_CACHE", str(tmp_path / "cache"))
    folder = tmp_path / "results" / "run"
    assert run([*SMALL, "--out", str(folder)]) == 0
    before = (folder / "comparison.json").read_bytes()
    capsys.readouterr()
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    names = comparison_folder.frame_log_names

    def names_on_a_full_disk(labels: list[str]) -> dict[str, str]:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))  # the replays are done
        return names(labels)

    monkeypatch.setattr(comparison_folder, "frame_log_names", names_on_a_full_disk)
    try:
        as_json = ["--json"] if how == "json" else []
        assert run([*SMALL, *as_json, "--seed", "7", "--out", str(folder)]) == 2
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    captured = capsys.readouterr()
    assert captured.err == (
        f"error: {folder / 'frames' / 'full.parquet'}: expected a path that can be written, "
        "got File too large; check the folder\n"
    )
    if how == "json":
        assert json.loads(captured.out)["seed"] == 7
    else:
        assert re.search(r"^ *(1|misses) +full ", captured.out, re.MULTILINE)
        assert "report:" not in captured.out
    assert (folder / "comparison.json").read_bytes() == before
    # The runs are kept, so that only the writing is done again where there is room.
    unfinished = folder.with_name(".lodbench-run.unfinished")
    assert set(folder.parent.iterdir()) == {folder, unfinished}
    monkeypatch.setattr(comparison_folder, "frame_log_names", names)
    assert run([*SMALL, "--seed", "7", "--out", str(folder)]) == 0
    assert list(folder.parent.iterdir()) == [folder]


def test_a_folder_that_vanishes_is_told_after_the_scores(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The folder that was to hold the result becomes a file in the midst of the replay."""
    parent, mine = tmp_path / "results", tmp_path / "mine.py"
    parent.mkdir()
    mine.write_text(f"PLACE = {str(parent)!r}\n{MOVES}", encoding="utf-8")
    assert run([*SHORT[:-1], f"{mine}:Moves", "--json", "--out", str(parent / "run")]) == 2
    captured = capsys.readouterr()
    assert json.loads(captured.out)["policies"][0]["status"] == "ok"
    assert captured.err.count("\n") == 1
    assert "expected a folder that can be written to" in captured.err
    assert parent.read_text(encoding="utf-8") == "a file now"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("arguments", [["list", "policies"], ["--help"], ["list", "scenes"]])
def test_output_that_leads_to_a_full_disk(arguments: list[str]) -> None:
    """Standard output on a disk without room ends with 2 and one line, not with a traceback."""
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        done = subprocess.run(
            [sys.executable, "-m", "lodbench", *arguments],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
        )
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith("error: expected a disk with room for the output, got No space")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("variable", "place"),
    [
        ("HOME", "/dev/null/x"),
        ("HOME", "loop"),
        ("XDG_CACHE_HOME", "/proc/x"),
        ("LODBENCH_CACHE", "file/x"),
    ],
)
def test_a_cache_that_cannot_be_is_passed_by(tmp_path: Path, variable: str, place: str) -> None:
    """The scene is made in memory, which a line on stderr says, and the scores are there."""
    (tmp_path / "file").touch()
    (tmp_path / "loop").symlink_to("loop")
    unset = {"HOME", "LODBENCH_CACHE", "XDG_CACHE_HOME"}
    environment = {key: value for key, value in os.environ.items() if key not in unset}
    done = subprocess.run(
        [sys.executable, "-m", "lodbench", *SMALL],
        env={**environment, variable: str(tmp_path / place)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0
    assert re.search(r"^ *(1|misses) +full ", done.stdout, re.MULTILINE)
    assert done.stderr.count("\n") == 1
    assert "cannot be written to; name another folder in LODBENCH_CACHE" in done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "loop"]
