"""The answer in words, and what to know before it is believed."""

from ..blocks import Paragraph
from ..results import Results, section
from ..summary import folded, unscored


@section("")
def the_answer(results: Results) -> tuple[Paragraph, ...]:
    """Whom to take, how surely, and who cannot keep the budget."""
    comparison = results.comparison
    said = [Paragraph(sentence) for sentence in comparison.answer]
    if comparison.conditions.hardware_assumed:
        text = (
            f"The hardware profile {comparison.hardware} is assumed, not measured: the page "
            "compares policies, it does not predict a machine."
        )
        said.append(Paragraph(text, "warn"))
    said += [Paragraph(warning, "warn") for warning in comparison.warnings]
    said += [Paragraph(sentence, "dim") for sentence in folded(comparison)]
    return (*said, *(Paragraph(text, status) for status, text in unscored(comparison)))
