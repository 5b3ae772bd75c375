"""Formulas that a user writes, as symbolic expressions of casadi.

A formula has numbers, the names that it is told, ``+ - * / **``, parentheses, and the functions
sqrt, exp, log, log10, abs, min and max.  It is parsed, never evaluated as Python.
"""

import ast
from collections.abc import Callable, Mapping
from typing import Any

from ...base.errors import InputError
from ...base.nearest_names import unknown_name

_LONGEST = 1000
_OPERATORS: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
    ast.Pow: lambda a, b: a**b,
}
_FUNCTIONS = {
    "sqrt": ("sqrt", 1),
    "exp": ("exp", 1),
    "log": ("log", 1),
    "log10": ("log10", 1),
    "abs": ("fabs", 1),
    "min": ("fmin", 2),
    "max": ("fmax", 2),
}
"""Name in casadi and number of arguments."""


def symbolic(text: str, symbols: Mapping[str, Any], what: str) -> Any:
    """Return a formula over casadi symbols; `what` names it in errors.

    Raises `InputError` if the text is no formula or names something unknown.
    """
    if len(text) > _LONGEST:
        raise InputError(f"{what}: expected at most {_LONGEST} characters, got {len(text)}")
    try:
        body = ast.parse(text.strip(), mode="eval").body
        return _build(body, symbols, what)
    except (SyntaxError, ValueError, RecursionError, MemoryError, OverflowError) as error:
        raise InputError(f"{what}: expected a formula, got {text}; {error}") from error


def _build(node: ast.expr, symbols: Mapping[str, Any], what: str) -> Any:
    import casadi

    library: Any = casadi
    match node:
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            return library.SX(float(value))
        case ast.Name(id=name):
            return _look_up(name, symbols, what)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_build(operand, symbols, what)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _build(operand, symbols, what)
        case ast.BinOp(op=op, left=left, right=right) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](_build(left, symbols, what), _build(right, symbols, what))
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
            function, count = _look_up(name, _FUNCTIONS, what)
            if len(arguments) != count:
                raise InputError(
                    f"{what}: expected {count} values in {name}(), got {len(arguments)}"
                )
            return getattr(library, function)(*(_build(a, symbols, what) for a in arguments))
        case _:
            raise InputError(
                f"{what}: expected numbers, names, + - * / ** and the functions "
                f"{', '.join(_FUNCTIONS)}; got {ast.unparse(node)}"
            )


def _look_up(name: str, known: Mapping[str, Any], what: str) -> Any:
    if name in known:
        return known[name]
    raise InputError(f"{what}: {unknown_name(name, known)}")
