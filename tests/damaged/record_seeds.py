"""Files of our own beside scenes: profiles, studies, limits, baselines, chains and frame logs."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import emcee
import numpy as np
from numpy.typing import NDArray
from seed import ROOT, Seed, one_file

import lodbench
from lodbench.analysis.fit.sampling.chain_file import load_chain, save_chain
from lodbench.analysis.gate.baseline import Baseline, Case, Entry, read_baseline, write_baseline
from lodbench.analysis.gate.limits_file import DEFAULT_LIMITS, read_limits
from lodbench.analysis.gate.measurements import Conditions
from lodbench.analysis.study.sweep.study_file import read_study
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.sim.frame_log_file import read_frame_log, write_frame_log
from lodbench.traces.cameras.generators.generate import generate

_CONDITIONS = Conditions(
    hardware="here",
    display="vsync",
    refresh_hz=60.0,
    frames_in_flight=2,
    pacing="none",
    latency_limit=0,
    budget_ms=4.0,
    seed=0,
    seeds=2,
    warmup_s=1.0,
    visible_px=1.0,
)
_SCOPED = """
[[for]]
scene = "c*"
[for.limits]
visible_pops_per_s = { max = 3, population = "such-paths" }
"""
_PROFILES = ("desktop-assumed.toml", "quadro5000-2011.toml")

READERS: dict[str, Callable[[Path], object]] = {
    "hardware": lambda path: load_hardware(str(path)),
    "study": read_study,
    "limits": read_limits,
    "baseline": lambda path: read_baseline(path, _CONDITIONS),
    "frame log": read_frame_log,
    "chain": lambda path: load_chain(path, "of this"),
}
"""What is read by no command of its own, or by one that works for long."""


def record_seeds(scratch: Path) -> Iterator[Seed]:
    """Yield one of each, some written by what writes them."""
    for name in _PROFILES:
        data = (ROOT / "models" / "machine" / "profiles" / name).read_bytes()
        yield one_file("hardware profiles", name, data, "text", "hardware")
    study = (ROOT / "docs" / "examples" / "sweeps" / "budgets.toml").read_text()
    study = 'scenes = ["plaza"]\n' + study
    yield one_file("studies", "budgets.toml", study, "text", "study")
    yield one_file("limits", "limits.toml", DEFAULT_LIMITS + _SCOPED, "text", "limits")
    entries = [Entry(f"path-{i}", "0a", {"work_ms_p99": [3.0, 3.1 + i]}) for i in range(3)]
    path = scratch / "baseline.json"
    write_baseline(path, Baseline(_CONDITIONS, [Case("full", "cows", entries)]))
    yield one_file("baselines", path.name, path.read_bytes(), "json", "baseline")
    yield one_file("chains", "chain.npz", _chain(scratch / "chain.npz"), "archive", "chain")
    orbit = generate("orbit", duration_s=0.5)
    log = lodbench.replay("full", "cows", orbit, "desktop-assumed", budget_ms=8.0)
    path = scratch / "frames.parquet"
    write_frame_log(path, log)
    yield one_file("frame logs", path.name, path.read_bytes(), "parquet", "frame log")


def _log_prob(x: NDArray[np.float64]) -> float:
    return -0.5 * float(x @ x)


def _chain(path: Path) -> bytes:
    backend: Any = emcee.backends.Backend()
    sampler: Any = emcee.EnsembleSampler(8, 2, _log_prob, backend=backend)
    sampler.random_state = np.random.RandomState(0).get_state()
    sampler.run_mcmc(np.random.default_rng(0).normal(size=(8, 2)), 5)
    save_chain(backend, path, "of this")
    return path.read_bytes()
