"""The same replay gives the same bytes in every process."""

import os
import subprocess
import sys

REPLAY = """
import hashlib
import numpy as np
from lodbench.models.machine.cost import CostModel, CpuCostModel
from lodbench.models.machine.hardware import Display, HardwareProfile, Provenance
from lodbench.models.scene.levels import LevelTable
from lodbench.models.machine.residual import Residual
from lodbench.models.scene.scene import ObjectTypes, Scene
from lodbench.policies.controllers.feedback import Feedback
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.generators.generate import generate

rng, n = np.random.default_rng(1), 40_000
counts = np.outer((900.0, 333.3, 71.7), np.ones(7))
levels = LevelTable(np.array([0, 3]), counts, np.array([0, 0.03, 0.2]), np.ones(3), np.zeros(1))
scene = Scene(
    "many", ObjectTypes(("a",), np.zeros((1, 3)), np.ones(1), levels), np.zeros(n),
    np.column_stack([rng.uniform(-80, 80, (n, 2)), np.ones(n)]),
    np.tile([0.0, 0.0, 0.0, 1.0], (n, 1)), rng.uniform(0.5, 2, n), rng.uniform(0, 1, n),
    np.full(n, -1), np.zeros(n),
)
hardware = HardwareProfile(
    "machine", Provenance("assumed", assumed=True),
    CostModel.of(1.0, {"triangles": 1e-6, "shaded_samples": 1e-7}),
    CpuCostModel.of(0.5, {"draw_calls": 1e-4}), Residual(
        "student-t", 0.05, slow_scale=0.05, slow_time_s=0.1, spike_share=0.1, spike_scale=0.5
    ),
    display=Display("immediate"),
)
trace = generate("look-around", duration_s=20.0, extent_m=100.0, seed=3)
options = ReplayOptions(budget_ms=8.0, frames=30, seed=5, crossfade_ms=50.0)
log = replay(Feedback(), scene, trace, hardware, options, name="feedback")
assert log["visible"].max() > 10_000 and log["toggles"].sum() > 100
print(hashlib.sha256(log.times_ns.tobytes() + log.counts.tobytes()).hexdigest())
"""


def test_bytes_do_not_depend_on_hash_seed_or_threads() -> None:
    """Frame logs are equal to the last bit under other string hashes and numbers of threads."""
    digests = set[str]()
    for hash_seed, threads in (("0", "1"), ("1", "2"), ("random", "8")):
        environment = {
            **os.environ,
            "PYTHONHASHSEED": hash_seed,
            "OPENBLAS_NUM_THREADS": threads,
            "OMP_NUM_THREADS": threads,
        }
        command = [sys.executable, "-c", REPLAY]
        run = subprocess.run(command, env=environment, capture_output=True, text=True)
        assert run.returncode == 0, run.stderr
        digests.add(run.stdout)
    assert len(digests) == 1
