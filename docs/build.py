"""Write the part of `policies.md` that is made from the code; ``--check`` only compares."""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

from lodbench.cli.list import Item, Kind, known

PAGE = Path(__file__).parent / "policies.md"
MADE = re.compile(r"(<!-- made by docs/build.py -->\n).*?(<!-- end -->)", re.DOTALL)


def row(*cells: str) -> str:
    """Return a line of a Markdown table."""
    return f"| {' | '.join(cells)} |"


def overview(items: list[Item]) -> Iterator[str]:
    """Yield a table of all policies."""
    yield row("policy", "drives", "parameters", "sees the future")
    yield row("---", "---", "---", "---")
    for item in items:
        link = f"[`{item['name']}`](#{item['name']})"
        parameters = ", ".join(f"`{p['name']}`" for p in item["parameters"]) or "none"
        oracle = "yes" if item["oracle"] else "no"
        yield row(link, ", ".join(item["capabilities"]), parameters, oracle)


def section(item: Item) -> Iterator[str]:
    """Yield what there is to know of one policy."""
    idea: str = item["idea"]
    yield f"\n## {item['name']}\n"
    yield f"{idea[0].upper()}{idea[1:]}\n"
    yield f"Uses: {item['uses']} Cost per frame: {item['cost_per_frame']}\n"
    if item["parameters"]:
        yield row("parameter", "default", "why")
        yield row("---", "---", "---")
        for p in item["parameters"]:
            yield row(f"`{p['name']}`", f"`{p['default']}`", p["comment"])
        yield ""
    yield f"Reference: {item['reference']}"


def main() -> None:
    """Bring the page up to date, or say that it is not."""
    policies = known(Kind.POLICIES)
    lines = [*overview(policies), *(line for item in policies for line in section(item))]
    made = "\n".join(lines)
    text = PAGE.read_text(encoding="utf-8")
    now = MADE.sub(lambda block: f"{block[1]}{made}\n{block[2]}", text)
    if "--check" not in sys.argv:
        PAGE.write_text(now, encoding="utf-8")
    elif now != text:
        sys.exit(f"error: {PAGE.name}: expected what `make docs` writes, got another text; run it")


if __name__ == "__main__":
    main()
