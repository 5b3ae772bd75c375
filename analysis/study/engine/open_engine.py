"""The engine that a study is carried out on."""

from ....base.errors import InputError
from .launch import SERVER
from .limits import Limits
from .local_engine import LocalEngine
from .task import Engine, Inputs


def open_engine(
    inputs: Inputs,
    *,
    workers: int = 0,
    limits: Limits | None = None,
    scheduler: str | None = None,
) -> Engine:
    """Return an engine, to be entered, for tasks that share these inputs.

    Raises `InputError` if there is no such engine.

    Parameters
    ----------
    workers
        Processes; 0 for as many as there are processors.
    limits
        What a policy may take.
    scheduler
        Address of a Dask scheduler; None for this machine.
    """
    if scheduler is not None:
        raise InputError("--scheduler: expected the extra cluster; install lodbench[cluster]")
    return LocalEngine(inputs, workers, limits)


def prepare_engine() -> None:
    """Start what an engine here waits for, so that it loads while the caller loads its scene."""
    SERVER.warm_up()
