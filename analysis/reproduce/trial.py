"""One measurement of an experiment, as a small value that any process can carry out."""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any, ClassVar, TypeAlias

from ...base.content_hash import content_hash
from ..study.code_hash import package_hash
from ..study.engine.task import Beat, Inputs

Numbers: TypeAlias = dict[str, Any]
"""What a trial gives: finite numbers, text, and lists of these, by name."""

Value: TypeAlias = str | float | int | bool | tuple[float, ...] | None


@dataclass(frozen=True, slots=True)
class Trial:
    """A function of this folder and its arguments.

    Attributes
    ----------
    key : str
        Names the trial within its experiment.
    function : str
        Such as ``gumbau.frame_rates:measure``; it is called with the arguments by keyword, and with
        `beat`, to be told of every frame that begins.
    arguments : tuple of (str, value)
    """

    key: str
    function: str
    arguments: tuple[tuple[str, Value], ...] = ()

    result_type: ClassVar[Any] = Numbers

    @property
    def owner(self) -> str:
        """Whose failure it would be (see `Task`): trials of one function may share a process."""
        return self.function

    @property
    def digest(self) -> str:
        """Content hash of the function, its arguments and all sources of the package."""
        return content_hash(package_hash(), self.function, self.arguments)

    def __call__(self, inputs: Inputs, beat: Beat) -> Numbers:
        """Measure (see `Task`); the inputs are not used: trials load what they name."""
        module, name = self.function.split(":")
        measure = getattr(import_module(f".{module}", __package__), name)
        numbers: Numbers = measure(**dict(self.arguments), beat=beat)
        return numbers


def trial(key: str, function: str, arguments: Mapping[str, Value]) -> Trial:
    """Return a trial from a mapping of arguments."""
    return Trial(key, function, tuple(sorted(arguments.items())))
