"""Objects in a user's own Python code, named as ``file.py:NAME`` or ``package.module:NAME``."""

import importlib
import importlib.util
import sys
from pathlib import Path
from types import ModuleType

from .errors import InputError


def load_object(text: str, what: str) -> object:
    """Return the object that a user names; `what` it should be is for messages.

    Raises `InputError` if the file or module does not load, or holds no such name.
    """
    where, _, name = text.rpartition(":")
    module = _load_file(Path(where), what) if where.endswith(".py") else _import(where, what)
    if not hasattr(module, name):
        raise InputError(f"{what}: expected a name in {where}, got {name}, which it does not hold")
    return getattr(module, name)


def _load_file(path: Path, what: str) -> ModuleType:
    if not path.is_file():
        raise InputError(f"expected a Python file with a {what}, got no file", path=path)
    # Registered under a name of its own, so that instances pickle and the file stays importable.
    name = f"lodbench_user_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None, "a .py file has a loader"
    assert spec.loader is not None, "a .py file has a loader"
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:  # a script may end with sys.exit()
        line = error.lineno if isinstance(error, SyntaxError) else None
        raise InputError(
            f"expected a Python file that loads, got {type(error).__name__}: {error}",
            path=path,
            line=line,
        ) from error
    return module


def _import(name: str, what: str) -> ModuleType:
    try:
        return importlib.import_module(name)
    except (ImportError, ValueError) as error:  # ValueError: an empty name
        raise InputError(f"{what}: {name or 'no module'}: {error}; is it installed?") from error
