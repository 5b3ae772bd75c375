"""Axes of the parameters of policies: each policy has its own."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias, cast

from ....base.errors import InputError
from ....base.nearest_names import unknown_name
from ....policies.policy_spec import PolicySpec
from ....policies.registry import vary_policy
from ..results.record import schema_of
from .conditions import DEFAULTS, MACHINE, several
from .grid import Axis, Cell

Parameters: TypeAlias = Mapping[str, Mapping[str, Any]]
"""By the label of a policy and the name of a parameter, one value or several."""

_TAKEN = {"base_policy", "label", *DEFAULTS, *MACHINE, *schema_of({}).names}


def by_label(parameters: Parameters, specs: Sequence[PolicySpec]) -> dict[str, Mapping[str, Any]]:
    """Return the parameters to vary of each policy, by label.

    Raises `InputError` if a policy is unknown.
    """
    labels = [spec.label for spec in specs]
    for label in parameters:
        if label not in labels:
            raise InputError(f"parameters: {unknown_name(label, labels)}")
    return {label: parameters.get(label, {}) for label in labels}


def param_axis(spec: PolicySpec, column: str, name: str, given: Any) -> Axis:
    """Return the axis of a parameter, with its values as the policy has them.

    Raises `InputError` if the policy has no such parameter, or refuses a value.
    """
    varied = [vary_policy(spec, {name: value}) for value in several(given)]
    for one in varied:
        one.check_parameter(name)
    cells = tuple(one.params[name] for one in varied)
    return Axis(column, cells, cast("tuple[Cell, ...]", cells))


def column_of(parameter: str) -> str:
    """Return the column of a parameter, which must not be taken for another."""
    return f"param_{parameter}" if parameter in _TAKEN else parameter
