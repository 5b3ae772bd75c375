"""The recordings of an unattended run, the most wanted first.

For objects drawn each by its own calls, then instanced, and for each scene: a calibration, then
frames in flight, then policies in turns, under a budget that bites on this machine: what half of
the frames of its calibration take.  Each recording is a ``lodbench record`` of its own, so that
neither a crash nor a driver that hangs takes others with it.
"""

import json
import os
import re
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from .child_process import ChildError, run_child
from .results_folder import ResultsFolder

_MOST_FRAMES = 900  # of a policy: frames of a GPU are short, and the whole has to end in time
_MOST_SHARE = 0.25  # of the time, for one part
_STATE = "name,driver_version,clocks.sm,clocks.mem,temperature.gpu,power.draw"


@dataclass(frozen=True, slots=True, kw_only=True)
class Campaign:
    """What to record.

    Attributes
    ----------
    limit_s : when everything is over, whatever is left to do; a quarter of it for each part
    size : width and height of the picture, as ``WIDTHxHEIGHT``
    seconds : of a trace that a policy goes through
    calibration_frames : of ``lodbench record --calibrate --steps``
    repeats : as of ``lodbench record``
    turns : times that each policy is recorded
    budget_ms : of the policies; 0 for the median of the calibration
    scenes : each as ``scene:trace``
    draws : "each", "instanced" or both
    policies : as ``lodbench record --policy`` takes them
    """

    limit_s: float = 480.0
    size: str = "1280x720"
    seconds: float = 6.0
    calibration_frames: int = 600
    repeats: int = 3
    turns: int = 2
    budget_ms: float = 0.0
    scenes: tuple[str, ...] = ("plaza:tour", "market:drive")
    draws: tuple[str, ...] = ("each", "instanced")
    policies: tuple[str, ...] = ("static-distance", "feedback", "full", "gobbetti", "static-screen")


def run_campaign(campaign: Campaign, out: Path) -> ResultsFolder:
    """Record all that there is time for, and return the results, which are in the folder `out`."""
    with TemporaryDirectory(prefix="lodbench-unattended-") as scratch:
        return _Runner(campaign, out, Path(scratch)).run()


class _Runner:
    def __init__(self, campaign: Campaign, out: Path, scratch: Path) -> None:
        self._campaign, self._scratch = campaign, scratch
        self._start = time.monotonic()
        self._results = ResultsFolder(
            out, scratch, {"campaign": asdict(campaign), "device": device_state()}
        )
        # Scenes are made once for all commands, and nothing stays behind.
        cache = os.environ.get("LODBENCH_CACHE") or str(scratch / "cache")
        self._environment = {"LODBENCH_CACHE": cache, "PYTHONUNBUFFERED": "1"}

    def run(self) -> ResultsFolder:
        for draws in self._campaign.draws:
            for pair in self._campaign.scenes:
                if self._left_s() > 0.0:
                    scene, _, trace = pair.rpartition(":")
                    self._record_scene(scene, trace, draws)
        self._results.write(took_s=round(time.monotonic() - self._start, 1))
        return self._results

    def _record_scene(self, scene: str, trace: str, draws: str) -> None:
        campaign, tag = self._campaign, f"{_file_name(Path(scene).stem)}-{draws}"
        drawn = ("--scene", scene, "--trace", trace)
        drawn += ("--instancing",) if draws == "instanced" else ()
        programme = ("--calibrate", "--steps", str(campaign.calibration_frames))
        calibration = self._record(f"{tag}-calibration", *drawn, *programme)
        if calibration is None:
            return
        self._measure_in_flight(tag, scene, draws)
        median_ms = calibration["frame_ms"][1]
        budget_ms = self._results.budget_ms[tag] = campaign.budget_ms or median_ms
        seconds = min(campaign.seconds, 1e-3 * median_ms * _MOST_FRAMES)
        limits = ("--budget-ms", str(budget_ms), "--seconds", f"0:{seconds:g}")
        for turn in range(campaign.turns):
            for policy in campaign.policies:
                if self._left_s() > 0.0:
                    name = f"{tag}-{_file_name(policy)}-{turn}"
                    self._record(name, *drawn, *limits, "--policy", policy)

    def _record(self, name: str, *options: str) -> Any:
        """Record a log; return what the results say of it, or None if there is none."""
        campaign = self._campaign
        log = self._scratch / f"{name}.parquet"
        command = ("lodbench", "record", *options, "--size", campaign.size)
        command += ("--repeats", str(campaign.repeats), "--out", str(log), "--json")
        try:
            summary = json.loads(self._run(*command))
        except ChildError as error:
            self._failed(name, error)
            return None
        more = {"at_s": round(time.monotonic() - self._start, 1), "device": device_state()}
        record = self._results.add_recording(name, summary, more)
        self._tell(f"{name}: {record['frames']} frames of {record['frame_ms'][1]:.3f} ms")
        return record

    def _measure_in_flight(self, tag: str, scene: str, draws: str) -> None:
        campaign, module = self._campaign, f"{__package__}.frames_in_flight"
        what = (scene, campaign.size, draws, str(campaign.calibration_frames))
        try:
            measured = json.loads(self._run(module, *what))
        except ChildError as error:
            self._failed(f"{tag} frames in flight", error)
            return
        self._results.frames_in_flight[tag] = measured
        self._results.write()
        self._tell(f"{tag}: {measured['4']['interval_ms']:.3f} ms a frame with 4 in flight")

    def _run(self, *command: str) -> str:
        return run_child(
            (sys.executable, "-m", *command),
            # One part that hangs leaves time for the others.
            limit_s=min(self._left_s(), _MOST_SHARE * self._campaign.limit_s),
            more=self._environment,
        )

    def _failed(self, part: str, error: ChildError) -> None:
        self._results.add_error(part, error)
        self._tell(f"{part}: {error}")

    def _tell(self, line: str) -> None:
        print(f"{time.monotonic() - self._start:5.0f} s {line}", flush=True)

    def _left_s(self) -> float:
        return self._campaign.limit_s - (time.monotonic() - self._start)


def device_state() -> str:
    """Return what nvidia-smi says of clocks, temperature and power, or why it says nothing."""
    command = ("nvidia-smi", f"--query-gpu={_STATE}", "--format=csv,noheader")
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)  # noqa: S603
    except (OSError, subprocess.SubprocessError) as error:
        return f"nvidia-smi: {error}"
    return done.stdout.strip()


def _file_name(text: str) -> str:
    return re.sub(r"[^\w.=-]+", "-", text)
