"""Users' files: loaded once for each content, side by side, and found again in other processes."""

import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from lodbench.base.errors import InputError
from lodbench.base.portable_pickle import portable_pickle
from lodbench.base.user_code import load_object


def mine_of(path: Path, value: int) -> Any:
    """Write a file with a class of one attribute; return the class."""
    path.parent.mkdir(exist_ok=True)
    path.write_text(f"class Mine:\n    value = {value}\n    class Inner: pass\n", encoding="utf-8")
    return load_object(f"{path}:Mine", "policy")


def test_files_of_one_name_live_side_by_side(tmp_path: Path) -> None:
    """Two files of one name are two modules; one that did not change is loaded once."""
    first = mine_of(tmp_path / "a" / "mine.py", 1)
    second = mine_of(tmp_path / "b" / "mine.py", 2)
    assert (first.value, second.value) == (1, 2)
    assert load_object(f"{tmp_path / 'a' / 'mine.py'}:Mine", "policy") is first
    for cls in (first, second):
        assert pickle.loads(pickle.dumps(cls)) is cls


def test_an_edited_file_is_loaded_anew(tmp_path: Path) -> None:
    """After an edit the name leads to the new class, and the old one is as it was."""
    old = mine_of(tmp_path / "mine.py", 1)
    new = mine_of(tmp_path / "mine.py", 2)
    assert (old.value, new.value) == (1, 2)


def test_what_a_file_does_while_it_is_loaded(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What it prints is not on stdout, where results are; whatever it raises is one error."""
    path = tmp_path / "mine.py"
    path.write_text("print('noise')\nraise BaseException('mine')\n", encoding="utf-8")
    with pytest.raises(InputError, match="a Python file that loads, got BaseException: mine"):
        load_object(f"{path}:Mine", "policy")
    assert capsys.readouterr() == ("", "noise\n")


def test_another_process_finds_the_file(tmp_path: Path) -> None:
    """An object pickled for a worker is unpickled where its file was never loaded."""
    mine = mine_of(tmp_path / "mine.py", 7)
    data = portable_pickle((mine(), mine.Inner))
    script = "import pickle, sys; a, b = pickle.load(sys.stdin.buffer); print(a.value, b.__name__)"
    run = subprocess.run([sys.executable, "-c", script], input=data, capture_output=True)
    assert run.stdout.split() == [b"7", b"Inner"], run.stderr


def test_the_source_travels_with_the_object(tmp_path: Path) -> None:
    """A pickle loads where the file never was; its class keeps its lines, and is made once."""
    path = tmp_path / "mine.py"
    mine = mine_of(path, 7)
    data = portable_pickle([mine(), mine, mine.Inner])
    path.unlink()
    script = (
        "import inspect, pickle, sys; data = sys.stdin.buffer.read()\n"
        "(one, cls, _), again = pickle.loads(data), pickle.loads(data)\n"
        "print(one.value, again[1] is cls, inspect.getsource(cls).splitlines()[1].strip())"
    )
    run = subprocess.run([sys.executable, "-c", script], input=data, capture_output=True)
    assert run.stdout.decode().split() == ["7", "True", "value", "=", "7"], run.stderr


def test_what_is_pickled_is_what_was_loaded(tmp_path: Path) -> None:
    """An edit after loading reaches neither the class nor its pickles."""
    mine = mine_of(tmp_path / "mine.py", 1)
    (tmp_path / "mine.py").write_text("1 / 0\n", encoding="utf-8")
    data = portable_pickle(mine)
    script = "import pickle, sys; print(pickle.load(sys.stdin.buffer).value)"
    run = subprocess.run([sys.executable, "-c", script], input=data, capture_output=True)
    assert run.stdout.split() == [b"1"], run.stderr


def test_errors_of_input_travel_between_processes() -> None:
    """An error that is raised in a worker arrives whole, with its path and line."""
    error = pickle.loads(pickle.dumps(InputError("expected x", path="a.py", line=3)))
    assert (str(error), error.path, error.line) == ("a.py:3: expected x", "a.py", 3)


def test_what_does_not_load_leaves_nothing(tmp_path: Path) -> None:
    """A broken file is refused each time that it is named, and a missing name with the nearest."""
    path = tmp_path / "broken.py"
    path.write_text("1 / 0\n", encoding="utf-8")
    for _ in range(2):
        with pytest.raises(InputError, match="got ZeroDivisionError"):
            load_object(f"{path}:Mine", "policy")
    mine_of(tmp_path / "mine.py", 1)
    with pytest.raises(InputError, match="did you mean Mine"):
        load_object(f"{tmp_path / 'mine.py'}:Min", "policy")
