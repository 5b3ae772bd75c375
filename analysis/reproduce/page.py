"""The page of experiments, as Markdown with pictures beside it."""

from collections.abc import Sequence
from pathlib import Path

from ...base.files.whole_file import write_whole
from .charts import require_charts, write_chart
from .reproduction import Reproduction, Section

PICTURES = "reproduction"
"""Folder of the pictures, beside the page."""

_HEAD = """# What the papers printed, and what comes out here

Written by `lodbench reproduce all`; every number below is from that run.  A verdict is
*reproduced* (within the tolerance given), *in direction* (the effect is there, its size differs),
or *not reproduced*, with the reason.  A constant is *printed* in the paper, *assumed* where it is
not, or *calibrated*, that is chosen so that a printed figure comes out: a match that rests on such
a one confirms nothing.
"""


def write_page(result: Reproduction, path: Path) -> None:
    """Write the page and its pictures; raises `InputError` without matplotlib."""
    require_charts()
    pictures = path.parent / PICTURES
    pictures.mkdir(parents=True, exist_ok=True)
    for section in result.sections:
        for chart in section.charts:
            write_chart(chart, pictures / _picture_name(section, chart.name))
    write_whole(path, page_of(result))


def page_of(result: Reproduction) -> str:
    """Return the text of the page."""
    size = "\nThis is the reduced size, as tests have it.\n" if result.reduced else ""
    summary = _table(
        ("experiment", "claim", "verdict"),
        [(entry.id, entry.claim, entry.verdict) for entry in result.entries],
    )
    sections = "\n".join(map(_section, result.sections))
    return f"{_HEAD}{size}\n{summary}\n\n{sections}"


def _section(section: Section) -> str:
    one = section.experiment
    claims = _table(
        ("claim", "paper", "here", "tolerance", "verdict"),
        [(it.claim, it.paper, it.ours, it.tolerance, it.verdict) for it in section.entries],
    )
    parts = [f"## {one.id}: {one.title}", one.setting, claims]
    if one.constants:
        rows = [(name, it.value, it.origin, it.source) for name, it in one.constants.items()]
        parts.append(_table(("constant", "value", "origin", "source"), rows))
    parts += section.notes
    for chart in section.charts:
        picture = f"{PICTURES}/{_picture_name(section, chart.name)}"
        parts.append(f"![{chart.caption}]({picture})\n\n*{chart.caption}*")
    return "\n\n".join(parts) + "\n"


def _picture_name(section: Section, name: str) -> str:
    return f"{section.experiment.id.replace('/', '-')}-{name}.svg"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(_cell, line)) + " |" for line in lines)


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")
