"""Over which speeds of the machine and which budgets the first rank stands."""

from ..blocks import Block, Paragraph, Table
from ..palette import Ink
from ..plots import HIGH, WIDE, Axis, Line, Plot, Plots, Rule
from ..results import Results, section


@section("How far the first rank stands")
def robustness(results: Results) -> tuple[Block, ...]:
    """Read off the curves: nothing is replayed, and a machine's costs are taken to scale alike.

    Costs that nobody measured are tried, too, where frame logs count what they are of.
    """
    found = results.comparison.robustness
    if found is None:
        return (Paragraph("Not known: no policy has a curve over its knob.", "dim"),)
    low, high = found.speed
    text = results.words(
        f"{found.leader} stays in the first rank on machines of {low:.2g} to {high:.2g} times the "
        "speed, of half to twice that were looked at."
    )
    rows = [
        (f"{at.refresh_hz:g} Hz, {at.budget_ms:.4g} ms", at.first, at.misses)
        for at in found.budgets
    ]
    rows += [(f"with {item.cost}", item.first, item.misses) for item in found.costs]
    cells = [
        (under, results.words(", ".join(first)) or "nobody", results.words(", ".join(miss)) or "–")
        for under, first, miss in rows
    ]
    table = Table(("were it", "first rank", "does not reach it"), cells, "facts")
    return Plots([_strip(results, low, high, text)]), table


def _strip(results: Results, low: float, high: float, text: str) -> Plot:
    found = results.comparison.robustness
    assert found is not None
    x = Axis("speed of the machine, × this one", 0.5, 2.0, "log")
    left, right = (round(WIDE * x.at(speed)) for speed in (low, high))
    ink = Ink("", "", "", results.inks[found.leader].hue)  # no policy's: no click hides it
    band = Line(ink, f"M{left} {HIGH // 2}H{max(right, left + 60)}", "band")
    rule = Rule(True, round(100.0 * x.at(1.0), 2), "this machine")
    return Plot(
        "robustness", "Speed of the machine", x, Axis("", 0.0, 0.0), [band], rules=[rule],
        height_px=56, caption=text,
    )  # fmt: skip
