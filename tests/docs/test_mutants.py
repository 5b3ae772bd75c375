"""The table of mutants: each can be made, and is killed."""

import pytest
from mutants import ROOT, copy_passes, killed, read_mutants, summary

MUTANTS = read_mutants()


def test_every_mutant_can_be_made() -> None:
    """What is to be replaced stands once in its file, and the tests that are named are there."""
    places = [(m, (ROOT / m.file).read_text(encoding="utf-8").count(m.original)) for m in MUTANTS]
    assert [f"{m.file}: {m.original}" for m, count in places if count != 1] == []
    assert [m for m in MUTANTS if m.original == m.mutant] == []
    assert {name for m in MUTANTS for name in m.killed_by if not (ROOT / name).is_file()} == set()


def test_the_page_tells_of_these_mutants() -> None:
    """`docs/mutants.md` has the table that ``make mutants`` writes if none survives."""
    page = (ROOT / "docs" / "mutants.md").read_text(encoding="utf-8")
    assert summary(MUTANTS) in page


@pytest.mark.slow
def test_some_mutants_are_killed() -> None:
    """One of each folder is, and an unchanged copy passes; ``make mutants`` tries them all."""
    folders = {mutant.file.split("/", 1)[0]: mutant for mutant in MUTANTS}
    assert copy_passes(folders.values())
    assert [mutant.file for mutant in folders.values() if not killed(mutant)] == []
