"""The engine that a study is carried out on."""

from ....base.errors import require_whole
from .limits import Limits
from .local.launch import SERVER
from .local.local_engine import LocalEngine
from .task import Engine, Inputs


def open_engine(
    inputs: Inputs,
    *,
    workers: int = 0,
    limits: Limits | None = None,
    scheduler: str | None = None,
) -> Engine:
    """Return an engine, to be entered, for tasks that share these inputs.

    Raises `InputError` if there is no such engine, or there are to be fewer than no workers.

    Parameters
    ----------
    workers
        Processes; 0 for as many as there are processors.
    limits
        What a policy may take.
    scheduler
        Address of a Dask scheduler (see `Cluster`); None for this machine.
    """
    require_whole(workers, "workers", 0)  # with fewer, tasks would wait for ever
    if scheduler is not None:
        from .cluster.dask_engine import DaskEngine

        return DaskEngine(inputs, scheduler, limits)
    return LocalEngine(inputs, workers, limits)


def prepare_engine(scheduler: str | None = None) -> None:
    """Start what an engine waits for, so that it loads while the caller loads its scene.

    Raises `InputError` if a scheduler is given that cannot be one.
    """
    if scheduler is None:
        SERVER.warm_up()
        return
    from .cluster.dask_cluster import require_cluster

    require_cluster(scheduler)
