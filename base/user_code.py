"""A user's own Python code, named as ``file.py:NAME`` or ``package.module:NAME``.

A file is loaded under a module name made of its path and content.  So two files of one name live
side by side, an edited file is loaded anew, and what was made before the edit keeps its class.
"""

import hashlib
import importlib
import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType

from .errors import InputError
from .foreign_text import describe_error
from .nearest_names import unknown_name

_PREFIX = "lodbench_user_"


def load_object(text: str, what: str) -> object:
    """Return the object that a user names; `what` it should be is for messages.

    Raises `InputError` if the file or module does not load, or holds no such name.
    """
    where, _, name = text.rpartition(":")
    module = load_file(Path(where), what) if where.endswith(".py") else _import(where, what)
    if not hasattr(module, name):
        own = module.__name__
        public = [
            known
            for known, thing in vars(module).items()
            if not known.startswith("_")
            and getattr(thing, "__module__", own) == own
            and not isinstance(thing, ModuleType)
        ]
        raise InputError(f"{what} of {where}: {unknown_name(name, public)}")
    return getattr(module, name)


def load_file(path: Path, what: str) -> ModuleType:
    """Return the module that a user's file makes; `what` it should hold is for messages.

    Raises `InputError` if it does not load.
    """
    if not path.is_file():
        raise InputError(f"expected a Python file with a {what}, got no file", path=path)
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
            f"expected a Python file that loads, got {describe_error(error)}",
            path=path,
            line=line,
        ) from error
    return module


def file_of(module: str) -> Path | None:
    """Return the file that a module was made of by `load_file`, None for any other module."""
    if not module.startswith(_PREFIX):
        return None
    file = sys.modules[module].__file__
    assert file is not None, "a user's module is of a file"
    return Path(file).resolve()


def _module_name(path: Path) -> str:
    digest = hashlib.sha256(str(path.resolve()).encode())
    digest.update(path.read_bytes())
    stem = re.sub(r"\W", "_", path.stem)
    return f"{_PREFIX}{stem}_{digest.hexdigest()[:12]}"


def _import(name: str, what: str) -> ModuleType:
    try:
        return importlib.import_module(name)
    except (ImportError, ValueError) as error:  # ValueError: an empty name
        raise InputError(f"{what}: {name or 'no module'}: {error}; is it installed?") from error
