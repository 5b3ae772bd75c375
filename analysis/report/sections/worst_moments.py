"""When each policy did most work, and which cost had grown."""

from ..blocks import Cell, Paragraph, Table
from ..results import Results, section
from ..values import format_value


@section("Worst moments")
def worst_moments(results: Results) -> tuple[Table] | tuple[Paragraph]:
    """Each policy's frame of most work in any judged run, and the cost that had grown most.

    Growth is against the median of that run.  Press a heading to sort.
    """
    moments = results.comparison.worst_moments
    rows: list[tuple[Cell | str, ...]] = []
    for policy in results.drawn:
        if policy.label not in moments:
            continue
        m = moments[policy.label]
        ratio = m.work_ms / results.comparison.budget_ms
        grown = f"{m.term}, + {format_value(m.grown_ms)} ms" if m.term else "noise alone"
        place = ", ".join(f"{at:.0f}" for at in m.camera_m)
        rows.append((
            results.name_of(policy),
            Cell(format_value(m.work_ms), value=m.work_ms),
            Cell(f"{ratio:.2f} ×", value=ratio),
            Cell(format_value(m.usual_ms), value=m.usual_ms),
            Cell(grown, value=m.grown_ms),
            results.words(m.path),
            Cell(f"{m.time_s:.2f}", value=m.time_s),
            place,
        ))  # fmt: skip
    if not rows:
        return (Paragraph("None is known.", "dim"),)
    heads = ("policy", "work ms", "of the budget", "usual ms", "what had grown", "path", "at s",
             "camera m")  # fmt: skip
    return (Table(heads, rows, name="worst"),)
