"""A property of policies: drawn examples, a judge, and a report of the smallest that fails."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis.errors import Flaky
from hypothesis.strategies import SearchStrategy

from ..base.errors import PolicyError
from ..policies.protocol import Capabilities, Claims, claims_of
from .example import Example, Factory
from .failure import Failure, write_failure

FAILURES = Path("lodbench-failures")
"""Where failing examples are written unless told otherwise, a folder a policy and property."""

_REST_FRAMES = 60
"""Frames after which a policy that claims nothing has to be at rest: a second at 60 Hz."""

_UNCHECKED = (HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.nested_given)


class PropertyFailedError(AssertionError):
    """A policy lacks a property; the message names the smallest example and its files."""

    def __init__(self, message: str, failure: Failure | None = None) -> None:
        super().__init__(message)
        self.failure = failure


class _Found(Exception):  # noqa: N818 - carries an example out of hypothesis, never to a user
    def __init__(self, failure: Failure) -> None:
        super().__init__(failure.message)
        self.failure = failure


@dataclass(frozen=True, slots=True)
class Property:
    """A property, called with what makes a policy.

    Attributes
    ----------
    name : str
    definition : str
    draw : callable
        From what a policy can drive and the frames it takes to rest to a strategy of examples.
    judge : callable
        From a factory, an example and the frames to rest to what is wrong, or None.
    claimed : callable
        Whether a policy's claims include it; the properties of the contract need no claim.
    """

    name: str
    definition: str
    draw: Callable[[Capabilities, int], SearchStrategy[Any]]
    judge: Callable[[Factory, Any, int], Failure | None]
    claimed: Callable[[Claims], bool]

    def __call__(
        self,
        factory: Factory,
        *,
        examples: int = 100,
        rest_frames: int | None = None,
        folder: Path = FAILURES,
    ) -> None:
        """Try examples, always the same ones; the smallest that fails is written to `folder`.

        Parameters
        ----------
        factory
            A policy class, or a function without arguments that makes a policy.
        rest_frames
            Frames that the policy may take to come to rest; None for what it claims, or 60.

        Raises
        ------
        PropertyFailedError
            If an example is found.
        """
        __tracebackhide__ = True  # for pytest: the message says all
        policy = factory()
        if rest_frames is None:
            claimed = claims_of(policy).settles_frames
            rest_frames = _REST_FRAMES if claimed is None else claimed
        title = f"{self.name} of {type(policy).__name__}"
        strategy = self.draw(policy.capabilities, rest_frames)
        failure = _search(strategy, partial(self._try, factory, rest_frames), examples, title)
        if failure is not None:
            place = folder / title.replace(" ", "-")
            raise PropertyFailedError(write_failure(place, failure, factory, title), failure)

    def _try(self, factory: Factory, rest_frames: int, drawn: Any) -> Failure | None:
        try:
            return self.judge(factory, drawn, rest_frames)
        except PolicyError as error:
            example = drawn if isinstance(drawn, Example) else drawn[0]
            return Failure(str(error), (("example", example),))


def _search(
    strategy: SearchStrategy[Any],
    judge: Callable[[Any], Failure | None],
    examples: int,
    title: str,
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
    except Flaky as error:
        raise PropertyFailedError(
            f"{title}: the policy decides differently on the same example; nothing may be drawn "
            "by lot, kept on the class or read off a clock"
        ) from error
    return None
