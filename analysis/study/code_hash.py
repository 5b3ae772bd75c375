"""Which code made a result: hashes of lodbench's own sources, and of a user's policy."""

import hashlib
import inspect
from collections.abc import Sequence
from functools import cache
from importlib.metadata import version
from pathlib import Path

from ...base.content_hash import SIZE_BYTES, content_hash
from ...policies.policy_spec import PolicySpec

_ROOT = Path(__file__).parents[2]
_ROOMS = ("base", "models", "traces", "policies", "sim", "analysis/metrics", "analysis/study")
"""What decides the numbers of a run; pages, gates and commands do not."""


_RUN_LIBRARIES = ("numpy", "scipy", "casadi")
"""What computes those numbers beside Python; another version may do it otherwise."""
_PAGE_LIBRARIES = ("plotly", "pyarrow", "jinja2")


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
    """Return the hash of a policy: its class, that class's source, and its parameters.

    Raises TypeError or OSError if there is no content to tell it by, such as of a class that was
    typed into a prompt, or of an object that holds a function.
    """
    cls = spec.cls
    made = None if spec.made is None else spec.made.__getstate__()
    named = (cls.__module__, cls.__qualname__, spec.label)
    return content_hash(*named, _source(cls), spec.params, made)


def _source(cls: type) -> str:
    """Return the sources of the class and of those it is made from; ours count by `code_hash`."""
    users = [kind for kind in cls.__mro__[:-1] if not kind.__module__.startswith("lodbench.")]
    # The whole file, as its other functions matter too; a notebook's cell has no file.
    return "\n".join(inspect.getsource(inspect.getmodule(kind) or kind) for kind in users)
