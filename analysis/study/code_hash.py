"""Which code made a result: hashes of lodbench's own sources, and of a user's policy."""

import hashlib
import inspect
import sys
import sysconfig
from collections.abc import Sequence
from functools import cache
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

from ...base.content_hash import SIZE_BYTES, content_hash
from ...base.foreign_text import describe_error
from ...base.portable_pickle import portable_pickle
from ...policies.policy_spec import PolicySpec

_ROOT = Path(__file__).parents[2]
_ROOMS = ("base", "models", "traces", "policies", "sim", "analysis/metrics", "analysis/study")
"""What decides the numbers of a run; pages, gates and commands do not."""


_RUN_LIBRARIES = ("numpy", "scipy", "casadi")
"""What computes those numbers beside Python; another version may do it otherwise."""
_PAGE_LIBRARIES = ("pillow", "pyarrow", "jinja2")


@cache
def code_hash() -> str:
    """Return the hash of the sources that decide what a run results in."""
    return _hash_sources(_ROOMS, "*.py", _RUN_LIBRARIES)


@cache
def package_hash() -> str:
    """Return the hash of all sources: of what makes answers and pages of results, too."""
    rooms = ("base", "models", "traces", "policies", "sim", "render", "analysis")
    return _hash_sources(rooms, "*.*", (*_RUN_LIBRARIES, *_PAGE_LIBRARIES))


def _hash_sources(rooms: Sequence[str], pattern: str, libraries: Sequence[str]) -> str:
    digest = hashlib.blake2b(digest_size=SIZE_BYTES)
    for name in libraries:
        digest.update(f"{name} {version(name)}\n".encode())
    for room in rooms:
        for path in sorted((_ROOT / room).rglob(pattern)):
            if path.suffix != ".pyc":
                digest.update(str(path.relative_to(_ROOT)).encode())
                digest.update(path.read_bytes())
    return digest.hexdigest()


def policy_hash(spec: PolicySpec) -> str:
    """Return the hash of a policy: its class, its parameters, and the user's code it is made of.

    That code is the file of the class and the user's modules that it uses.  What a policy reads
    while it runs, such as a file of weights, is not known.

    Raises TypeError if there is no content to tell it by, such as of an object that holds a
    function.
    """
    cls = spec.cls
    made = None if spec.made is None else spec.made.__getstate__()
    named = (cls.__module__, cls.__qualname__, spec.label)
    return content_hash(*named, _source(cls), spec.params, made)


@cache
def _source(cls: type) -> str:
    """Return the sources of a user's class and of what it is made from; ours have `code_hash`."""
    users = [kind for kind in cls.__mro__[:-1] if not kind.__module__.startswith("lodbench.")]
    modules = {module for kind in users if (module := inspect.getmodule(kind)) is not None}
    try:
        # A notebook's cell has no file; of what has, all counts, as its other functions matter too.
        cells = [inspect.getsource(kind) for kind in users if inspect.getmodule(kind) is None]
        return "\n".join([*cells, *_texts(modules)])
    except (TypeError, OSError):
        return _code(cls)


def _code(cls: type) -> str:
    """Return the code itself, which is all that is left of what was typed into a prompt."""
    try:
        return portable_pickle(cls).hex()
    except Exception as error:  # whatever the state of a user's class raises
        raise TypeError(f"no content to hash: {cls.__name__}: {describe_error(error)}") from error


def _texts(modules: set[ModuleType]) -> list[str]:
    """Return the texts of modules, and of the user's own modules whose names they use."""
    found: dict[str, str] = {}
    waiting = list(modules)
    while waiting:
        module = waiting.pop()
        if module.__name__ in found:
            continue
        found[module.__name__] = inspect.getsource(module)
        for thing in list(vars(module).values()):
            home = thing if isinstance(thing, ModuleType) else _home(thing)
            if home is not None and _is_users(home):
                waiting.append(home)
    return [found[name] for name in sorted(found)]


def _home(thing: object) -> ModuleType | None:
    name: object = getattr(thing, "__module__", None)
    return sys.modules.get(name) if isinstance(name, str) else None


def _is_users(module: ModuleType) -> bool:
    """Whether a module is neither ours, nor of Python or of what is installed beside it."""
    file: object = getattr(module, "__file__", None)
    if not isinstance(file, str) or module.__name__.partition(".")[0] == "lodbench":
        return False
    return file.endswith(".py") and not any(
        Path(file).is_relative_to(folder) for folder in set(sysconfig.get_paths().values())
    )
