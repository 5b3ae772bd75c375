"""A study in a process of its own, to be killed: ``kill_program.py KIND FOLDER STEP SCHEDULER``.

With a step, its steps of the file system are counted, and it kills itself before that one if there
is such; their number is the same every time, since results wait for each other.  With ``-`` they
come as they come.  A scheduler of ``-`` is this machine.  It prints a line of JSON at its begin,
after each result, when all are durable, and at its end.
"""

import json
import os
import signal
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import lodbench
from lodbench.analysis.study import comparison_folder
from lodbench.analysis.study.comparison import Comparison
from lodbench.analysis.study.results import commit, parts, store
from lodbench.analysis.study.results.record import Entry
from lodbench.analysis.study.study import Study
from lodbench.base.files import whole_folder
from lodbench.base.predictors import GPU_PREDICTORS, LEVEL_PREDICTORS
from lodbench.models.machine.cost import CostModel, CpuCostModel
from lodbench.models.machine.hardware import HardwareProfile, Posterior, Provenance
from lodbench.models.machine.residual import Residual
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import ObjectTypes, Scene
from lodbench.traces.cameras.camera_trace import CameraTrace

POLICIES = ("full", "static-screen:bias=1", "feedback:target=0.9")
STEPS = {"os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.truncate", "os.link"}
WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT


class Lockstep(commit.GroupCommit[Entry]):
    """Writes three results at a time, whenever they come; who adds them waits for the third."""

    def __init__(self, write: Callable[[Sequence[Entry]], None]) -> None:
        commit.GROUP, commit.HOLD_S = 3, 1e6
        super().__init__(write)

    def add(self, item: Entry) -> None:
        """Leave a result to be written with two others."""
        super().add(item)
        if self._added % commit.GROUP == 0:
            self.flush()


class Steps:
    """Counts what the process does to the files of a folder, and kills it before one of them."""

    def __init__(self, folder: Path, last: int) -> None:
        self.count, self._last = 0, last
        self._inside = os.fsencode(folder)
        fsync, exchange = os.fsync, whole_folder.exchange

        def counted_fsync(handle: int) -> None:
            self.step()
            fsync(handle)

        def counted_exchange(first: Path, second: Path) -> bool:
            self.step()
            done = exchange(first, second)
            self.step()
            return done

        os.fsync, whole_folder.exchange = counted_fsync, counted_exchange
        sys.addaudithook(self.hear)

    def hear(self, event: str, args: tuple[Any, ...]) -> None:
        """Count an event of the interpreter that changes a file or a name in the folder."""
        changes = event in STEPS or (event == "open" and (args[2] or 0) & WRITES)
        if changes and isinstance(args[0], (str, bytes, Path)):
            self.step(os.fsencode(args[0]))

    def step(self, path: bytes | None = None) -> None:
        """Count a step; the last one is not done."""
        if path is None or path.startswith(self._inside):
            if self.count == self._last:
                os.kill(os.getpid(), signal.SIGKILL)
            self.count += 1


def say(**line: object) -> None:
    """Print a line that no buffer holds back."""
    os.write(1, json.dumps(line).encode() + b"\n")


def say_progress(done: int, total: int) -> None:
    """Say how many results are durable: after each that comes, and once more when all are."""
    say(done=done, of=total)


def build_world() -> tuple[Scene, CameraTrace, HardwareProfile]:
    """Return twelve objects, a look at them for two seconds, and a machine with two draws."""
    counts = np.zeros((3, len(LEVEL_PREDICTORS)))
    counts[:, LEVEL_PREDICTORS.index("triangles")] = (2000, 500, 100)
    levels = LevelTable(
        np.array([0, 3]), counts, np.array([0.0, 0.02, 0.1]), counts.sum(axis=1), np.array([False])
    )
    types = ObjectTypes(("block",), np.zeros((1, 3)), np.array([1.0]), levels)
    n = 12
    scene = Scene(
        "twelve",
        types,
        np.zeros(n, dtype=np.int32),
        np.column_stack((np.zeros(n), np.zeros(n), np.linspace(-40.0, -5.0, n))),
        np.tile([0.0, 0.0, 0.0, 1.0], (n, 1)),
        np.ones(n),
        np.ones(n),
        np.full(n, -1, dtype=np.int32),
        np.zeros(n, dtype=np.bool_),
    )
    look = np.tile([0.0, 0.0, 0.0, 1.0], (2, 1))
    trace = CameraTrace(
        "look", np.array([0.0, 2.0]), np.zeros((2, 3)), look, np.zeros(2, dtype=np.bool_)
    )
    linear = np.zeros((2, len(GPU_PREDICTORS)))
    linear[:, GPU_PREDICTORS.index("triangles")] = (1e-3, 1.2e-3)
    hardware = HardwareProfile(
        "machine",
        Provenance("made up for tests", assumed=True),
        CostModel.of(1.0, {"triangles": 1e-3}),
        CpuCostModel.of(2.0, {}),
        Residual("gaussian", 0.02),
        posterior=Posterior(np.ones(2), linear, np.full(2, 0.02)),
    )
    return scene, trace, hardware


def draw_line(comparison: Comparison, *_: object) -> str:
    """Return a page of a line."""
    return repr(comparison)


def compare(folder: Path, scheduler: str | None) -> None:
    """Compare three policies: on the machine, then on two others and for the log, twelve runs.

    The page is a line, as drawing one takes longer than all the rest.
    """
    comparison_folder.render_report = draw_line
    scene, trace, hardware = build_world()
    lodbench.compare(
        list(POLICIES),
        scene=scene,
        traces=trace,
        hardware=hardware,
        budget_ms=8.0,
        seeds=1,
        draws=2,
        workers=2,
        scheduler=scheduler,
        out=folder / "run",
        progress=say_progress,
    )


def sweep(folder: Path, scheduler: str | None) -> None:
    """Carry out 36 runs, with small groups and parts, so that files are merged and split."""
    commit.GROUP, commit.HOLD_S, parts.FAN, store.ROWS = 3, 0.02, 3, 10
    scene, trace, hardware = build_world()
    study = Study(
        POLICIES,
        scenes=scene,
        traces=trace,
        hardware=hardware,
        budget_ms=(6.0, 8.0),
        seeds=6,
        draws=0,
        warmup_s=0.1,
    )
    study.run(out=folder / "run", workers=2, scheduler=scheduler, progress=say_progress)


KINDS: dict[str, Callable[[Path, str | None], None]] = {"compare": compare, "sweep": sweep}


def main() -> None:
    """Carry out a study, and say how many steps it took."""
    kind, path, step, scheduler = sys.argv[1:]
    folder = Path(path).resolve()
    steps = None
    if step != "-":
        store.GroupCommit = Lockstep
        steps = Steps(folder, int(step))
    say(begin=True)
    KINDS[kind](folder, None if scheduler == "-" else scheduler)
    if steps is not None:
        say(steps=steps.count)


if __name__ == "__main__":
    main()
