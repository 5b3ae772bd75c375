"""The recordings of an unattended run, the most wanted first.

For objects drawn each by its own calls, then instanced: the programme of calibration in each scene
to calibrate on, then in each scene to validate on, which takes no part in calibration, frames in
flight in open loop, policies in turns under a budget that bites on this machine, and one policy
with 1 to 4 frames in flight.  Each recording is a ``lodbench record`` of its own, so that neither a
crash nor a driver that hangs takes others with it.
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
_LEAST_S = 1.0  # of a path, whatever that is in frames: less shows no policy at work
_MOST_SHARE = 0.25  # of the time, for one part
_START_S, _FRAME_S = 15.0, 0.005  # of a recording, and of each of its frames, beside what it draws
_PROBE_STEPS, _LEAST_STEPS = 24, 60
_REFERENCE_DRAWINGS = 6  # beside each frame
_STATE = "name,driver_version,clocks.sm,clocks.mem,temperature.gpu,power.draw"


@dataclass(frozen=True, slots=True, kw_only=True)
class Campaign:
    """What to record.

    Attributes
    ----------
    limit_s : when everything is over, whatever is left to do; a quarter of it for each part
    size : width and height of the picture, as ``WIDTHxHEIGHT``
    seconds : of a trace that a policy goes through
    calibration_frames : of ``lodbench record --calibrate --steps``; fewer where time is short
    repeats : as of ``lodbench record``
    turns : times that each policy is recorded
    budget_ms : of the policies; 0 for a share of what full detail takes
    budget_share : of the median frame in full detail
    calibration, scenes : to calibrate and to validate on, each as ``scene:trace``
    draws : "each", "instanced" or both
    policies : as ``lodbench record --policy`` takes them
    flight_policy : the one that is recorded with frames in flight
    deepest : frames in flight, from 1 on
    """

    limit_s: float = 570.0
    size: str = "1280x720"
    seconds: float = 6.0
    calibration_frames: int = 480
    repeats: int = 3
    turns: int = 2
    budget_ms: float = 0.0
    budget_share: float = 0.25
    calibration: tuple[str, ...] = (
        "plaza:tour",
        "calibration-near:tour",
        "calibration-dense:tour",
    )
    scenes: tuple[str, ...] = ("market:drive",)
    draws: tuple[str, ...] = ("each", "instanced")
    policies: tuple[str, ...] = ("static-distance", "feedback", "full", "gobbetti", "static-screen")
    flight_policy: str = "feedback"
    deepest: int = 4


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
        campaign = self._campaign
        for draws in campaign.draws:
            parts = [(self._calibrate, pair) for pair in campaign.calibration]
            parts += [(self._validate, pair) for pair in campaign.scenes]
            for part, pair in parts:
                scene, _, trace = pair.rpartition(":")
                if self._left_s() > 0.0:
                    part(f"{_file_name(Path(scene).stem)}-{draws}", scene, trace, draws)
        self._results.write(took_s=round(time.monotonic() - self._start, 1))
        return self._results

    def _calibrate(self, tag: str, scene: str, trace: str, draws: str) -> None:
        drawn = _drawn(scene, trace, draws)
        steps = self._steps(tag, drawn)
        if steps:
            programme = ("--calibrate", "--steps", str(steps))
            self._record(f"{tag}-calibration", *drawn, *programme, *self._repeated())

    def _steps(self, tag: str, drawn: tuple[str, ...]) -> int:
        """Return how many frames of the programme there is time for; 0 if none can be drawn."""
        probe = ("--calibrate", "--steps", str(_PROBE_STEPS), "--repeats", "1")
        log = self._scratch / "probe.parquet"
        try:
            found = self._lodbench("record", *drawn, *probe, "--out", str(log))
        except ChildError as error:
            self._failed(f"{tag}-calibration", error)
            return 0
        drawing_ms = self._campaign.repeats * found["frame_ms_mean"]
        drawing_ms += _REFERENCE_DRAWINGS * found["reference_ms_mean"]
        passed_s = 2.0 * (1e-3 * drawing_ms + _FRAME_S)
        time_s = min(self._left_s(), _MOST_SHARE * self._campaign.limit_s) - _START_S
        most = self._campaign.calibration_frames
        return min(most, max(_LEAST_STEPS, int(0.8 * time_s / passed_s)))

    def _validate(self, tag: str, scene: str, trace: str, draws: str) -> None:
        campaign, drawn = self._campaign, _drawn(scene, trace, draws)
        self._measure_in_flight(tag, scene, draws)
        load_s = min(campaign.seconds, _LEAST_S)
        load = ("--policy", "full", "--budget-ms", "1", "--seconds", f"0:{load_s:g}")
        full = self._record(f"{tag}-load", *drawn, *load, "--repeats", "1")
        if full is None:
            return
        full_ms = full["frame_ms"][1]
        budget_ms = campaign.budget_ms or campaign.budget_share * full_ms
        self._results.budget_ms[tag] = budget_ms
        seconds = min(campaign.seconds, max(_LEAST_S, 1e-3 * full_ms * _MOST_FRAMES))
        limits = ("--budget-ms", str(budget_ms), "--seconds", f"0:{seconds:g}")
        for turn in range(campaign.turns):
            # Back and forth, so that what drifts is not taken for a difference of policies.
            for policy in campaign.policies[:: -1 if turn % 2 else 1]:
                how = ("--policy", policy, *self._repeated())
                self._record(f"{tag}-{_file_name(policy)}-{turn}", *drawn, *limits, *how)
        for depth in range(1, campaign.deepest + 1):
            how = ("--policy", campaign.flight_policy, "--frames-in-flight", str(depth))
            self._record(f"{tag}-flight-{depth}", *drawn, *limits, *how, "--threads", "1")

    def _repeated(self) -> tuple[str, ...]:
        return ("--repeats", str(self._campaign.repeats))

    def _record(self, name: str, *options: str) -> Any:
        """Record a log; return what the results say of it, or None if there is none."""
        if self._left_s() <= 0.0:
            return None
        log = self._scratch / f"{name}.parquet"
        try:
            summary = self._lodbench("record", *options, "--out", str(log))
        except ChildError as error:
            self._failed(name, error)
            return None
        more = {"at_s": round(time.monotonic() - self._start, 1), "device": device_state()}
        record = self._results.add_recording(name, summary, more)
        self._tell(f"{name}: {record['frames']} frames of {record['frame_ms'][1]:.3f} ms")
        return record

    def _lodbench(self, *command: str) -> Any:
        """Return what a command says of itself."""
        return json.loads(self._run("lodbench", *command, "--size", self._campaign.size, "--json"))

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


def _drawn(scene: str, trace: str, draws: str) -> tuple[str, ...]:
    what = ("--scene", scene, "--trace", trace)
    return (*what, "--instancing") if draws == "instanced" else what


def _file_name(text: str) -> str:
    return re.sub(r"[^\w.=-]+", "-", text)
