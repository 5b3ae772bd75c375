"""A failing example on paper: files that `compare` can replay, and a picture of its frame times."""

import shlex
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..base.errors import PolicyError
from ..base.files.whole_file import write_whole
from ..models.machine.profile_writer import write_profile
from ..models.scene.scene_file import write_scene
from ..traces.cameras.camera_trace import CameraTrace
from ..traces.cameras.write_trace import write_trace
from .examples.example import Example, Factory
from .naming import name_policy
from .promises.promise import Failure
from .time_picture import draw_frame_times


def write_failure(folder: Path, failure: Failure, factory: Factory, title: str) -> str:
    """Write scene, trace, hardware and picture of each run; return what to do with them."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.iterdir():
        old.unlink()
    text = [f"{title}: {failure.message}"]
    for name, example in failure.runs:
        write_scene(folder / f"{name}.lodscene", example.scene, ())
        write_trace(_lasting(example), folder / f"{name}.csv")
        write_profile(example.hardware, folder / f"{name}.toml")
        command = _command(folder / name, example, name_policy(type(factory())))
        text += [f"smallest example found ({name}): {example}", f"  {command}"]
    picture = folder / "frame-times.svg"
    write_whole(picture, _picture(failure.runs, factory, title))
    return "\n".join([*text, f"frame times: {picture}"])


def _lasting(example: Example) -> CameraTrace:
    """Return the path of an example, its last pose held until its frames can have begun.

    `compare` goes by the clock of the path, and an example of a single pose has none.
    """
    trace = example.trace
    missing_s = example.frames / example.hardware.display.refresh_hz - trace.duration_s
    if missing_s <= 0.0:
        return trace
    return CameraTrace(
        trace.name,
        np.append(trace.time_s, trace.duration_s + missing_s),
        np.vstack((trace.position_m, trace.position_m[-1:])),
        np.vstack((trace.orientation_xyzw, trace.orientation_xyzw[-1:])),
        np.append(trace.cut, False),
    )


def _command(stem: Path, example: Example, policy: str) -> str:
    return shlex.join(
        [
            *("lodbench", "compare", "--scene", f"{stem}.lodscene", "--trace", f"{stem}.csv"),
            *("--place", "none", "--hardware", f"{stem}.toml", "--policy", policy),
            *("--budget-ms", repr(example.budget_ms)),
            *("--warmup", "0"),
        ]
    )


def _picture(runs: Sequence[tuple[str, Example]], factory: Factory, title: str) -> str:
    times: list[tuple[str, np.ndarray]] = []
    for name, example in runs:
        try:
            log = example.play(factory()).log
            times.append((name, np.maximum(log["cpu_ms"], log["gpu_ms"])))
        except PolicyError:  # a policy that broke its contract has no times
            times.append((name, np.zeros(0)))
    return draw_frame_times(times, runs[0][1].budget_ms, title)
