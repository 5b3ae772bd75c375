"""Registered policies, and policies named on a command line.

A policy is named ``name`` or ``name:key=value,key=value``.  A name is a registered one, or
``path/to/file.py:Class`` or ``package.module:Class`` for a user's own.  Registered classes are
imported when they are made, not before.
"""

import importlib
import importlib.util
import inspect
import sys
import types
import typing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from ..base.errors import InputError
from ..base.nearest_names import unknown_name
from .protocol import Capabilities, Policy

REGISTERED = {
    "full": "bounds.full:Full",
    "static-distance": "thresholds.static_distance:StaticDistance",
    "static-screen": "thresholds.static_screen:StaticScreen",
    "feedback": "controllers.feedback:Feedback",
    "lodmanager": "budgets.lodmanager:LodManager",
    "funkhouser": "budgets.funkhouser:Funkhouser",
    "gobbetti": "budgets.gobbetti:Gobbetti",
    "gobbetti-custom": "budgets.gobbetti_custom:GobbettiCustom",
    "wimmer": "budgets.wimmer:Wimmer",
    "peng": "budgets.peng:Peng",
    "hlod-hysteresis": "hierarchies.hlod_hysteresis:HlodHysteresis",
    "mason-blake": "hierarchies.mason_blake:MasonBlake",
    "maciel": "hierarchies.maciel:Maciel",
    "erikson": "hierarchies.erikson:Erikson",
    "zach": "budgets.zach:Zach",
    "screen-space-error": "thresholds.screen_space_error:ScreenSpaceError",
    "pixel-error": "thresholds.pixel_error:PixelError",
    "cluster-cut": "hierarchies.cluster_cut:ClusterCut",
    "hoppe": "controllers.hoppe:Hoppe",
    "unity-adaptive": "controllers.unity_adaptive:UnityAdaptive",
    "unreal-dynamic": "controllers.unreal_dynamic:UnrealDynamic",
    "pid": "controllers.pid:Pid",
    "oracle": "bounds.oracle:Oracle",
    "predictive": "controllers.predictive:Predictive",
}
"""Class of each registered policy, as ``module:Class`` in this package."""

_ON_REQUEST = ("gobbetti-custom", "predictive")
"""Policies that run when named: by default they are another policy, solved slowly or wrapped."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a policy: its name, type and default."""

    name: str
    kind: Any
    default: object


@dataclass(frozen=True, slots=True)
class PolicySpec:
    """A policy class and the parameters that a user gave.

    Attributes
    ----------
    text : what the user wrote
    name : the part before the parameters
    cls : the class
    params : given parameters, converted
    """

    text: str
    name: str
    cls: type[Any]
    params: dict[str, object]

    def make(self) -> Policy:
        """Return a new policy.

        Raises `InputError` if the class refuses the parameters, or says nothing of its
        capabilities.
        """
        try:
            policy = self.cls(**self.params)
        except InputError:
            raise
        except (Exception, SystemExit) as error:  # a user's class may raise anything
            raise InputError(f"policy {self.text}: {type(error).__name__}: {error}") from error
        said: object = getattr(policy, "capabilities", None)
        if not isinstance(said, Capabilities):
            raise InputError(
                f"policy {self.text}: expected a class with capabilities, a Capabilities, got "
                f"{type(said).__name__}; see docs/adding-a-policy.md"
            )
        return policy


def default_policies() -> tuple[str, ...]:
    """Return the names of the policies that a comparison runs when none is named."""
    return tuple(name for name in REGISTERED if name not in _ON_REQUEST)


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


def parse_policy(text: str) -> PolicySpec:
    """Return the policy that a command line names.

    Raises `InputError` if the name or a key is unknown (the nearest is suggested), a value does not
    convert, or a user's file or class cannot be loaded.
    """
    name, given = _split(text)
    cls = _find(name)
    known = {parameter.name: parameter for parameter in parameters(cls)}
    params: dict[str, object] = {}
    for item in filter(None, given.split(",")):
        key, equals, value = item.partition("=")
        key = key.strip().replace("-", "_")
        if not equals:
            raise InputError(f"policy {text}: expected key=value, got {item}")
        if key not in known:
            raise InputError(f"policy {name}: {unknown_name(key, sorted(known))}")
        params[key] = _convert(value.strip(), known[key], text)
    return PolicySpec(text, name, cls, params)


def _split(text: str) -> tuple[str, str]:
    """Split off the parameters; the name itself holds a colon in ``file.py:Class``."""
    head, equals, _ = text.partition("=")
    if not equals:
        return text.strip(), ""
    name, colon, _ = head.rpartition(":")
    if not colon:
        raise InputError(f"policy {text}: expected name:key=value, got no colon before the key")
    return name.strip(), text[len(name) + 1 :]


def _find(name: str) -> type[Any]:
    if name in REGISTERED:
        module, _, cls = REGISTERED[name].partition(":")
        return getattr(importlib.import_module(f".{module}", __package__), cls)
    where, _, cls = name.rpartition(":")
    if where in REGISTERED:
        raise InputError(f"policy {where}: expected key=value after the colon, got {cls or name}")
    if not (where and cls):
        own = "your own as file.py:Class"
        raise InputError(f"policy: {unknown_name(name, sorted(REGISTERED), instead=own)}")
    module = _load_file(Path(where)) if where.endswith(".py") else _import(where)
    found = getattr(module, cls, None)
    if not inspect.isclass(found):
        classes = [
            n for n, c in vars(module).items() if inspect.isclass(c) and hasattr(c, "select")
        ]
        raise InputError(f"policy {where}: {unknown_name(cls, sorted(classes))}")
    if not (hasattr(found, "select") and hasattr(found, "reset")):
        raise InputError(f"policy {name}: expected a class with reset and select")
    return found


def _load_file(path: Path) -> types.ModuleType:
    if not path.is_file():
        raise InputError("expected a Python file with a policy, got no file", path=path)
    # Registered under a name of its own, so that instances pickle and the file stays importable.
    name = f"lodbench_user_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None, "a .py file has a loader"
    assert spec.loader is not None, "a .py file has a loader"
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:  # a script may end with sys.exit()
        line = error.lineno if isinstance(error, SyntaxError) else None
        raise InputError(
            f"expected a Python file that loads, got {type(error).__name__}: {error}",
            path=path,
            line=line,
        ) from error
    return module


def _import(name: str) -> types.ModuleType:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise InputError(f"policy module {name}: {error}; is it installed?") from error


def _convert(value: str, parameter: Parameter, text: str) -> object:
    """Convert a value to the parameter's annotation: on and off are booleans, none is None."""
    word = {"on": True, "off": False, "none": None}.get(value.lower(), value)
    if bool not in (parameter.kind, *typing.get_args(parameter.kind)) and word is not None:
        word = value
    try:
        return msgspec.convert(word, parameter.kind, strict=False)
    except msgspec.ValidationError as error:
        raise InputError(f"policy {text}: {parameter.name}: {error}, got {value}") from error
