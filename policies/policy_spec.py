"""How to make a policy: a class and its parameters, or an object to copy."""

import copy
import inspect
import typing
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from ..base.errors import InputError, PolicyError
from ..base.foreign_text import describe_error
from .protocol import Capabilities, Policy
from .shared.ranges import check_values


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

    def check_parameters(self) -> None:
        """Raise `InputError` if parameters are refused, as far as can be told without the class.

        One may be missing, or out of the range that a class of ours declares for it.  No code of a
        user's is run.
        """
        if self.made is not None:
            return
        try:
            inspect.signature(self.cls).bind(**self.params)
        except TypeError as error:
            raise InputError(f"policy {self.label}: expected its parameters, got {error}") from None
        if self._declares_ranges:
            known = {field.name: field.default for field in fields(self.cls) if field.init}
            check_values(self.cls, known | self.params, self.name)

    def check_parameter(self, name: str) -> None:
        """Raise `InputError` if one parameter that is given is refused whatever the others are."""
        if self._declares_ranges:
            check_values(self.cls, {name: self.params[name]}, self.name)

    @property
    def _declares_ranges(self) -> bool:
        return self.cls.__module__.startswith("lodbench.") and is_dataclass(self.cls)

    def make(self) -> Policy:
        """Return a new policy.

        Raises
        ------
        InputError
            If the class refuses the parameters, or says nothing of its capabilities.
        PolicyError
            If the class, or copying the object, raises anything else.
        """
        self.check_parameters()
        try:
            policy = self.cls(**self.params) if self.made is None else copy.deepcopy(self.made)
        except InputError:
            raise
        except (Exception, SystemExit) as error:  # a user's class may raise anything
            reason = f"cannot be made: {describe_error(error)}"
            raise PolicyError(self.label, None, reason) from error
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
