"""What an engine is given and what it gives back.

A task is a pure function of itself and of the inputs of its study.  An engine may carry it out
anywhere, at any time and more than once: its result does not depend on that.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Protocol, Self, TypeAlias

Beat: TypeAlias = Callable[[int], None]
"""Called with the number of the frame that a task begins, so that a watcher knows that it lives."""

Inputs: TypeAlias = Mapping[str, Any]
"""What the tasks of a study share, by content hash: scenes, paths, hardware.  Read-only."""


class Task(Protocol):
    """One piece of a study.

    Attributes
    ----------
    result_type : type
        Of the result, as msgspec decodes it: numbers, text, arrays, and records of these.  Results
        come from processes that ran a user's code.  They travel as data, and what does not fit
        this type is a failure.
    """

    result_type: ClassVar[Any]

    @property
    def owner(self) -> str:
        """Who is to blame for a failure: tasks of two owners never share a process."""
        ...

    def __call__(self, inputs: Inputs, beat: Beat) -> Any:
        """Return the result.

        Raises `PolicyError` if the policy breaks its contract, `NotApplicableError` if it does not
        fit the scene, and `InputError` if the study itself cannot be done.
        """
        ...


@dataclass(frozen=True, slots=True)
class Failure:
    """Why a task has no result.

    Attributes
    ----------
    kind : "failed" or "not-applicable"
    reason : str
        One line.
    frame : int or None
        The frame in which it happened; None before the first, or where it is not known.
    """

    kind: Literal["failed", "not-applicable"]
    reason: str
    frame: int | None = None

    def __str__(self) -> str:
        where = "reset" if self.frame is None else f"frame {self.frame}"
        return self.reason if self.kind == "not-applicable" else f"{where}: {self.reason}"


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of one task.

    Attributes
    ----------
    index : int
        Of the task, in the order in which they were given.
    result : object
        None if it failed.
    failure : Failure or None
    took_s : float
        Wall time, outside of every promise of equal bytes.
    peak_bytes : int
        Most memory that the process of the task had, likewise.
    """

    index: int
    result: Any
    failure: Failure | None = None
    took_s: float = 0.0
    peak_bytes: int = 0


class NotApplicableError(Exception):
    """A policy does not fit the scene that it should be replayed in."""


class Engine(Protocol):
    """Carries out tasks; a context manager, which ends its processes when it is left."""

    def run(self, tasks: Sequence[Task], *, stop: bool = True) -> Iterator[Outcome]:
        """Yield what became of each task as it is finished, in any order.

        With `stop`, the tasks of an owner that come after its first failure in the order given are
        not carried out, and have no outcome.  Those before it are, so that the first failure of an
        owner is the same on every engine.

        Raises `InputError` if a task does, or if it cannot reach another process.
        """
        ...

    def __enter__(self) -> Self: ...

    def __exit__(self, *exception: object) -> None: ...
