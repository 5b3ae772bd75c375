"""Files damaged in any way are read, or refused in one line, quickly and in little memory."""

import json
import os
import random
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest
from damage import KINDS, damage
from damage_run import READERS, damaged, judge, read_one, run_seed, table_of
from seed import ROOT, Seed, one_file

from lodbench.analysis.study.comparison import read_comparison
from lodbench.models.gltf.gltf_lod import read_gltf_scene
from lodbench.models.meshes.mesh_error import Sampling

EACH_IN_FULL, EACH = 145, 4
"""Of 83 seeds, 24 of which need the real data: 12,035 files; and what CI has time for."""


@pytest.mark.slow
@pytest.mark.study
def test_damaged_files_of_all_formats(tmp_path: Path, full_studies: bool) -> None:
    """No traceback, nothing over 2 s or 1 GB, no warning leaked, one printable line of error."""
    results = tmp_path / "results.jsonl"
    each = EACH_IN_FULL if full_studies else EACH
    script = ROOT / "tests" / "damaged" / "damage_run.py"
    words = [sys.executable, str(script), "--each", str(each), "--results", str(results)]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    found = [json.loads(line) for line in results.read_text().splitlines()]
    seeds = {(result["family"], result["name"]) for result in found}
    assert len(seeds) >= 59
    assert len(found) == each * len(seeds)
    refused = sum(result["code"] == 2 for result in found)
    assert 0.3 < refused / len(found) < 0.9  # damage is neither all seen at once nor none


_READ_BY = {
    "chain": ("chain",),
    "comparison": ("comparison",),
    "frames": ("frame log",),
    "gltf": ("glTF",),
    "lodscene": ("scene", "info", "@"),
    "mesh": ("scene", "build", "@", "--out", "out.lodscene", "--levels", "2", "--count", "3"),
    "log": ("log", "info", "@"),
    "chrometrace": ("log", "info", "@"),
    "trace": ("trace", "info", "@"),
}


@pytest.mark.realdata
@pytest.mark.slow
def test_real_damaged_files_are_read_or_refused_in_one_line(
    data_dir: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """Files that earlier versions crashed on, took seconds for, or told of in odd letters."""
    monkeypatch.chdir(tmp_path)
    few = Sampling(vertices=500, surface=500)  # errors of levels are not what is asked
    monkeypatch.setitem(READERS, "glTF", lambda path: read_gltf_scene(path, few))
    monkeypatch.setitem(READERS, "comparison", read_comparison)
    files = sorted((data_dir / "wild" / "damaged").iterdir())
    for file in files:
        command = _READ_BY[file.name.partition("-")[0]]
        seed = one_file("damaged", file.name, file.read_bytes(), "bytes", *command)
        path = Path(next(iter(seed.files)))
        path.write_bytes(file.read_bytes())
        began = time.process_time()
        code = read_one(seed, path)
        seconds = time.process_time() - began
        out, err = capfd.readouterr()
        assert judge(code, out, err, seconds, 0) == [], file.name
    assert len(files) >= 53


def _raise(_: Path) -> None:
    raise KeyError("mesh")


def _warn(_: Path) -> None:
    warnings.warn("odd file", UserWarning, stacklevel=1)


def _speak(_: Path) -> None:
    os.write(2, b"libfoo: bad chunk\n")


def _move_the_cursor(_: Path) -> None:
    print("\x1b[2J")


def _ramble(_: Path) -> None:
    print("error: " + "x" * 400, file=sys.stderr)


def _die(_: Path) -> None:
    os._exit(3)


def _bloat(_: Path) -> None:
    assert len(b"x" * 1_200_000_000) > 0


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize(
    ("reader", "says"),
    [
        (_raise, "traceback: KeyError: 'mesh'"),
        (_warn, "UserWarning: odd file"),
        (_speak, "leaked: libfoo: bad chunk"),
        (_move_the_cursor, "control characters"),
        (_ramble, "a line of 407 characters"),
        (_die, "the process ended with 3"),
        pytest.param(_bloat, "MiB", marks=pytest.mark.slow),
    ],
)
def test_what_a_reader_must_not_do_is_found(
    reader: Callable[[Path], None], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each fault of a reader, on the second damaged file alone, is told of that file alone."""
    seed = one_file("faults", "f.txt", "\n".join(map(str, range(99))), "text", "faulty")
    second = damaged(seed, 1)["f.txt"]
    monkeypatch.setitem(
        READERS,
        "faulty",
        lambda path: reader(path) if path.read_bytes() == second else None,
    )
    found = list(run_seed(seed, 3, tmp_path))
    assert [bool(result["wrong"]) for result in found] == [False, True, False]
    assert any(says in wrong for wrong in found[1]["wrong"])
    assert "| faults | 1 | 3 | 2 | 0 | 1 |" in table_of(found)


@pytest.mark.parametrize(
    ("code", "err", "seconds", "wrong"),
    [
        (2, "error: f.csv: expected a, got b", 0.1, []),
        (0, "note: this\nwarning: that\n", 0.1, []),
        (1, "", 0.1, ["exit code 1"]),
        (2, "", 0.1, ["no line of error"]),
        (2, "error: a\nerror: b\n", 0.1, ["several errors"]),
        (0, "", 2.5, ["2.5 s"]),
    ],
)
def test_what_is_judged(code: int, err: str, seconds: float, wrong: list[str]) -> None:
    """Exit code 0 or 2, one error if 2, and nothing on stderr but our own lines."""
    assert judge(code, "", err, seconds, 1 << 20) == wrong


@pytest.mark.parametrize("kind", KINDS)
def test_damage_is_the_same_by_seed_and_seldom_none(kind: str) -> None:
    """A number of a seed is one file on any day; nearly all differ from the whole one."""
    whole = json.dumps({"a": [1.5, 2], "b": {"c": "x"}, "rows": ["1,2", "3,4"]}).encode()
    seed = Seed("f", kind, {"f": whole * 3 if kind != "json" else whole}, {"f": kind}, ())
    made = [damaged(seed, number)["f"] for number in range(50)]
    assert made == [damaged(seed, number)["f"] for number in range(50)]
    assert sum(data != seed.files["f"] for data in made) >= 45
    assert len(set(made)) >= 40


def test_damage_takes_what_is_already_damaged() -> None:
    """Two injuries in a row: the second meets what is no longer of the format."""
    for kind in KINDS:
        for number in range(50):
            damage(b"\xff{", kind, random.Random(number))
            damage(b"", kind, random.Random(number))
