"""What a team needs to test its own policies: checks, properties, strategies, a budget to assert.

Names are loaded when they are first used, so that the plugin costs nothing until a test needs it.
`check_policy` needs neither pytest nor hypothesis.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .budget import FrameBudget, assert_budget
    from .contract import CHECKS, CheckResult, check_policy
    from .examples.strategies import hardware_profiles, scenes, traces, views
    from .parametrize import parametrize_with_checks, parametrize_with_properties
    from .promises.promise import CheckError, Promise
    from .promises.properties import (
        PROPERTIES,
        budget_is_kept,
        lag_is_bounded,
        load_steps_settle,
        more_budget_is_never_worse,
        nothing_toggles_at_rest,
        order_does_not_matter,
        reset_forgets,
    )
    from .promises.property import Property, PropertyFailedError

__all__ = [
    "CHECKS",
    "PROPERTIES",
    "CheckError",
    "CheckResult",
    "FrameBudget",
    "Promise",
    "Property",
    "PropertyFailedError",
    "assert_budget",
    "budget_is_kept",
    "check_policy",
    "hardware_profiles",
    "lag_is_bounded",
    "load_steps_settle",
    "more_budget_is_never_worse",
    "nothing_toggles_at_rest",
    "order_does_not_matter",
    "parametrize_with_checks",
    "parametrize_with_properties",
    "reset_forgets",
    "scenes",
    "traces",
    "views",
]

_MODULES = {
    "budget": ("FrameBudget", "assert_budget"),
    "contract": ("CHECKS", "CheckResult", "check_policy"),
    "parametrize": ("parametrize_with_checks", "parametrize_with_properties"),
    "promises.promise": ("CheckError", "Promise"),
    "promises.property": ("Property", "PropertyFailedError"),
    "examples.strategies": ("hardware_profiles", "scenes", "traces", "views"),
}
_WHERE = {name: module for module, names in _MODULES.items() for name in names}


def __getattr__(name: str) -> Any:
    """Return a public name, whose module is imported now."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        module = import_module(f".{_WHERE.get(name, 'promises.properties')}", __name__)
    except ModuleNotFoundError as error:
        if error.name not in {"hypothesis", "pytest"}:
            raise
        raise ImportError(
            f"lodbench.testing.{name} needs {error.name}, which is not installed; "
            "pip install 'lodbench[testing]'"
        ) from error
    return getattr(module, name)
