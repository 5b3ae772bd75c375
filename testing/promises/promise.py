"""A promise of policies: fixed examples in which it is tried, and a judge of what was played."""

import inspect
import traceback
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any
from unittest import SkipTest

from ...base.errors import PolicyError
from ...policies.protocol import Claims, Policy, claims_of
from ..examples.example import Example, Factory

_REST_FRAMES = 60
"""Frames after which a policy that claims nothing has to be at rest: a second at 60 Hz."""


class CheckError(AssertionError):
    """A policy breaks the contract, or what it claims; the message names the line of its file."""


@dataclass(frozen=True, slots=True)
class Failure:
    """What is wrong, and in which examples it shows, by name.

    `runs` are two that had to be alike, or one; none stands for the example that was judged.
    `cause` is what the policy raised.
    """

    message: str
    runs: tuple[tuple[str, Example], ...] = ()
    cause: BaseException | None = None


Judge = Callable[[Factory, Any, int], Failure | None]
"""From a factory, an example (or a pair) and the frames to rest to what is wrong, or None."""

Examples = Callable[[Policy, int], Iterable[Any]]
"""From a policy and the frames that it takes to rest to the fixed examples."""


@dataclass(frozen=True, slots=True)
class Promise:
    """A promise, called with what makes a policy.

    Attributes
    ----------
    name : str
    definition : str
    judge : callable
    examples : callable
    claim : str or None
        The field of `Claims` that it follows from; None of a promise that every policy makes.
    needs_loader : bool
    """

    name: str
    definition: str
    judge: Judge
    examples: Examples
    claim: str | None = None
    needs_loader: bool = False

    def claimed(self, claims: Claims) -> bool:
        """Return whether the promise follows from these claims."""
        value = True if self.claim is None else getattr(claims, self.claim)
        return value is not None and value is not False  # to rest after 0 frames is a claim

    def why_not(self, policy: Policy) -> str | None:
        """Return why the promise does not apply to a policy, or None if it does."""
        if not self.claimed(claims_of(policy)):
            return f"does not claim {self.claim}"
        if self.needs_loader and not policy.capabilities.loader:
            return "needs no loader"
        if next(iter(self.examples(policy, 0)), None) is None:
            return "fits none of the scenes"
        return None

    def __call__(self, factory: Factory) -> None:
        """Try the fixed examples.

        Raises `CheckError` if one fails, and `unittest.SkipTest` if the promise does not apply.
        """
        __tracebackhide__ = True  # for pytest: the message says all
        policy = factory()
        reason = self.why_not(policy)
        if reason is not None:
            raise SkipTest(reason)
        rest = rest_claimed(policy)
        for example in self.examples(policy, rest):
            failure = self.try_one(factory, rest, example)
            if failure is not None:
                scene = "".join(f"{run.scene.name}, " for _, run in failure.runs[:1])
                place = locate(type(policy), failure.cause)
                raise CheckError(f"{place}: {scene}{failure.message}") from failure.cause

    def try_one(self, factory: Factory, rest: int, example: Any) -> Failure | None:
        """Return what is wrong in an example; a broken contract is wrong under every promise."""
        try:
            failure = self.judge(factory, example, rest)
        except PolicyError as error:
            frame = "reset" if error.frame is None else f"frame {error.frame}"
            first = example if isinstance(example, Example) else example[0]
            return Failure(f"{frame}: {error.reason}", (("example", first),), error.__cause__)
        if failure is not None and not failure.runs and isinstance(example, Example):
            return replace(failure, runs=(("example", example),))
        return failure


def promise(
    examples: Examples, claim: str | None = None, *, needs_loader: bool = False
) -> Callable[[Judge], Promise]:
    """Return a decorator that makes a promise of its judge, which has its name and definition."""

    def made(judge: Judge) -> Promise:
        definition = " ".join((judge.__doc__ or "").split())
        return Promise(judge.__name__, definition, judge, examples, claim, needs_loader)

    return made


def rest_claimed(policy: Policy) -> int:
    """Return the frames that a policy may take to come to rest."""
    claimed = claims_of(policy).settles_frames
    return _REST_FRAMES if claimed is None else claimed


def locate(made_by: Callable[..., Any], cause: BaseException | None = None) -> str:
    """Return ``file:line`` where a class (or function) raised, or else where it stands."""
    source: Any = made_by.func if isinstance(made_by, partial) else made_by
    line = 0
    try:
        file, line = inspect.getsourcefile(source), inspect.getsourcelines(source)[1]
    except (OSError, TypeError):  # typed at a prompt, or not Python
        file = None
    bases = source.__mro__ if inspect.isclass(source) else (source,)
    files = {getattr(_code(base), "co_filename", None) for base in bases} | {file}
    for frame, at in traceback.walk_tb(cause.__traceback__ if cause else None):
        if frame.f_code.co_filename in files:
            file, line = frame.f_code.co_filename, at
    if file is None:
        return f"{source.__module__}:{source.__qualname__}"
    path, here = Path(file), Path.cwd()
    return f"{path.relative_to(here) if path.is_relative_to(here) else path}:{line}"


def _code(source: Any) -> object:
    """Return the code of a function, or of a class's `select`."""
    return getattr(getattr(source, "select", source), "__code__", None)
