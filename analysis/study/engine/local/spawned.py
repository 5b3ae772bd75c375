"""Workers where processes cannot fork, as on Windows: each is an interpreter of its own.

A thread of the caller speaks as a minder does (see `minder`).  Memory is not limited there, and
what a worker prints is lost.
"""

import json
import os
import socket
import subprocess
import sys
import threading
from contextlib import suppress
from typing import Any

from .minder import ENDED, STARTED
from .worker import surroundings, work

_START = """
import json, sys
sys.path[:] = json.loads(sys.argv[1])
from {package}.spawned import serve
serve()
"""
_LOOK_S = 0.05


def spawn(control: socket.socket, channel: socket.socket, inputs: int, heart: int) -> None:
    """Start a worker and a thread that minds it.

    Parameters
    ----------
    control : the thread's end, which it closes
    channel, inputs, heart : the worker's, see `work`
    """
    path = json.dumps([str(entry) for entry in sys.path])
    process = subprocess.Popen(  # noqa: S603 - our own module
        [sys.executable, "-c", _START.format(package=__package__), path],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=surroundings(),
        **_inherited(channel, inputs, heart),
    )
    assert process.stdin is not None, "it has a pipe"
    process.stdin.write(_named(process.pid, channel, inputs, heart).encode() + b"\n")
    process.stdin.flush()
    threading.Thread(target=_mind, args=(process, control), daemon=True).start()


def serve() -> None:
    """Be a worker, until the caller has gone."""
    shared, inputs, heart = json.loads(sys.stdin.readline())
    threading.Thread(target=_end_with_caller, daemon=True).start()
    if sys.platform == "win32":
        import msvcrt

        channel = socket.fromshare(bytes.fromhex(shared))
        inputs, heart = (msvcrt.open_osfhandle(handle, os.O_RDWR) for handle in (inputs, heart))
    else:
        channel = socket.socket(fileno=shared)
    work(channel, inputs, heart)


def _end_with_caller() -> None:
    while sys.stdin.read(1):
        pass
    os._exit(1)


def _inherited(channel: socket.socket, *files: int) -> dict[str, Any]:
    """Return what has a process inherit descriptors, as its system wants it."""
    if sys.platform != "win32":
        return {"pass_fds": (channel.fileno(), *files), "start_new_session": True}
    import msvcrt

    handles = [msvcrt.get_osfhandle(file) for file in files]
    for handle in handles:
        os.set_handle_inheritable(handle, True)
    about = subprocess.STARTUPINFO(lpAttributeList={"handle_list": handles})
    return {"startupinfo": about, "creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}


def _named(pid: int, channel: socket.socket, *files: int) -> str:
    """Return what the process finds them by."""
    if sys.platform != "win32":
        return json.dumps([channel.fileno(), *files])
    import msvcrt

    return json.dumps([channel.share(pid).hex(), *map(msvcrt.get_osfhandle, files)])


def _mind(process: subprocess.Popen[bytes], control: socket.socket) -> None:
    """Do what `minder.mind` does."""
    control.settimeout(_LOOK_S)
    with control, process:
        control.sendall(STARTED.pack(0, process.pid))
        while process.poll() is None:
            try:
                control.recv(1)  # told to, or the engine has gone
            except TimeoutError:
                continue
            except OSError:
                pass
            process.kill()
            process.wait()
        with suppress(OSError):
            control.sendall(ENDED.pack(process.returncode))
