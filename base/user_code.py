"""A user's own Python code, named as ``file.py:NAME`` or ``package.module:NAME``.

A file is loaded under a module name made of its path and content.  So two files of one name live
side by side, an edited file is loaded anew, and what was made before the edit keeps its class.
The source is kept with the module, for machines that do not have the file.
"""

import hashlib
import importlib
import importlib.util
import re
import sys
from contextlib import redirect_stdout
from importlib.abc import SourceLoader
from pathlib import Path
from types import ModuleType

from .errors import InputError
from .foreign_text import describe_error
from .nearest_names import unknown_name
from .rehearsal import rehearse

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
    source = path.read_bytes()
    name = _module_name(path, source)
    if name not in sys.modules:
        rehearse(lambda: load_source(name, str(path), source), path)
    return load_source(name, str(path), source)


def load_source(name: str, path: str, source: bytes) -> ModuleType:
    """Return the module of that name, made of the source of a file unless there is one already.

    Raises `InputError` if it does not load.
    """
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_loader(name, _Source(path, source))
    assert spec is not None, "a loader of sources says what it loads"
    assert spec.loader is not None, "the one that it was made with"
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their module up while it is executed
    try:
        with redirect_stdout(sys.stderr):  # what a command prints on stdout is its result alone
            spec.loader.exec_module(module)
    except BaseException as error:  # a script may end with sys.exit(), and raise anything
        del sys.modules[name]
        if isinstance(error, KeyboardInterrupt):
            raise
        line = error.lineno if isinstance(error, SyntaxError) else None
        raise InputError(
            f"expected a Python file that loads, got {describe_error(error)}",
            path=path,
            line=line,
        ) from error
    return module


def source_of(module: str) -> tuple[str, bytes] | None:
    """Return path and source of a module that `load_file` made, None for any other module."""
    loader = getattr(sys.modules.get(module), "__loader__", None)
    return (loader.path, loader.source) if isinstance(loader, _Source) else None


class _Source(SourceLoader):
    """Loads a file as it was when it was read: it may be edited, or be on another machine."""

    def __init__(self, path: str, source: bytes) -> None:
        self.path, self.source = path, source

    def get_filename(self, fullname: str) -> str:
        return self.path

    def get_data(self, path: str) -> bytes:
        return self.source


def _module_name(path: Path, source: bytes) -> str:
    digest = hashlib.sha256(str(path.resolve()).encode())
    digest.update(source)
    stem = re.sub(r"\W", "_", path.stem)
    return f"{_PREFIX}{stem}_{digest.hexdigest()[:12]}"


def _import(name: str, what: str) -> ModuleType:
    try:
        return importlib.import_module(name)
    except (ImportError, ValueError) as error:  # ValueError: an empty name
        raise InputError(f"{what}: {name or 'no module'}: {error}; is it installed?") from error
