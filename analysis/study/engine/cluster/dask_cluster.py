"""A Dask cluster that the user has, by the address of its scheduler.

Everything else is Dask's own configuration: certificates of `tls://` in `distributed.comm.tls`,
time limits in `distributed.comm.timeouts`.
"""

import asyncio
import concurrent.futures
import json
import logging
import queue
import threading
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from .....base.errors import InputError
from .dask_worker import mismatch
from .versions import describe_difference, versions_here

CONNECT_S = 10.0
"""Wall time for which a scheduler is tried when a study starts."""
RECONNECT_S = 60.0
"""Wall time for which a scheduler that has gone is tried again."""
FROM_CONFIG = "config"

LOST = (
    OSError,
    TimeoutError,
    RuntimeError,
    asyncio.CancelledError,
    concurrent.futures.CancelledError,
)
"""What Dask raises where a connection ends under it: an `OSError` or whatever that leads to."""

_SLACK_S = 1.0  # after which a time limit that Dask was given is taken to have failed
_SLOTS_S = 2.0  # for which the number of threads of a cluster is taken to be as it was


class Cluster:
    """A connection to a cluster, which can be made anew.

    Parameters
    ----------
    scheduler
        ``tcp://HOST:PORT``, ``tls://HOST:PORT`` or any other address that Dask knows, the file that
        ``dask scheduler --scheduler-file`` writes, or "config" for the address in Dask's own
        configuration.

    Attributes
    ----------
    client : distributed.Client or None
    versions : Versions
        What workers have to have.
    """

    def __init__(self, scheduler: str) -> None:
        self.scheduler = scheduler
        self.client: Any = None
        self.versions = versions_here()
        self._slots = 1
        self._slots_until = 0.0

    def connect(self, within_s: float | None = None) -> None:
        """Reach the scheduler.

        Raises `InputError` if it cannot be reached within the time given, else `CONNECT_S`.
        """
        within_s = CONNECT_S if within_s is None else within_s
        client_class = _import_distributed().Client
        address = _address_of(self.scheduler)

        def open_client() -> Any:
            return client_class(address, timeout=within_s, set_as_default=False, name="lodbench")

        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # other versions of Dask, which it puts up with
                self.client = _within(within_s, open_client)
        except (*LOST, ValueError, TypeError, ImportError) as error:
            raise self._unreachable(error) from error

    def reconnect(self) -> None:
        """Reach the scheduler again, or one that has been started in its place.

        Raises `InputError` if there is none within `RECONNECT_S`.
        """
        until = time.monotonic() + RECONNECT_S
        self.close()
        while True:
            try:
                self.connect(min(CONNECT_S, max(1.0, until - time.monotonic())))
            except InputError as error:
                if time.monotonic() >= until:
                    raise InputError(
                        f"--scheduler {self.scheduler}: expected a scheduler that stays, got none "
                        f"for {RECONNECT_S:.0f} s; start it again, and then this study"
                    ) from error
                time.sleep(0.5)
            else:
                return

    @property
    def connected(self) -> bool:
        """Whether the scheduler answers."""
        return self.client is not None and self.client.status == "running"

    def close(self) -> None:
        """End the connection."""
        client, self.client = self.client, None
        if client is not None:
            with suppress(*LOST):
                client.close(timeout=2.0)

    def slots(self) -> int:
        """Return how many tasks the cluster carries out at once, at least 1."""
        if time.monotonic() >= self._slots_until:
            self._slots = max(1, sum(self.client.nthreads().values()))
            self._slots_until = time.monotonic() + _SLOTS_S
        return self._slots

    def check_workers(self) -> None:
        """Wait for a worker; raise `InputError` unless all that are there have our versions."""
        first = self.client.submit(versions_here, pure=False)  # starts one where clusters adapt
        while True:
            try:
                found = {"": first.result(timeout=1.0)}
                break
            except TimeoutError:
                if not self.connected:
                    raise OSError("the scheduler has gone") from None
            except (ImportError, AttributeError) as error:
                raise self._no_lodbench(error) from error
        found |= self.client.run(versions_here, on_error="return")
        for worker, theirs in found.items():
            if isinstance(theirs, (ImportError, AttributeError)):
                raise self._no_lodbench(theirs)
            if isinstance(theirs, Exception):
                continue  # it is ending, or is asked again by its first batch
            difference = describe_difference(self.versions, theirs)
            if difference:
                raise InputError(mismatch(f"{difference} on {worker}" if worker else difference))

    def _no_lodbench(self, error: Exception) -> InputError:
        return InputError(
            f"--scheduler {self.scheduler}: expected lodbench on the cluster's machines, got "
            f"{error}; install it there, the same as here"
        )

    def _unreachable(self, error: BaseException) -> InputError:
        reason = str(error) or type(error).__name__
        return InputError(
            f"--scheduler {self.scheduler}: expected a Dask scheduler that answers, got "
            f"{reason}; start one with `dask scheduler`, or check the address"
        )


def require_cluster(scheduler: str) -> None:
    """Raise `InputError` unless there is the package and an address; nobody is asked yet.

    An address is one if Dask knows its kind, and it has the host and the port that the kind wants.
    """
    _import_distributed()
    address = _address_of(scheduler)
    from distributed.comm.addressing import get_address_host

    try:
        get_address_host(address)
    except ValueError as error:
        raise InputError(
            f"--scheduler {scheduler}: expected an address such as tcp://HOST:8786, got {error}; "
            "check the address"
        ) from error


class QuietDask:
    """Keeps Dask's log from the terminal: what goes wrong is said in one line by us."""

    def __init__(self) -> None:
        self._handlers: list[logging.Handler] = []

    def start(self) -> None:
        """Begin; what is logged is still seen by handlers that are added later."""
        names = [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]
        for name in ("tornado.application", *names):
            for handler in logging.getLogger(name).handlers:
                handler.addFilter(_drop)
                self._handlers.append(handler)

    def stop(self) -> None:
        """Let it be heard again."""
        while self._handlers:
            self._handlers.pop().removeFilter(_drop)


def _within(seconds: float, function: Callable[[], Any]) -> Any:
    """Return what a function returns, in a thread of its own; raises TimeoutError if it takes long.

    Dask's own time limit does not hold where something listens that is no scheduler.
    """
    done: queue.SimpleQueue[tuple[Any, BaseException | None]] = queue.SimpleQueue()

    def call() -> None:
        try:
            done.put((function(), None))
        except BaseException as error:  # noqa: BLE001 - raised where it is waited for
            done.put((None, error))

    threading.Thread(target=call, daemon=True).start()
    try:
        value, error = done.get(timeout=seconds + _SLACK_S)
    except queue.Empty:
        raise TimeoutError(f"no answer for {seconds:g} s") from None
    if error is not None:
        raise error
    return value


def _drop(_record: logging.LogRecord) -> bool:
    return False


def _import_distributed() -> Any:
    try:
        import distributed
    except ImportError as error:
        raise InputError(
            "--scheduler: expected the package distributed, got none; "
            'pip install "lodbench[cluster]"'
        ) from error
    return distributed


def _address_of(scheduler: str) -> str:
    """Return the address that a user names; raises InputError if there is none."""
    if scheduler == FROM_CONFIG:
        import dask.config

        address: Any = dask.config.get("scheduler-address", None)
        if not address:
            raise InputError(
                "--scheduler config: expected scheduler-address in Dask's configuration, got none; "
                "set DASK_SCHEDULER_ADDRESS, or give the address"
            )
        return str(address)
    if "://" in scheduler:
        return scheduler
    path = Path(scheduler)
    try:
        return str(json.loads(path.read_bytes())["address"])
    except OSError as error:
        raise InputError(
            f"--scheduler: expected an address such as tcp://HOST:8786, or a scheduler file, got "
            f"{scheduler}; there is no such file"
        ) from error
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(
            "expected a file that `dask scheduler --scheduler-file` wrote, got another kind; "
            "name another",
            path=path,
        ) from error
