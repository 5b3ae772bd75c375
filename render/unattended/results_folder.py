"""What an unattended run leaves behind, written whole after each of its parts."""

import json
import tarfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...base.files.whole_file import whole_file, whole_text_file
from ...traces.logs.read_log import read_render_log

_COUNTS = ("draw_calls", "triangles", "shaded_samples")
_SUMMARISED = ("repeats_spread_pct", "reference_ms_mean", "lag_ms_mean", "condition")
_QUANTILES = (0.05, 0.5, 0.95)


class ResultsFolder:
    """``result.json`` and, of the logs recorded so far, ``logs.tar.gz``.

    Both are whole at any moment, so that a run that is cut off has lost only the part it was at.
    """

    def __init__(self, out: Path, logs: Path, about: Mapping[str, Any]) -> None:
        self._out, self._logs = out, logs
        out.mkdir(parents=True, exist_ok=True)
        self.recordings: dict[str, Any] = {}
        self.frames_in_flight: dict[str, Any] = {}
        self.budget_ms: dict[str, float] = {}
        self.errors: list[str] = []
        self._about = dict(about)
        self.write()

    def add_recording(self, name: str, summary: Mapping[str, Any], more: Mapping[str, Any]) -> Any:
        """Add the log of that name, and return its record: 5 %, 50 % and 95 % of times and counts.

        Parameters
        ----------
        summary : as ``lodbench record --json`` prints it
        more : of the moment of recording
        """
        log = read_render_log(self._logs / f"{name}.parquet")
        columns = {time: log.time(time) for time in log.times}
        columns |= dict(zip(_COUNTS, log.columns(_COUNTS).T, strict=True))
        record = {
            "frames": summary["frames"],
            **{key: summary[key] for key in _SUMMARISED if key in summary},
            **{key: np.nanquantile(values, _QUANTILES).tolist() for key, values in columns.items()},
            "header": summary["log"],
            **more,
        }
        self.recordings[name] = record
        with whole_file(self._out / "logs.tar.gz") as partial, tarfile.open(partial, "w:gz") as tar:
            for done in self.recordings:
                tar.add(self._logs / f"{done}.parquet", arcname=f"logs/{done}.parquet")
        self.write()
        return record

    def add_error(self, part: str, error: Exception) -> None:
        """Add what went wrong with a part."""
        self.errors.append(f"{part}: {error}")
        self.write()

    def write(self, **more: float) -> None:
        """Write ``result.json``."""
        document = {
            "schema": "lodbench.unattended/1",
            **self._about,
            "budget_ms": self.budget_ms,
            "recordings": self.recordings,
            "frames_in_flight": self.frames_in_flight,
            "errors": self.errors,
            **more,
        }
        with whole_text_file(self._out / "result.json") as file:
            json.dump(document, file, indent=1)
