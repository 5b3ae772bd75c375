"""How to make a policy: a class and its parameters, or an object to copy."""

import copy
import inspect
import typing
from dataclasses import dataclass
from typing import Any

from ..base.errors import InputError
from ..base.foreign_text import describe_error
from .protocol import Capabilities, Policy


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a policy: its name, type and default."""

    name: str
    kind: Any
    default: object


@dataclass(frozen=True, slots=True)
class PolicySpec:
    """A policy to make: a class and its parameters, or an object to copy.

    Attributes
    ----------
    label : what tells it from the others; on a command line, what the user wrote
    name : the label without parameters
    cls : the class
    params : parameters that differ from their defaults
    made : the object to copy, if the user gave one
    """

    label: str
    name: str
    cls: type[Any]
    params: dict[str, object]
    made: Policy | None = None

    def make(self) -> Policy:
        """Return a new policy.

        Raises `InputError` if the class refuses the parameters, or says nothing of its
        capabilities.
        """
        try:
            policy = self.cls(**self.params) if self.made is None else copy.deepcopy(self.made)
        except InputError:
            raise
        except (Exception, SystemExit) as error:  # a user's class may raise anything
            raise InputError(f"policy {self.label}: {describe_error(error)}") from error
        capabilities: object = getattr(policy, "capabilities", None)
        if not isinstance(capabilities, Capabilities):
            raise InputError(
                f"policy {self.label}: expected a class with capabilities, a Capabilities, got "
                f"{type(capabilities).__name__}; see docs/adding-a-policy.md"
            )
        return policy


def is_oracle(spec: PolicySpec) -> bool:
    """Whether the class says that it sees the future, without making the policy."""
    capabilities: object = getattr(spec.cls, "capabilities", None)
    return isinstance(capabilities, Capabilities) and capabilities.future


def parameters(cls: type[Any]) -> list[Parameter]:
    """Return the keyword parameters of a policy class, in order.

    Raises `InputError` if an annotation does not resolve, so that values could not be converted.
    """
    try:
        hints = typing.get_type_hints(cls.__init__)
    except NameError as error:
        raise InputError(
            f"policy class {cls.__name__}: expected annotations that resolve when it is loaded, "
            f"got {error}; import the name outside of TYPE_CHECKING"
        ) from error
    return [
        Parameter(name, hints.get(name, str), parameter.default)
        for name, parameter in inspect.signature(cls).parameters.items()
    ]
