"""Parts of pages that scripts write: tables between two marks."""

import re
from collections.abc import Mapping
from pathlib import Path


def table(*rows: tuple[str, ...]) -> str:
    """Return a Markdown table; the first row is its head."""
    head, *body = rows
    return "\n".join(f"| {' | '.join(row)} |" for row in (head, ("---",) * len(head), *body))


def write_blocks(page: Path, script: str, blocks: Mapping[str, str]) -> None:
    """Put each block where the page says ``<!-- made by SCRIPT: NAME -->``."""
    made = re.compile(
        rf"(<!-- made by {re.escape(script)}: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL
    )
    text = page.read_text(encoding="utf-8")
    text = made.sub(lambda block: f"{block[1]}{blocks[block[2]]}\n{block[3]}", text)
    page.write_text(text, encoding="utf-8")
