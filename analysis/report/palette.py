"""One colour and dash for each policy, the same in every chart and table of a report."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from ..study.comparison import Comparison

# Okabe and Ito, "Color universal design", 2008: told apart with any colour vision; without its
# black and yellow, which vanish on a dark and on a light page.
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_DASHES = ("solid", "dash", "dot", "dashdot")
_SYMBOLS = ("circle", "square", "diamond", "triangle-up")
_ORACLE = "#888888"


@dataclass(frozen=True, slots=True)
class Ink:
    """How a policy is drawn.

    Attributes
    ----------
    color : of figures on white
    dash, symbol : of lines and points
    hue : which colour of the page's style, where light and dark have their own; 6 is grey
    index : of the policy in its comparison
    """

    color: str
    dash: str
    symbol: str
    hue: int = 6
    index: int = -1


def inks(comparison: Comparison) -> dict[str, Ink]:
    """Return the ink of each policy, by label; oracles are grey, and not in anyone's way.

    What did the same as another looks as that one does, since both are one line.
    """
    chosen: dict[str, Ink] = {}
    ordinary = oracles = 0
    for index, policy in enumerate(comparison.policies):
        if policy.same_as in chosen:
            chosen[policy.label] = replace(chosen[policy.same_as], index=index)
            continue
        if policy.oracle:
            turn, hue, color = 1 + oracles % (len(_DASHES) - 1), len(COLORS), _ORACLE
            oracles += 1
            chosen[policy.label] = Ink(color, _DASHES[turn], _SYMBOLS[turn], hue, index)
        else:
            chosen[policy.label] = ink_at(ordinary, index)
            ordinary += 1
    return chosen


def inks_of(labels: Iterable[str]) -> dict[str, Ink]:
    """Return the ink of each policy, by label, of those that have no comparison in common."""
    return {label: ink_at(place, place) for place, label in enumerate(labels)}


def ink_at(place: int, index: int) -> Ink:
    """Return the ink of what is drawn in a place; after all colours come other dashes."""
    turn, hue = place // len(COLORS) % len(_DASHES), place % len(COLORS)
    return Ink(COLORS[hue], _DASHES[turn], _SYMBOLS[turn], hue, index)
