"""Cases of a validation from a file: what they leave open, and what is wrong with them."""

from pathlib import Path

import pytest

from lodbench.analysis.validation.study_file import CaseSpec, read_cases
from lodbench.base.errors import InputError


def test_cases_take_from_the_options_what_they_leave_open(tmp_path: Path) -> None:
    """Scene and trace are the case's, and a file beside the study's is found."""
    (tmp_path / "mine.lodscene").write_bytes(b"")
    study = tmp_path / "study.toml"
    study.write_text(
        '[[case]]\nscene = "market"\ntrace = "drive"\nbudget_ms = 5.0\n\n'
        '[[case]]\nscene = "mine.lodscene"\ntrace = "walk"\npolicies = ["full"]\n',
        encoding="utf-8",
    )
    default = CaseSpec("plaza", "tour", 9.0, "0:2", "shrink", 60.0, ("feedback",))
    first, second = (case.or_else(default) for case in read_cases(study))
    assert first == CaseSpec("market", "drive", 5.0, "0:2", "shrink", 60.0, ("feedback",))
    scene = str(tmp_path / "mine.lodscene")
    assert second == CaseSpec(scene, "walk", 9.0, "0:2", "shrink", 60.0, ("full",))


def test_a_name_too_long_for_a_file_is_a_name(tmp_path: Path) -> None:
    """Who looks for the scene says that there is none."""
    study, name = tmp_path / "study.toml", "a" * 300
    study.write_text(f'[[case]]\nscene = "{name}"\ntrace = "walk"\n', encoding="utf-8")
    assert [case.scene for case in read_cases(study)] == [name]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("# none\n", "expected one [[case]] or more, got none"),
        ('[[case]]\nscene = "market"\n', "expected the key trace, found none"),
        ('[[case]]\nscene = "a"\ntrace = "b"\nbudget = 1.0\n', "budget_ms"),
        ('[[case]]\nscene = "a"\ntrace = "b"\nbudget_ms = "x"\n', "expected"),
        ('[[cases]]\nscene = "a"\n', "case"),
        (
            '[[case]]\nscene = "a"\ntrace = "b"\npolicies = []\n',
            "study.toml:4: policies: expected one or more, got none",
        ),
    ],
)
def test_what_is_wrong_is_told_in_one_line(text: str, message: str, tmp_path: Path) -> None:
    """With the file, and its line where there is one."""
    study = tmp_path / "study.toml"
    study.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as told:
        read_cases(study)
    assert message in str(told.value)
    assert "study.toml" in str(told.value)
