"""The record of experiments: behind the terminal, the page and the JSON."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

from .experiment import Chart, Experiment

SCHEMA = "lodbench.reproduce/2"


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """One claim of an experiment (see `Claim`), with where the experiment's constants are from."""

    id: str
    claim: str
    paper: str
    ours: str
    tolerance: str
    verdict: str
    constants: dict[str, str]


@dataclass(frozen=True, slots=True)
class Section:
    """One experiment with what it gave.

    Attributes
    ----------
    experiment : Experiment
    entries : tuple of Entry
    charts : tuple of Chart
    notes : tuple of str
    """

    experiment: Experiment
    entries: tuple[Entry, ...]
    charts: tuple[Chart, ...]
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Reproduction:
    """Experiments, their claims and verdicts.

    Attributes
    ----------
    command, version, code : str
        How it was made: the command line, and version and hash of the sources.
    reduced : bool
        Whether at reduced size.
    sections : tuple of Section
    """

    command: str
    version: str
    code: str
    reduced: bool
    sections: tuple[Section, ...]

    @property
    def entries(self) -> Iterator[Entry]:
        """The claims of all experiments."""
        for section in self.sections:
            yield from section.entries

    def to_json(self) -> dict[str, Any]:
        """Return the document of ``--json``."""
        return {
            "schema": SCHEMA,
            "command": self.command,
            "version": self.version,
            "code": self.code,
            "reduced": self.reduced,
            "experiments": [asdict(entry) for entry in self.entries],
            "settings": [
                {
                    "id": section.experiment.id,
                    "title": section.experiment.title,
                    "setting": section.experiment.setting,
                    "constants": {
                        name: asdict(constant)
                        for name, constant in section.experiment.constants.items()
                    },
                    "notes": list(section.notes),
                    "charts": [asdict(chart) for chart in section.charts],
                }
                for section in self.sections
            ],
        }
