"""LODManager's experiments at reduced size: what holds there, and what is said not to."""

import pytest

from lodbench.analysis.reproduce.registry import find_experiments
from lodbench.analysis.reproduce.reproduce import reproduce
from lodbench.analysis.reproduce.reproduction import Section
from lodbench.analysis.study.engine.limits import make_limits

PATIENT = make_limits(600.0, None)  # a scene may have to be made first


@pytest.fixture(scope="module")
def sections() -> dict[str, Section]:
    """Return the experiments' sections by id."""
    result = reproduce(find_experiments("lodmanager"), reduced=True, workers=1, limits=PATIENT)
    return {section.experiment.id: section for section in result.sections}


@pytest.mark.slow
def test_the_gain_is_that_of_uploads(sections: dict[str, Section]) -> None:
    """Changed in place nothing is won; with whole sets uploaded it is, the more the dearer."""
    gains = [entry for entry in sections["gumbau/fig6"].entries if "frame rate" in entry.claim]
    assert len(gains) == 4
    for entry in gains:
        in_place = "changed in place" in entry.claim
        assert entry.verdict.startswith("not reproduced") is in_place, entry
    (curve,) = [chart for chart in sections["gumbau/fig6"].charts if chart.name == "gain"]
    for line in curve.lines:
        assert line.x == (0.0, 300.0)
        assert 1.0 <= line.y[0] < line.y[1]
        assert line.y[1] > 1.1


@pytest.mark.slow
def test_as_many_triangles_and_nearly_the_same_picture(sections: dict[str, Section]) -> None:
    """Within 3 % on the mean; hardly a pixel differs."""
    alike = [entry for entry in sections["gumbau/fig6"].entries if "triangles" in entry.claim]
    (picture,) = sections["gumbau/fig5"].entries
    assert [entry.verdict for entry in (*alike, picture)] == ["reproduced"] * 3


@pytest.mark.slow
def test_slots_and_list(sections: dict[str, Section]) -> None:
    """More slots, more extractions, each within its slot; a list bounds what is looked at."""
    for name in ("gumbau/NT", "gumbau/Na"):
        for entry in sections[name].entries:
            assert entry.verdict == "reproduced", entry
