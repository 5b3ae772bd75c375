"""Commands on a Dask cluster: the bytes of one machine, and one line where there is no cluster."""

import json
import re
import socket
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

import pytest

from lodbench.base.user_code import load_file
from lodbench.cli.main import run

FILE = Path(__file__).parents[1] / "analysis" / "study" / "engine" / "hostile_neighbours.py"
DEEDS: Any = load_file(FILE, "policies").DEEDS

Command = Callable[..., tuple[int, str, str]]

HOSTILE = """
import os
from dataclasses import dataclass

from lodbench.policies.thresholds.static_screen import StaticScreen


@dataclass
class Mine(StaticScreen):
    def select(self, view):
        if view.frame == 7:
            os._exit(0)
        return super().select(view)
"""


@pytest.fixture
def command(capfd: pytest.CaptureFixture[str]) -> Command:
    """Return what runs a command: its exit code, stdout and stderr."""

    def run_line(*arguments: str) -> tuple[int, str, str]:
        code = run(arguments)
        out, err = capfd.readouterr()
        return code, out, err

    return run_line


@pytest.fixture(scope="module")
def cluster(start_cluster: Callable[..., Any]) -> Generator[Any]:
    """Yield a cluster of two workers."""
    with start_cluster() as started:
        yield started


@pytest.fixture
def scheduler(cluster: Any) -> str:
    """Return the address of the cluster."""
    return cluster.scheduler_address


@pytest.mark.slow
def test_no_scheduler_is_one_line(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every command that takes --scheduler ends with 2 and says what to start."""
    monkeypatch.setattr("lodbench.analysis.study.engine.cluster.dask_cluster.CONNECT_S", 0.5)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{probe.getsockname()[1]}"
    for line in (
        ("compare", "--policy", "full"),
        ("check", "--policy", "full"),
        ("stress", "full", "--out", "worst.csv"),
    ):
        code, out, err = command(*line, "--scheduler", address)
        assert (code, out) == (2, "")
        assert err.startswith(f"error: --scheduler {address}: expected a Dask scheduler that ")
        assert err.count("\n") == 1


@pytest.mark.slow
def test_a_comparison_is_the_same_bytes_on_a_cluster(
    command: Command, scheduler: str, tmp_path: Path
) -> None:
    """Files and JSON of `compare`, among them frame logs, draws, and a policy that does not fit."""
    line = ["compare", "--scene", "plaza", "--trace", "tour", "--seconds", "0:0.6", "--json"]
    line += ["--draws", "3", "--warmup", "0.2"]
    for policy in ("static-screen", "feedback:gain=0.2", "hlod-hysteresis", "gobbetti:aim=0.9"):
        line += ["--policy", policy]
    here, there = tmp_path / "here", tmp_path / "there"
    alone = command(*line, "--workers", "1", "--out", str(here))
    spread = command(*line, "--scheduler", scheduler, "--out", str(there))
    assert alone == spread
    assert alone[0] == 0
    files = sorted(path.relative_to(here) for path in here.rglob("*") if path.is_file())
    assert files == sorted(path.relative_to(there) for path in there.rglob("*") if path.is_file())
    for file in files:
        if file.name != "run-info.json":  # times and memory, outside the promise
            assert (here / file).read_bytes() == (there / file).read_bytes(), file


@pytest.mark.slow
def test_checks_and_searches_print_the_same_on_a_cluster(
    command: Command, scheduler: str, tmp_path: Path
) -> None:
    """`check` of a policy that ends its process, beside a good one, and `stress`."""
    mine = tmp_path / "mine.py"
    mine.write_text(HOSTILE, encoding="utf-8")
    policies = ["--policy", f"{mine}:Mine", "--policy", "static-screen"]
    check = ["check", *policies, "--seconds", "0:2", "--json"]
    check += ["--seeds", "2"]
    stress = [
        "stress",
        "full",
        "--duration-s",
        "1",
        "--warmup",
        "0.2",
        "--evaluations",
        "8",
        "--json",
    ]
    stress += ["--out", str(tmp_path / "worst.csv")]
    for line, code in ((check, 1), (stress, 0)):
        alone = command(*line)
        assert alone == command(*line, "--scheduler", scheduler)
        assert alone[0] == code
    assert "frame 7: process ended with status 0" in command(*check, "--scheduler", scheduler)[1]


@pytest.mark.slow
def test_whatever_a_policy_does_on_a_cluster_fails_it_alone(command: Command, cluster: Any) -> None:
    """All deeds of `hostile_neighbours`, side by side; the Dask workers live through each."""
    before = [nanny.pid for nanny in cluster.workers.values()]
    common = ["compare", "--scene", "plaza", "--trace", "walk", "--seconds", "0:2", "--json"]
    common += ["--paths", "1", "--seeds", "1"]
    (full,) = json.loads(command(*common, "--policy", "full")[1])["policies"]
    for options in sorted({deed.options for deed in DEEDS.values()}):
        labels = {
            f"{FILE}:Hostile:deed={name}": deed
            for name, deed in DEEDS.items()
            if deed.options == options
        }
        line = [*common, *options, "--scheduler", cluster.scheduler_address, "--policy", "full"]
        code, out, _ = command(*line, *(word for it in labels for word in ("--policy", it)))
        found = {policy["label"]: policy for policy in json.loads(out)["policies"]}
        assert found.pop("full")["metrics"] == full["metrics"]
        for label, deed in labels.items():
            if deed.reason is None:
                assert found[label]["metrics"] == full["metrics"], label
            else:
                assert re.search(deed.reason, found[label]["reason"]), label
        assert code == int(any(deed.reason for deed in labels.values()))
    assert [nanny.pid for nanny in cluster.workers.values()] == before


@pytest.mark.slow
def test_a_fit_is_the_same_on_a_cluster(command: Command, scheduler: str) -> None:
    """Nine frames that a paper printed, each left out in turn, here and there."""
    fit = ["fit", "peng2011", "--model", "gaussian", "--steps", "100", "--json"]
    alone = command(*fit)
    assert alone == command(*fit, "--scheduler", scheduler)
    assert json.loads(alone[1])["heldout"]["split"] == "leave-one-out"
