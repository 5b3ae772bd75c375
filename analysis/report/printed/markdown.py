"""A comparison as Markdown for a pull request: the answer, the ranking, and what changed."""

import re
from collections.abc import Iterable, Sequence

from ....base.foreign_text import one_line
from ...study.comparison import Comparison
from ...verdict.changes import Changes
from ..changes_table import change_sentences, change_span, is_worse, shown_changes, summarise
from ..summary import (
    HEADLINE,
    behind_text,
    describe_run,
    folded,
    keeps_text,
    knob_words,
    rank_text,
    shown_policies,
    unscored,
)
from ..values import format_value

_LONGEST_NAME, _LONGEST_SENTENCE = 60, 1000

_ACTIVE = re.compile(
    r"[^\w\s.,:;=+/()'?%^·–…’“”-]|_|(?<=/)/|(?<=www)\.|(?<=^)[-+=](?= )|(?<=^\d)[.)](?= )"
)
"""What begins anything in GitHub's Markdown, in a line or a cell of a table."""


def comparison_markdown(comparison: Comparison, changes: Changes | None = None) -> str:
    """Return a summary of a comparison, with what changed since a baseline if that is given."""
    parts = [
        f"### Which policy keeps {comparison.budget_ms:.4g} ms?",
        " ".join(map(markdown_escape, comparison.answer)),
        *(f"**Warning:** {markdown_escape(warning)}" for warning in comparison.warnings),
        _ranking(comparison),
        *map(markdown_escape, folded(comparison)),
        *(f"**{status}:** {_tail(status, text)}" for status, text in unscored(comparison)),
        *([] if changes is None else [_changes(changes)]),
        _provenance(comparison),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def markdown_escape(text: str, longest: int = _LONGEST_SENTENCE) -> str:
    """Return a text as Markdown that shows it, in one line and cut where it is longer.

    Characters that mean something become numeric entities, which Markdown takes for text; a comment
    keeps GitHub from taking a name behind @ for a user's.
    """
    line = _ACTIVE.sub(lambda found: f"&#{ord(found.group())};", one_line(text, longest))
    return line.replace("&#64;", "&#64;<!-- -->")


def _name(text: str) -> str:
    return f"<code>{markdown_escape(text, _LONGEST_NAME)}</code>" if text else ""


def _tail(status: str, text: str) -> str:
    return markdown_escape(text.removeprefix(f"{status}: "))


def _table(heads: Sequence[str], left: int, rows: Iterable[Sequence[str]]) -> str:
    """Return a table whose first columns are set left, the others right."""
    marks = [":---" if i < left else "---:" for i in range(len(heads))]
    lines = (heads, marks, *rows)
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def _ranking(comparison: Comparison) -> str:
    if not comparison.ok:
        return ""
    heads = ("rank", "policy", "knob", "keeps", *(" ".join(c.header.split()) for c in HEADLINE))
    rows = [
        (
            f"{rank_text(policy)} {behind_text(policy)}".rstrip(),
            _name(policy.label),
            _name(knob_words(policy)),
            keeps_text(policy),
            *(column.text(policy) for column in HEADLINE),
        )
        for policy in shown_policies(comparison)
    ]
    return _table(heads, 3, rows)


def _changes(changes: Changes) -> str:
    shown = shown_changes(changes)
    rows = [
        (
            _name(change.policy),
            change.metric.replace("_", "&#95;"),
            format_value(change.before),
            format_value(change.after),
            change_span(change),
            "worse" if is_worse(change) else "better",
        )
        for change in shown
    ]
    parts = [
        "#### Against the baseline",
        markdown_escape(summarise(changes)),
        *(
            f"**Warning:** not under the same conditions: {markdown_escape(difference)}"
            for difference in changes.conditions
        ),
        _table(("policy", "metric", "before", "after", "change", ""), 2, rows) if rows else "",
        "\n".join(f"- {markdown_escape(text)}" for text in change_sentences(changes)),
    ]
    return "\n\n".join(part for part in parts if part)


def _provenance(comparison: Comparison) -> str:
    made = comparison.provenance
    text = f"{describe_run(comparison)} · lodbench {made.version} · {made.command}"
    return f"<sub>{markdown_escape(text)}</sub>"
