"""When each policy did most work, which cost had grown, and what the camera saw then."""

from ...metrics.worst_moment import Moment
from ...study.comparison_parts import PolicyResult
from ..blocks import Block, Cell, Paragraph, Picture, Pictures, Table
from ..results import Results, section
from ..values import counted, format_value


def _known(results: Results) -> list[tuple[PolicyResult, Moment]]:
    known = results.comparison.worst_moments
    return [(policy, known[policy.label]) for policy in results.drawn if policy.label in known]


def _in_short(results: Results) -> str:
    """Return how far over the budget the first of the ranking came, or who came least far."""
    shown, budget_ms = _known(results), results.comparison.budget_ms
    if not shown:
        return ""
    first, moment = shown[0]
    text = f"{first.label}, the first of the ranking, "
    if first.rank is None:
        first, moment = min(shown, key=lambda each: each[1].work_ms)
        text = f"Nobody surely keeps the budget; {first.label}, the mildest, "
    text += f"never took longer than {format_value(moment.work_ms)} ms, "
    over = sum(each.work_ms > budget_ms for _, each in shown)
    policies = counted(len(shown), "policy", "policies")
    ratio = moment.work_ms / budget_ms
    return f"{text}{ratio:.2f} × the budget; {over} of {policies} exceeded it at some moment."


@section("Worst moments", takeaway=_in_short)
def worst_moments(results: Results) -> tuple[Block, ...]:
    """Each policy's frame of most work in any judged run, and the cost that had grown most.

    Growth is against the median of that run.  Press a heading to sort.  Pictures show what the
    camera saw, of the first three policies in the order of the answer and, once the legend draws
    it, of full detail: objects in the colour of the level at which they were drawn.  Without the
    scene's meshes an object is an octahedron in its bounding sphere, a piece of terrain a square.
    """
    shown = _known(results)
    if not shown:
        return (Paragraph("None is known.", "dim"),)
    heads = ("policy", "work ms", "of the budget", "usual ms", "what had grown", "path", "at s",
             "camera m")  # fmt: skip
    table = Table(heads, [_row(results, *each) for each in shown], name="worst")
    pictures = [
        _picture(results, policy, moment, results.pictures[policy.label])
        for policy, moment in shown
        if policy.label in results.pictures
    ]
    beside: Block = Pictures(pictures) if pictures else Paragraph(_why_none(results), "dim")
    return beside, table


def _why_none(results: Results) -> str:
    conditions = results.comparison.conditions
    if conditions.eyes is not None or conditions.players > 1:
        return (
            "No pictures: several cameras look at once, and no single picture shows what they saw."
        )
    return (
        "No pictures: this record keeps none. lodbench compare --out makes them with its record, "
        "but of moments behind the changes of level that it keeps."
    )


def _picture(results: Results, policy: PolicyResult, m: Moment, png: bytes) -> Picture:
    ratio = m.work_ms / results.comparison.budget_ms
    when = f"at {m.time_s:.2f} s of {results.words(m.path)}"
    text = f"{format_value(m.work_ms)} ms, {ratio:.2f} × the budget, {when}; "
    text += f"what had grown: {_grown(m)}"
    name = results.name_of(policy)
    return Picture(png, name, f"What the camera saw {when} as {name.text} drew it", text)


def _grown(m: Moment) -> str:
    words = m.term.replace("_", " ")
    return f"{words}, + {format_value(m.grown_ms)} ms" if m.term else "noise alone"


def _row(results: Results, policy: PolicyResult, m: Moment) -> tuple[Cell | str, ...]:
    ratio = m.work_ms / results.comparison.budget_ms
    return (
        results.name_of(policy),
        Cell(format_value(m.work_ms), value=m.work_ms),
        Cell(f"{ratio:.2f} ×", value=ratio),
        Cell(format_value(m.usual_ms), value=m.usual_ms),
        Cell(_grown(m), value=m.grown_ms),
        results.words(m.path),
        Cell(f"{m.time_s:.2f}", value=m.time_s),
        ", ".join(f"{at:.0f}" for at in m.camera_m),
    )
