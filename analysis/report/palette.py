"""One colour and dash for each policy, the same in every chart and table of a report."""

from dataclasses import dataclass

from ..study.comparison import Comparison

# Okabe and Ito, "Color universal design", 2008: told apart with any colour vision; without its
# black and yellow, which vanish on a dark and on a light page.
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_DASHES = ("solid", "dash", "dot", "dashdot")
_SYMBOLS = ("circle", "square", "diamond", "triangle-up")
_ORACLE = "#888888"


@dataclass(frozen=True, slots=True)
class Ink:
    """How a policy is drawn."""

    color: str
    dash: str
    symbol: str


def inks(comparison: Comparison) -> dict[str, Ink]:
    """Return the ink of each policy, by label; oracles are grey, and not in anyone's way."""
    chosen: dict[str, Ink] = {}
    ordinary = oracles = 0
    for policy in comparison.policies:
        if policy.oracle:
            turn, color = 1 + oracles % (len(_DASHES) - 1), _ORACLE
            oracles += 1
        else:
            turn, color = ordinary // len(COLORS) % len(_DASHES), COLORS[ordinary % len(COLORS)]
            ordinary += 1
        chosen[policy.label] = Ink(color, _DASHES[turn], _SYMBOLS[turn])
    return chosen
