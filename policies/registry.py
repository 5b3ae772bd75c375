"""Policies by name, as classes and as objects.

A policy is named ``name`` or ``name:key=value,key=value``.  A name is a registered one, or
``path/to/file.py:Class`` or ``package.module:Class`` for a user's own.  The package's own classes
are imported when they are made, not before.
"""

import inspect
import types
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeAlias, cast, get_args

import msgspec

from ..base.errors import InputError
from ..base.name_registry import Registry
from ..base.nearest_names import unknown_name
from .policy_spec import Parameter, PolicySpec, parameters
from .protocol import Policy

REGISTERED: Registry[object] = Registry(
    "policy",
    object,
    f"{__package__}",
    {
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
    },
)
"""The policy classes by name."""

PolicyLike: TypeAlias = str | type[Any] | Policy | PolicySpec
"""A policy as a user may give it: by name, as a class, or as an object."""

PolicyLikes: TypeAlias = PolicyLike | Iterable[PolicyLike] | Mapping[str, PolicyLike]
"""One policy, several, or several by label."""

_ON_REQUEST = ("gobbetti-custom", "predictive")
"""Policies that run when named: by default they are another policy, solved slowly or wrapped."""


def default_policies() -> tuple[str, ...]:
    """Return the names of the policies that a comparison runs when none is named."""
    return tuple(name for name in REGISTERED if name not in _ON_REQUEST)


def parse_policy(text: str) -> PolicySpec:
    """Return the policy that a command line names.

    Raises `InputError` if the name or a key is unknown (the nearest is suggested), a value does not
    convert, or a user's file or class cannot be loaded.
    """
    name, given = _split(text)
    cls = _class_of(name)
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


def policy_text(name: str, params: Mapping[str, object]) -> str:
    """Return what a command line calls a policy: what `parse_policy` reads."""
    words = [f"{key}={_word(value)}" for key, value in params.items()]
    return f"{name}:{','.join(words)}" if words else name


def vary_policy(spec: PolicySpec, params: Mapping[str, object]) -> PolicySpec:
    """Return a policy with other parameters, labelled as a command line would name it.

    Raises `InputError` if a parameter is unknown (the nearest is suggested), a value does not
    convert, or the policy is an object, whose parameters are what they are.
    """
    if spec.made is not None:
        raise InputError(f"policy {spec.label}: expected a name or a class to vary, got an object")
    known = {parameter.name: parameter for parameter in parameters(spec.cls)}
    changed = dict(spec.params)
    for key, value in params.items():
        if key not in known:
            raise InputError(f"policy {spec.label}: {unknown_name(key, sorted(known))}")
        changed[key] = _convert(str(_word(value)), known[key], spec.label)
    shown = ",".join(f"{key}={_word(changed[key])}" for key in params)
    comma = "," if spec.params else ":"
    return replace(spec, label=f"{spec.label}{comma}{shown}", params=changed)


def spec_of(policy: PolicyLike, label: str | None = None) -> PolicySpec:
    """Return how to make a policy that is given by name, as a class or as an object.

    A class is labelled by its name, an object also by the parameters that it was made with.

    Raises `InputError` as `parse_policy` does, or if it is no policy.
    """
    if isinstance(policy, PolicySpec):
        spec = policy
    elif isinstance(policy, str):
        spec = parse_policy(policy)
    elif isinstance(policy, type):
        name = policy.__name__
        spec = PolicySpec(name, name, _policy_class(name, policy), {})
    else:
        name = type(policy).__name__
        cls = _policy_class(name, type(policy))
        params = _given(policy)
        spec = PolicySpec(policy_text(name, params), name, cls, params, policy)
    return spec if label is None else replace(spec, label=label)


def specs_of(policies: PolicyLikes) -> list[PolicySpec]:
    """Return how to make one policy or several; the keys of a mapping are their labels.

    Raises `InputError` as `spec_of` does, or if two have one label.
    """
    if isinstance(policies, (str, type, Policy, PolicySpec)):
        specs = [spec_of(policies)]
    elif isinstance(policies, Mapping):
        labelled = cast("Mapping[str, PolicyLike]", policies)
        specs = [spec_of(policy, label) for label, policy in labelled.items()]
    elif isinstance(policies, Iterable):  # pyright: ignore[reportUnnecessaryIsInstance]
        specs = [spec_of(policy) for policy in policies]
    else:
        raise InputError(f"policies: expected names, classes or objects, got {policies!r}")
    if not specs:
        raise InputError("policies: expected one or more, got none; name one")
    require_distinct(specs)
    return specs


def require_distinct(specs: Sequence[PolicySpec]) -> None:
    """Raise `InputError` if two policies have one label, or one has a label that names no file."""
    labels: list[object] = [spec.label for spec in specs]
    for label in labels:
        if not isinstance(label, str) or not label.isprintable() or not label.strip(". "):
            raise InputError(f"policy: expected a label of one line, got {label!r}; name it")
        if labels.count(label) > 1:
            raise InputError(f"policy: expected each once, got {label} twice; name it once")


def register_policy(name: str, cls: type[Any]) -> None:
    """Give a policy class a name of its own in this process; the last one of a name counts.

    Raises `InputError` if the name is one of ours or holds a colon, or the class is no policy.
    """
    REGISTERED.register(name, _policy_class(name, cls))


def _split(text: str) -> tuple[str, str]:
    """Split off the parameters; the name itself holds a colon in ``file.py:Class``."""
    head, equals, _ = text.partition("=")
    if not equals:
        return text.strip(), ""
    name, colon, _ = head.rpartition(":")
    if not colon:
        raise InputError(f"policy {text}: expected name:key=value, got no colon before the key")
    return name.strip(), text[len(name) + 1 :]


def _class_of(name: str) -> type[Any]:
    owner, _, rest = name.rpartition(":")
    if owner in REGISTERED:
        raise InputError(f"policy {owner}: expected key=value after the colon, got {rest or name}")
    return _policy_class(name, REGISTERED.find(name))


def _policy_class(name: str, cls: object) -> type[Any]:
    if not (inspect.isclass(cls) and hasattr(cls, "select") and hasattr(cls, "reset")):
        raise InputError(f"policy {name}: expected a class with reset and select")
    return cls


def _given(policy: Policy) -> dict[str, object]:
    """Return the parameters of an object that are plain values other than their defaults."""
    known = inspect.signature(type(policy)).parameters
    values = {name: getattr(policy, name, ...) for name in known}
    plain = (bool, int, float, str, types.NoneType)
    defaults = {name: parameter.default for name, parameter in known.items()}
    return {
        name: value
        for name, value in values.items()
        # A default of another kind, such as an array, is not what a plain value could equal.
        if isinstance(value, plain)
        and not (isinstance(defaults[name], plain) and value == defaults[name])
    }


def _word(value: object) -> object:
    if isinstance(value, bool):
        return "on" if value else "off"
    return "none" if value is None else value


def _convert(value: str, parameter: Parameter, text: str) -> object:
    """Convert a value to the parameter's annotation: on and off are booleans, none is None."""
    word = {"on": True, "off": False, "none": None}.get(value.lower(), value)
    if bool not in (parameter.kind, *get_args(parameter.kind)) and word is not None:
        word = value
    try:
        return msgspec.convert(word, parameter.kind, strict=False)
    except msgspec.ValidationError as error:
        raise InputError(f"policy {text}: {parameter.name}: {error}, got {value}") from error
