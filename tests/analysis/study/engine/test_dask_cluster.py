"""Schedulers that are not there, are started again, have other versions, or want certificates."""

import importlib
import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Generator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from lodbench.analysis.study.engine.cluster import dask_cluster
from lodbench.analysis.study.engine.cluster.dask_engine import DaskEngine
from lodbench.analysis.study.engine.cluster.versions import (
    Versions,
    describe_difference,
    versions_here,
)
from lodbench.analysis.study.engine.open_engine import open_engine, prepare_engine
from lodbench.base.errors import InputError
from lodbench.base.user_code import load_object

CONFIG: Any = importlib.import_module("dask.config")

TASK = '''
import time
from dataclasses import dataclass

@dataclass(frozen=True)
class Echo:
    """The number, after so many seconds."""
    owner: str
    number: int
    seconds: float = 0.0
    result_type = int

    def __call__(self, inputs, beat):
        time.sleep(self.seconds)
        return self.number
'''


@pytest.fixture
def echo(tmp_path: Path) -> Any:
    """Return the class of tasks."""
    path = tmp_path / "echo.py"
    path.write_text(TASK, encoding="utf-8")
    return load_object(f"{path}:Echo", "task")


def refusal_of(scheduler: str) -> str:
    """Return the one line with which a scheduler is refused."""
    with pytest.raises(InputError) as refused, open_engine({}, scheduler=scheduler):
        pass
    line = str(refused.value)
    assert "\n" not in line
    return line


def listens(address: str) -> bool:
    """Whether anything takes connections at an address."""
    host, _, port = address.partition("://")[2].rpartition(":")
    try:
        socket.create_connection((host, int(port)), timeout=1.0).close()
    except OSError:
        return False
    return True


def free_port() -> int:
    """Return a port that nobody listens to."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@contextmanager
def started(kind: str, *arguments: str, **config: str) -> Generator[subprocess.Popen[Any]]:
    """Run Dask's scheduler or worker as a user does, until the block ends."""
    command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *arguments]
    quiet: Any = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with subprocess.Popen(command, env=os.environ | config, **quiet) as process:
        try:
            yield process
        finally:
            process.terminate()


def test_without_the_extra_one_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    """The package distributed is missing: the message names the extra."""
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert refusal_of("tcp://127.0.0.1:8786") == (
        '--scheduler: expected the package distributed, got none; pip install "lodbench[cluster]"'
    )


def test_addresses_that_lead_nowhere_are_refused_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No listener, no port, no such protocol, no such file, another file, no configuration."""
    monkeypatch.setattr(dask_cluster, "CONNECT_S", 0.5)
    for address in (f"tcp://127.0.0.1:{free_port()}", "tcp://127.0.0.1", "carrier://pigeon:1"):
        assert refusal_of(address).startswith(
            f"--scheduler {address}: expected a Dask scheduler that answers, got "
        )
    assert "there is no such file" in refusal_of("scheduler.json")
    other = tmp_path / "other.json"
    for content in ("[]", "{}", "no json"):
        other.write_text(content)
        assert refusal_of(str(other)).startswith(f"{other}: expected a file that `dask scheduler")
    with CONFIG.set({"scheduler-address": None}):
        assert "DASK_SCHEDULER_ADDRESS" in refusal_of("config")


def test_an_address_is_looked_at_before_anybody_is_asked(tmp_path: Path) -> None:
    """Its kind, host and port; one at which nobody listens is well formed."""
    for address, said in {
        "tcp://127.0.0.1": "missing port number",
        "tls://host:port": "invalid literal",
        "carrier://pigeon:1": "unknown address scheme 'carrier'",
    }.items():
        with pytest.raises(InputError) as refused:
            prepare_engine(address)
        line = str(refused.value)
        assert line.startswith(f"--scheduler {address}: expected an address such as tcp://HOST")
        assert said in line
        assert "\n" not in line
    file = tmp_path / "scheduler.json"
    file.write_text('{"address": "carrier://pigeon:1"}')
    with pytest.raises(InputError, match="unknown address scheme 'carrier'"):
        prepare_engine(str(file))
    for address in ("tcp://127.0.0.1:1", "tls://host:8786", "tcp://[::1]:8786"):
        prepare_engine(address)


def test_versions_that_differ_are_named() -> None:
    """Each that differs, with what is there and what is wanted; nothing where all are the same."""
    mine = Versions("c0ffee", "3.11", "2.0.0", "1.13.0", "3.6.5", "x86_64")
    assert describe_difference(mine, replace(mine)) == ""
    theirs = replace(mine, numpy="1.26.4", machine="aarch64")
    assert describe_difference(mine, theirs) == (
        "numpy 1.26.4 in place of 2.0.0, machine aarch64 in place of x86_64"
    )


def test_the_page_names_the_times_that_hold() -> None:
    """docs/clusters.md has the seconds for which a scheduler is tried, and tried again."""
    page = Path(__file__).parents[4] / "docs" / "clusters.md"
    text = page.read_text(encoding="utf-8")
    assert f"one line after {dask_cluster.CONNECT_S:.0f} s" in text
    assert f"tried for {dask_cluster.RECONNECT_S:.0f} s" in text


def test_nothing_of_dask_is_loaded_before_a_cluster_is_named() -> None:
    """Importing both engines loads neither Dask nor, ever, pandas."""
    script = (
        "import sys; from lodbench.analysis.study.engine import open_engine; "
        "from lodbench.analysis.study.engine.cluster import dask_engine; "
        "print({'dask', 'distributed', 'pandas'} & set(sys.modules))"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert run.stdout == "set()\n", run.stderr


@pytest.mark.slow
def test_a_scheduler_that_does_not_answer_is_given_up_in_ten_seconds() -> None:
    """A port that takes connections and says nothing is refused, as documented, in 10 s."""
    with socket.create_server(("127.0.0.1", 0)) as silent:
        begin = time.monotonic()
        refusal_of(f"tcp://127.0.0.1:{silent.getsockname()[1]}")
        assert time.monotonic() - begin < 1.5 * dask_cluster.CONNECT_S


@pytest.mark.slow
def test_workers_of_other_versions_are_refused_before_the_work(
    echo: Any, monkeypatch: pytest.MonkeyPatch, start_cluster: Callable[..., Any]
) -> None:
    """At the start; and of a worker that comes later, with its first batch."""
    here = versions_here()
    with start_cluster(n_workers=1) as cluster:
        address = cluster.scheduler_address
        for late in (False, True):
            inside: Any = DaskEngine({}, address)
            with inside as engine:
                engine._cluster.versions = replace(here, numpy="0.0")
                if late:
                    monkeypatch.setattr(engine._cluster, "check_workers", lambda: None)
                with pytest.raises(InputError, match=f"got numpy {here.numpy} in place of 0.0"):
                    next(engine.run([echo("owner", 1)]))


@pytest.mark.slow
def test_the_scheduler_file_and_the_configuration_lead_to_the_scheduler(
    tmp_path: Path, echo: Any
) -> None:
    """Workers and client find it by the file, and the client by Dask's own configuration."""
    file = tmp_path / "scheduler.json"
    where = ("--scheduler-file", str(file))
    with (
        started("scheduler", *where, "--port", "0", "--dashboard-address", ":0"),
        started("worker", *where, "--nthreads", "1", "--no-dashboard"),
    ):
        wait_for(file.exists)
        with open_engine({}, scheduler=str(file)) as engine:
            assert [outcome.result for outcome in engine.run([echo("owner", 5)])] == [5]
        address = json.loads(file.read_text())["address"]
        with (
            CONFIG.set({"scheduler-address": address}),
            open_engine({}, scheduler="config") as engine,
        ):
            assert [outcome.result for outcome in engine.run([echo("owner", 6)])] == [6]


@pytest.mark.slow
def test_a_scheduler_that_is_started_again_goes_on(tmp_path: Path, echo: Any) -> None:
    """Killed in the middle and started at the same address: every task is told once."""
    port = str(free_port())
    address = f"tcp://127.0.0.1:{port}"
    scheduler = ("--port", port, "--host", "127.0.0.1", "--dashboard-address", ":0")
    worker = (address, "--nthreads", "1", "--no-dashboard", "--local-directory", str(tmp_path))
    tasks = [echo("owner", i, 0.2) for i in range(20)]
    with ExitStack() as stack:
        first = stack.enter_context(started("scheduler", *scheduler))
        stack.enter_context(started("worker", *worker))
        wait_for(lambda: listens(address))
        with open_engine({}, scheduler=address) as engine:
            outcomes = engine.run(tasks)
            found = [next(outcomes)]
            first.kill()
            first.wait()
            stack.enter_context(started("scheduler", *scheduler))
            stack.enter_context(started("worker", *worker))
            found += outcomes
    assert [outcome.index for outcome in found] == list(range(20))
    assert [outcome.result for outcome in found] == list(range(20))


@pytest.mark.slow
def test_a_scheduler_that_stays_away_ends_the_study_in_one_line(
    tmp_path: Path, echo: Any, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """After the documented time, which is cut short here; Dask itself prints nothing."""
    monkeypatch.setattr(dask_cluster, "RECONNECT_S", 3.0)
    monkeypatch.setattr(dask_cluster, "CONNECT_S", 5.0)
    port = str(free_port())
    address = f"tcp://127.0.0.1:{port}"
    with ExitStack() as stack:
        scheduler = stack.enter_context(
            started("scheduler", "--port", port, "--dashboard-address", ":0")
        )
        stack.enter_context(started("worker", address, "--nthreads", "1", "--no-dashboard"))
        wait_for(lambda: listens(address))
        with open_engine({}, scheduler=address) as engine:
            outcomes = engine.run([echo("owner", i, 0.2) for i in range(20)])
            next(outcomes)
            scheduler.kill()
            with pytest.raises(InputError) as refused:
                list(outcomes)
    assert str(refused.value) == (
        f"--scheduler {address}: expected a scheduler that stays, got none for 3 s; "
        "start it again, and then this study"
    )
    assert capfd.readouterr() == ("", "")


@pytest.mark.slow
def test_certificates_come_from_the_configuration_of_dask(tmp_path: Path, echo: Any) -> None:
    """tls:// with the three files of `distributed.comm.tls`; without them it is refused."""
    certificate, key = tmp_path / "cert.pem", tmp_path / "key.pem"
    subprocess.run(
        f"openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=localhost "
        f"-keyout {key} -out {certificate}".split(),
        check=True,
        capture_output=True,
    )
    tls = {"ca-file": certificate}
    for role in ("scheduler", "worker", "client"):
        tls |= {f"{role}.cert": certificate, f"{role}.key": key}
    names = {name: name.replace(".", "__").replace("-", "_").upper() for name in tls}
    config = {f"DASK_DISTRIBUTED__COMM__TLS__{names[name]}": str(tls[name]) for name in tls}
    address = f"tls://127.0.0.1:{free_port()}"
    scheduler = ("--protocol", "tls", "--port", address.rpartition(":")[2])
    with (
        started("scheduler", *scheduler, "--dashboard-address", ":0", **config),
        started("worker", address, "--nthreads", "1", "--no-dashboard", **config),
    ):
        wait_for(lambda: listens(address))
        with (
            CONFIG.set({f"distributed.comm.tls.{name}": str(tls[name]) for name in tls}),
            open_engine({}, scheduler=address) as engine,
        ):
            assert [outcome.result for outcome in engine.run([echo("owner", 5)])] == [5]
        assert refusal_of(address).startswith(f"--scheduler {address}: expected a Dask scheduler")


def wait_for(condition: Callable[[], Any], seconds: float = 60.0) -> Any:
    """Return the first true value of a condition."""
    until = time.monotonic() + seconds
    while not (value := condition()):
        assert time.monotonic() < until, "waited in vain"
        time.sleep(0.05)
    return value
