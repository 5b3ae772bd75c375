"""The answer and the ranking of a comparison, as a notebook shows a result."""

from dataclasses import replace

from ...study.comparison import Comparison
from ..blocks import Block, Paragraph, Table
from ..page_template import page_template
from ..palette import inks
from ..results import Results
from ..sections.ranks import ranks
from ..summary import unscored


def ranking_html(comparison: Comparison) -> str:
    """Return the answer and the ranking: gate and ranks as on the page, who misses folded below.

    It is a part of a page with a style of its own, without a script; every name in it is text.
    """
    results = Results(comparison, {}, inks(comparison))
    answer = [Paragraph(results.words(sentence)) for sentence in comparison.answer]
    failed = [text for status, text in unscored(comparison) if status == "failed"]
    blocks: list[Block] = [
        *(replace(block, tone="lead") for block in answer[:1]),
        *answer[1:],
        *map(_unsorted, ranks(results).blocks),
        *(Paragraph(results.words(text), "failed") for text in failed),
    ]
    return page_template("notebook.html").render(parts=blocks)


def _unsorted(block: Block) -> Block:
    """Return a table without buttons by which to sort it, which need a script."""
    return replace(block, name="") if isinstance(block, Table) else block
