"""Classes of a user's own file, here and in other processes.

A file is loaded under a module name made of its path and content.  So two files of one name live
side by side, an edited file is loaded anew, and policies made before the edit keep their class.
"""

import hashlib
import importlib.util
import io
import pickle
import re
import sys
import types
from operator import attrgetter
from pathlib import Path
from typing import Any

from ..base.errors import InputError

_PREFIX = "lodbench_user_"


def load_user_file(path: Path) -> types.ModuleType:
    """Return the module of a Python file, loaded once for each content.

    Raises `InputError` if there is no such file, or it does not load.
    """
    if not path.is_file():
        raise InputError("expected a Python file with a policy, got no file", path=path)
    name = _module_name(path)
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None, "a .py file has a loader"
    assert spec.loader is not None, "a .py file has a loader"
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their module up while it is executed
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:  # a script may end with sys.exit()
        del sys.modules[name]
        line = error.lineno if isinstance(error, SyntaxError) else None
        raise InputError(
            f"expected a Python file that loads, got {type(error).__name__}: {error}",
            path=path,
            line=line,
        ) from error
    return module


def pickle_for_worker(value: object) -> bytes:
    """Return the pickle of a value, which loads users' files wherever it is unpickled."""
    buffer = io.BytesIO()
    _Pickler(buffer, protocol=5).dump(value)
    return buffer.getvalue()


class _Pickler(pickle.Pickler):
    """Refers to a class or function of a user's file by its path: no import would lead there."""

    def reducer_override(self, obj: Any) -> Any:
        if not isinstance(obj, (type, types.FunctionType)):
            return NotImplemented
        if not str(obj.__module__).startswith(_PREFIX):
            return NotImplemented
        file = sys.modules[obj.__module__].__file__
        assert file is not None, "a user's module is of a file"
        return _find_in_file, (str(Path(file).resolve()), obj.__qualname__)


def _find_in_file(path: str, name: str) -> object:
    return attrgetter(name)(load_user_file(Path(path)))


def _module_name(path: Path) -> str:
    digest = hashlib.sha256(str(path.resolve()).encode())
    digest.update(path.read_bytes())
    stem = re.sub(r"\W", "_", path.stem)
    return f"{_PREFIX}{stem}_{digest.hexdigest()[:12]}"
