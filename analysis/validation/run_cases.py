"""Carry out a validation: record each case, or read it, simulate the same, and judge."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ...base.errors import InputError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene_catalog import OpenedScene
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from ..study.compare import CompareSettings
from ..study.runs import Progress, part_of
from .drawn_machine import as_drawn
from .record_options import RecordOptions
from .recorded_frames import measured_of
from .recording_folder import (
    case_folders,
    forget_recordings,
    read_recordings,
    write_recording,
)
from .recordings import Recorded, conditions
from .replays import Recordings, record_all
from .replicates import simulate_all
from .shown.charts import Series
from .validate import Judged, judge_case, validate
from .validation_result import Validation


@dataclass(frozen=True, slots=True, eq=False)
class CaseInputs:
    """One path through one scene, with what is needed to record and to simulate it.

    Attributes
    ----------
    labels : of the policies
    hardware : as frames are recorded, see `recorded_hardware`
    """

    opened: OpenedScene
    path: CameraTrace
    labels: tuple[str, ...]
    replay: ReplayOptions
    hardware: HardwareProfile
    drawing: RecordOptions

    @property
    def name(self) -> str:
        """Scene and path, and how many frames deep it is drawn, if any."""
        deep = self.drawing.frames_in_flight
        return f"{self.opened.scene.name}-{self.path.name}{f'-{deep}-deep' if deep else ''}"


@dataclass(frozen=True, slots=True, eq=False)
class Carried:
    """A validation that was carried out.

    Attributes
    ----------
    validation : Validation
    names : of the cases' folders
    series : by the number of the case, what its page draws
    """

    validation: Validation
    names: list[str]
    series: dict[int, Series]


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """Where recordings come from: drawn now, and written to a folder; or read from one.

    Attributes
    ----------
    recorded : folder to read, None to draw
    kept : folder to write each recording to as soon as it ends; None to keep them in memory
    passes : recordings of each policy
    """

    recorded: Path | None = None
    kept: Path | None = None
    passes: int = 2


def carry_out(
    cases: Sequence[CaseInputs],
    source: Source,
    scoring: CompareSettings,
    replicates: int,
    progress: Progress | None = None,
) -> Carried:
    """Record or read, simulate and judge all cases, one after the other.

    Raises `InputError` if nothing can be recorded or read of a case.
    """
    names = case_folders([case.name for case in cases])
    judged: list[Judged] = []
    series: dict[int, Series] = {}
    draws = 0
    for number, (case, name) in enumerate(zip(cases, names, strict=True)):
        recordings = _recordings(case, name, source, part_of(progress, 2 * number, 2 * len(cases)))
        if not recordings.policies:
            raise _nothing(case, recordings)
        header = dict(next(iter(recordings.policies.values()))[0].header)
        measured = {
            label: tuple(map(measured_of, passed)) for label, passed in recordings.policies.items()
        }
        machine = as_drawn(case.hardware, header, list(measured.values()))
        simulation = simulate_all(
            list(recordings.policies),
            case.opened.scene,
            case.path,
            machine,
            case.replay,
            scoring,
            replicates,
            part_of(progress, 2 * number + 1, 2 * len(cases)),
        )
        draws = max(draws, simulation.draws)
        header.pop("policy", None)
        judged.append(judge_case(simulation, measured, machine, header, recordings.failed))
        series[number] = {
            label: ([item.frames for item in passed], simulation.policies[label].log)
            for label, passed in measured.items()
            if label in simulation.policies
        }
    validation = validate(judged, cases[0].hardware, replicates, draws)
    return Carried(validation, names, series)


def _recordings(
    case: CaseInputs, name: str, source: Source, progress: Progress | None
) -> Recordings:
    if source.recorded is not None:
        same = conditions(case.opened.scene, case.path, case.hardware, case.replay)
        return read_recordings(source.recorded / name, case.labels, same)
    kept = source.kept

    def keep(label: str, again: int, recorded: Recorded) -> None:
        if kept is not None:
            write_recording(kept / name, case.labels, label, again, recorded)

    def forget(label: str) -> None:
        if kept is not None:
            forget_recordings(kept / name, case.labels, label)

    return record_all(
        case.labels,
        case.opened,
        case.path,
        case.hardware,
        case.replay,
        case.drawing,
        source.passes,
        progress,
        keep,
        forget,
    )


def _nothing(case: CaseInputs, recordings: Recordings) -> InputError:
    label, reason = next(iter(recordings.failed.items()))
    return InputError(
        f"{case.name}: expected a recording of one policy or more, got none; {label}: {reason}"
    )
