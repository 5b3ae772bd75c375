"""Write the parts of pages that are made from the code; ``--check`` only compares."""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

from lodbench.cli.list import Item, describe_knob, known

FOLDER = Path(__file__).parents[1]
MADE = re.compile(r"(<!-- made by docs/scripts/build_tables.py -->\n).*?(<!-- end -->)", re.DOTALL)


def row(*cells: str) -> str:
    """Return a line of a Markdown table."""
    return f"| {' | '.join(cells)} |"


def overview(items: list[Item]) -> Iterator[str]:
    """Yield a table of all policies."""
    yield row("policy", "drives", "claims", "knob", "parameters", "published source")
    yield row("---", "---", "---", "---", "---", "---")
    for item in items:
        link = f"[`{item['name']}`](#{item['name']})"
        parameters = ", ".join(f"`{p['name']}`" for p in item["parameters"]) or "none"
        drives = ", ".join(item["capabilities"]) + "; sees the future" * item["oracle"]
        claims = ", ".join(item["claims"]) or "none"
        knob = f"`{item['knob']['name']}`" if item["knob"] else "none"
        yield row(link, drives, claims, knob, parameters, source(item["reference"]))


def source(reference: str) -> str:
    """Return what a reference names first."""
    return re.split(r"; |\. (?=[A-Z])|\.$", reference)[0]


def section(item: Item) -> Iterator[str]:
    """Yield what there is to know of one policy."""
    idea: str = item["idea"]
    yield f"\n## {item['name']}\n"
    yield f"{idea[0].upper()}{idea[1:]}\n"
    yield f"Uses: {item['uses']} Cost per frame: {item['cost_per_frame']}\n"
    yield f"Knob: {describe_knob(item)}\n"
    if item["parameters"]:
        yield row("parameter", "default", "why")
        yield row("---", "---", "---")
        for p in item["parameters"]:
            yield row(f"`{p['name']}`", f"`{p['default']}`", p["comment"])
        yield ""
    yield f"Reference: {item['reference']}"


def policies() -> Iterator[str]:
    """Yield what `policies.md` has from the policies themselves."""
    items = known("policies")
    yield from overview(items)
    for item in items:
        yield from section(item)


def metrics() -> Iterator[str]:
    """Yield the tables of `metrics.md`, one a group."""
    items = known("metrics")
    for group in dict.fromkeys(item["group"] for item in items):
        yield f"\n### {group.capitalize()}\n"
        yield row("id", "unit", "better", "definition", "source")
        yield row("---", "---", "---", "---", "---")
        for item in items:
            if item["group"] == group:
                texts = (item["unit"], item["better"], item["definition"], item["source"])
                yield row(f"`{item['id']}`", *(text.replace("|", r"\|") for text in texts))


def main() -> None:
    """Bring the pages up to date, or say which is not."""
    for name, lines in (("policies.md", policies()), ("metrics.md", metrics())):
        page = FOLDER / name
        made = "\n".join(lines)
        text = page.read_text(encoding="utf-8")
        now = MADE.sub(lambda block, made=made: f"{block[1]}{made}\n{block[2]}", text)
        if "--check" not in sys.argv:
            page.write_text(now, encoding="utf-8")
        elif now != text:
            sys.exit(f"error: {name}: expected what `make docs` writes, got another text; run it")


if __name__ == "__main__":
    main()
