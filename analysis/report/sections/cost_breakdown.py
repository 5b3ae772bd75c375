"""Which term of the cost model costs what, by policy, on the first path."""

from collections.abc import Mapping

import numpy as np

from ....base.arrays import FloatArray
from ....sim.frame_log import UNLOGGED
from ...metrics.measured_frames import MeasuredFrames
from ..blocks import Cell, Paragraph, Table
from ..results import Results, section
from ..values import ABSENT, format_value

_LEAST_MS = 0.01
"""A term that costs less in every policy's mean frame has no column."""


def _in_short(results: Results) -> str:
    """Return what costs most in a mean frame of the first of the answer, on its longer side."""
    mean = mean_ms(results, results.first.label)
    side = "gpu" if mean["gpu"] >= mean["cpu"] else "cpu"
    terms = {name: ms for name, ms in mean.items() if name.startswith(f"{side} ")}
    most = max(terms, key=terms.__getitem__)
    name = most.removeprefix(f"{side} ").replace("_", " ")
    name = "what every frame costs" if name == "constant" else name
    return (
        f"Of the {format_value(mean[side])} ms of {side.upper()} time in a mean frame of "
        f"{results.first.label} most, {format_value(terms[most])} ms, is for {name}."
    )


@section("What costs what", takeaway=_in_short)
def cost_breakdown(results: Results) -> tuple[Table] | tuple[Paragraph]:
    """Milliseconds of a mean frame of the first path, by time, by what they are charged for.

    Constant: what every frame costs, and what of the time is not proportional to a count.
    """
    costs = results.comparison.unit_costs
    rows: list[tuple[Cell | str, ...]] = []
    sides = [("gpu", costs.gpu), ("cpu", costs.cpu)]
    means = {p.label: mean_ms(results, p.label) for p in results.drawn}
    terms = [
        (side, name)
        for side, unit_ms in sides
        for name in unit_ms
        if any(mean.get(f"{side} {name}", 0.0) >= _LEAST_MS for mean in means.values())
    ]
    if not terms:
        return (Paragraph("Frame logs count nothing that costs.", "dim"),)
    for policy in results.drawn:
        cells: list[Cell | str] = [results.name_of(policy)]
        for side, _ in sides:
            cells.append(_cell(means[policy.label][side]))
            of_side = [f"{side} {name}" for at, name in terms if at == side]
            cells += [_cell(means[policy.label].get(term)) for term in of_side]
            cells.append(_cell(means[policy.label][f"{side} constant"]))
        rows.append(tuple(cells))
    heads: list[Cell | str] = ["policy"]
    for side, _ in sides:
        heads.append(Cell(f"{side.upper()} ms"))
        heads += [name.replace("_", " ") for at, name in terms if at == side]
        heads.append("constant")
    return (Table(heads, rows, name="costs"),)


def mean_ms(results: Results, label: str) -> dict[str, float]:
    """Return the mean over time of each side, of each of its terms, and of what is left."""
    run = results.first_path(label)
    weight = run.cost_weight_ms
    if not weight.any():
        weight = np.ones(len(run))
    costs = results.comparison.unit_costs
    found: dict[str, float] = {}
    for side, unit_ms in (("gpu", costs.gpu), ("cpu", costs.cpu)):
        found[side] = float(np.average(run[f"{side}_ms"], weights=weight))
        terms = _terms_ms(run, unit_ms, weight)
        found[f"{side} constant"] = found[side] - sum(terms.values())
        found |= {f"{side} {name}": ms for name, ms in terms.items()}
    return found


def _terms_ms(
    run: MeasuredFrames, unit_ms: Mapping[str, float], weight: FloatArray
) -> dict[str, float]:
    """Return what each counted term costs; those of constants, which no log counts, are left."""
    means = {
        name: ms * float(np.average(run[name], weights=weight))
        for name, ms in unit_ms.items()
        if name not in UNLOGGED
    }
    return {name: ms for name, ms in means.items() if np.isfinite(ms)}


def _cell(ms: float | None) -> Cell:
    return Cell(ABSENT) if ms is None else Cell(format_value(ms), value=ms)
