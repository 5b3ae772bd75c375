"""Formulas of a user: what they mean, and that nothing else gets through."""

import math
from typing import Any

import casadi
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.policies.solvers.expression import symbolic

SX: Any = casadi.SX
Function: Any = casadi.Function


def value(text: str, **names: float) -> float:
    """Return the value of a formula."""
    symbols = {name: SX.sym(name) for name in names}
    formula = symbolic(text, symbols, "cost")
    return float(Function("f", list(symbols.values()), [formula])(*names.values()))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("2 + 3 * r", 3.5),
        ("-r ** 2", -0.25),
        ("+a / (r - 1)", -8.0),
        ("sqrt(a) * exp(0) + log10(100) - log(1)", 4.0),
        ("min(a, 3) + max(r, 1) + abs(-2)", 6.0),
        (" 1e3 * r ", 500.0),
        ("9 ** 9 ** 9", math.inf),
    ],
)
def test_arithmetic(text: str, expected: float) -> None:
    """Operators and functions as in Python; powers bind to the right and never run for ever."""
    assert value(text, r=0.5, a=4.0) == expected


def test_it_is_derived_exactly() -> None:
    """What comes out can be differentiated, which is why it is symbolic."""
    r = SX.sym("r")
    slope = casadi.jacobian(symbolic("4 / r ** 2", {"r": r}, "cost"), r)  # pyright: ignore[reportUnknownMemberType, reportUnknownVariableType] - casadi has no types
    assert float(Function("f", [r], [slope])(2.0)) == -1.0


@pytest.mark.parametrize(
    "text",
    [
        "",
        "r +",
        "r; r",
        "r = 1",
        "lambda: r",
        "r.real",
        "r[0]",
        "[r]",
        "r if r else 1",
        "r < 1",
        "r // 2",
        "'text'",
        "True",
        "1j",
        "(yield)",
        "f'{r}'",
        "exp(r, r)",
        "min(r)",
        "exp(x=r)",
        "exp(*r)",
        "exp(exp)(r)",
        "__import__('os').system('true')",
        "().__class__",
        "r\0",
        "(" * 500 + "r" + ")" * 500,
        "1" * 400 + " * r",
        "r + " * 300 + "r",
    ],
)
def test_anything_else_is_refused(text: str) -> None:
    """No attribute, index, comparison, string, statement or call of anything else."""
    with pytest.raises(InputError, match="cost: expected"):
        symbolic(text, {"r": SX.sym("r")}, "cost")


def test_an_unknown_name_suggests_the_nearest() -> None:
    """Of values and of functions."""
    symbols = {"area": SX.sym("area"), "r": SX.sym("r")}
    with pytest.raises(InputError, match=r"one of area, r, got aera; did you mean area\?"):
        symbolic("aera / r", symbols, "degradation")
    with pytest.raises(InputError, match=r"got sqr; did you mean sqrt\?"):
        symbolic("sqr(area)", symbols, "degradation")


@given(text=st.text(alphabet="r0123456789.+-*/()e, _abs", max_size=30))
def test_any_text_gives_a_formula_or_an_input_error(text: str) -> None:
    """Nothing but `InputError` escapes."""
    try:
        formula = symbolic(text, {"r": SX.sym("r")}, "cost")
    except InputError:
        return
    assert isinstance(formula, SX)
