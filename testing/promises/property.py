"""A promise explored by hypothesis: drawn examples, and a report of the smallest that fails."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis.errors import Flaky
from hypothesis.strategies import SearchStrategy

from ...policies.protocol import Capabilities
from ..examples.example import Factory
from ..failure import write_failure
from .promise import CheckError, Failure, Promise, locate, rest_claimed

FAILURES = Path("lodbench-failures")
"""Where failing examples are written unless told otherwise, a folder a policy and property."""

_UNCHECKED = (HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.nested_given)


class PropertyFailedError(CheckError):
    """A policy lacks a property; the message names the smallest example and its files."""

    def __init__(self, message: str, failure: Failure | None = None) -> None:
        super().__init__(message)
        self.failure = failure


class _Found(Exception):  # noqa: N818 - carries an example out of hypothesis, never to a user
    def __init__(self, failure: Failure) -> None:
        super().__init__(failure.message)
        self.failure = failure


Draw = Callable[[Capabilities, int], SearchStrategy[Any]]
"""From what a policy can drive and the frames it takes to rest to a strategy of examples."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Property(Promise):
    """A promise that is called to try drawn examples instead of the fixed ones."""

    draw: Draw

    @classmethod
    def of(cls, promise: Promise, draw: Draw) -> "Property":
        """Return a promise with a strategy of examples."""
        known = {field.name: getattr(promise, field.name) for field in fields(promise)}
        return cls(**known, draw=draw)

    def __call__(
        self,
        factory: Factory,
        *,
        examples: int = 100,
        rest_frames: int | None = None,
        folder: Path = FAILURES,
    ) -> None:
        """Try examples, always the same ones; the smallest that fails is written to `folder`.

        Raises `PropertyFailedError` if an example is found.

        Parameters
        ----------
        factory
            A policy class, or a function without arguments that makes a policy.
        rest_frames
            Frames that the policy may take to come to rest; None for what it claims, or 60.
        """
        __tracebackhide__ = True  # for pytest: the message says all
        policy = factory()
        rest = rest_claimed(policy) if rest_frames is None else rest_frames
        title = f"{self.name} of {type(policy).__name__}"
        strategy = self.draw(policy.capabilities, rest)
        try:
            failure = _search(strategy, partial(self.try_one, factory, rest), examples)
        except Flaky as error:
            raise PropertyFailedError(
                f"{locate(type(policy))}: {title}: the policy decides differently on the same "
                "example; nothing may be drawn by lot, kept on the class or read off a clock"
            ) from error
        if failure is not None:
            report = write_failure(folder / title.replace(" ", "-"), failure, factory, title)
            place = locate(type(policy), failure.cause)
            raise PropertyFailedError(f"{place}: {report}", failure)


def _search(
    strategy: SearchStrategy[Any], judge: Callable[[Any], Failure | None], examples: int
) -> Failure | None:
    """Return the smallest failure that hypothesis finds."""

    @settings(
        max_examples=examples,
        deadline=None,
        database=None,
        derandomize=True,
        report_multiple_bugs=False,
        phases=(Phase.generate, Phase.shrink),
        suppress_health_check=_UNCHECKED,
    )
    @given(strategy)
    def holds(drawn: Any) -> None:
        failure = judge(drawn)
        if failure is not None:
            raise _Found(failure)

    try:
        holds()
    except _Found as found:
        return found.failure
    return None
