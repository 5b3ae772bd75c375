"""Pickles for other processes: by name where that leads somewhere, else by value."""

import importlib.util
import subprocess
import sys
from pathlib import Path
from typing import Any

import cloudpickle
import numpy as np
import pytest

from lodbench.base.portable_pickle import portable_pickle
from lodbench.policies.bounds.full import Full

HELPED = "FACTOR = 3\ndef helper(x): return FACTOR * x\nclass Mine:\n    value = helper(7)\n"
LOAD = "import pickle, sys; print(pickle.load(sys.stdin.buffer)(14))"


def module_of(path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return a module that was loaded from a file under a name, as test runners do."""
    path.write_text(HELPED, encoding="utf-8")
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, name, module)
    spec.loader.exec_module(module)
    return module


def loaded(data: bytes) -> str:
    """Return what another process prints of a function that it unpickles and calls with 14."""
    run = subprocess.run([sys.executable, "-c", LOAD], input=data, capture_output=True)
    return run.stdout.decode().strip() or run.stderr.decode()


def test_a_module_that_nobody_finds_travels_by_value(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A function of a module that has a name but no place on the path, with all that it uses."""
    module = module_of(tmp_path / "mine.py", "module_of_no_path", monkeypatch)
    assert loaded(portable_pickle(module.helper)) == "42"
    assert module not in cloudpickle.list_registry_pickle_by_value()


def test_a_name_that_leads_elsewhere_does_not_count(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A module under the name of an installed one is not what another process finds there."""
    module = module_of(tmp_path / "colorsys.py", "colorsys", monkeypatch)
    assert loaded(portable_pickle(module.helper)) == "42"


def test_what_can_be_imported_goes_by_name() -> None:
    """A class of an installed module is its name, and not its code."""
    data = portable_pickle(Full)
    assert len(data) < 100
    assert b"lodbench.policies.bounds.full" in data


def test_arrays_can_be_taken_out() -> None:
    """With a callback arrays are handed over as they are, and the pickle is small."""
    array, taken = np.arange(10_000.0), list[Any]()
    data = portable_pickle({"a": array}, taken.append)
    assert len(data) < 1000
    assert [buffer.raw().nbytes for buffer in taken] == [array.nbytes]
