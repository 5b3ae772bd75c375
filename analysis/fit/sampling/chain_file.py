"""A chain on disk, so that a long run goes on where it was interrupted.

emcee's own file backend needs HDF5; this one is a ``.npz`` with the chain, the acceptances and the
state of the random generator.
"""

import zipfile
from pathlib import Path
from typing import Any

import emcee
import numpy as np

from ....base.errors import InputError
from ....base.files.whole_file import whole_file
from ....base.reader_guard import guarded

_MOST_BYTES = 1 << 30  # of a chain; members are stored as they are, so its file has as many
_WHAT, _ADVICE = "a chain that `lodbench fit --resume` wrote", "name another"
_KEYS = ("chain", "log_prob", "accepted", "random_keys", "random_rest", "identity")


def save_chain(backend: Any, path: Path, identity: str) -> None:
    """Write an emcee backend, all or nothing.

    Parameters
    ----------
    identity
        What the chain is of: log, model, seed.  `load_chain` refuses another.
    """
    name, keys, position, has_gauss, gauss = backend.random_state
    assert name == "MT19937"
    with whole_file(path) as partial, partial.open("wb") as file:
        np.savez(
            file,
            chain=backend.get_chain(),
            log_prob=backend.get_log_prob(),
            accepted=backend.accepted,
            random_keys=keys,
            random_rest=np.array([position, has_gauss, gauss], dtype=np.float64),
            identity=np.array(identity),
        )


def load_chain(path: Path, identity: str) -> Any:
    """Return an emcee backend with the chain of a file; an empty one if there is no file yet.

    Raises `InputError` if the file is no such chain, or of another log, model or seed.
    """
    backend: Any = emcee.backends.Backend()
    if not path.exists():
        return backend
    with guarded(path, _WHAT, _ADVICE):
        held = _members(path)
        if str(held["identity"]) != identity:
            message = (
                "expected a chain of this log, model, terms, walkers and seed, got one of others"
            )
            raise InputError(f"{message}; name another file, or remove it", path=path)
        return _restored(backend, held)


def _members(path: Path) -> dict[str, Any]:
    """Return the arrays of a chain's file, after a look at what they take."""
    if not zipfile.is_zipfile(path):
        raise InputError(f"expected {_WHAT}, got another kind of file; {_ADVICE}")
    with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
        members = arrays.zip.infolist()
        if sum(member.file_size for member in members) > min(_MOST_BYTES, path.stat().st_size):
            raise InputError(f"expected {_WHAT}, got a compressed or larger one; {_ADVICE}")
        return {key: arrays[key] for key in _KEYS}


def _restored(backend: Any, held: dict[str, Any]) -> Any:
    steps, walkers, width = held["chain"].shape
    backend.reset(walkers, width)
    backend.grow(steps, None)
    backend.chain[:], backend.log_prob[:] = held["chain"], held["log_prob"]
    backend.accepted[:] = held["accepted"]
    backend.iteration = steps
    position, has_gauss, gauss = held["random_rest"].tolist()
    keys = held["random_keys"].astype(np.uint32)
    backend.random_state = ("MT19937", keys, int(position), int(has_gauss), gauss)
    return backend
