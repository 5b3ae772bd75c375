"""Limits as a team writes them, and what is said about those that cannot be meant."""

from pathlib import Path

import pytest

from lodbench.analysis.gate.amount import parse_amount
from lodbench.analysis.gate.limits_file import (
    DEFAULT_LIMITS,
    choose_limits,
    parse_limits,
    read_limits,
)
from lodbench.base.errors import InputError

FILE = """# what a frame may take
population = "this-path"
[limits]
work_ms_p99 = { max = 16.7, max_increase = "5%", floor = 0.5 }
toggles_per_s = { max = 0.05 }

[[for]]
policy = "feedback"
trace = "dash*"
limits = { toggles_per_s = { max = 0.4, population = "such-paths" } }

[[for]]
scene = "plaza"
[for.limits]
benefit_ratio = [
    { min = 0.9, population = "such-paths" },
    { max_decrease = 0.01 },
]
"""


def texts(file: str, *names: str) -> list[str]:
    """Return the limits of a file for a policy, scene and trace."""
    limits = parse_limits(file).of(*names)
    return [f"{limit.metric} {limit.describe(10.0, 60.0)}, {limit.population}" for limit in limits]


def test_limits_for_everything_and_for_some() -> None:
    """A table for a policy and trace replaces the general limit of the same metric only."""
    general = [
        "work_ms_p99 max 16.7, this-path",
        "work_ms_p99 max_increase 5%, floor 0.5, this-path",
    ]
    assert texts(FILE, "pid", "yard", "dash-0") == [
        *general,
        "toggles_per_s max 0.05, this-path",
    ]
    assert texts(FILE, "feedback:gain=1", "yard", "dash-0") == [
        *general,
        "toggles_per_s max 0.4, such-paths",
    ]
    assert texts(FILE, "feedback", "yard", "dash-0 5:20 s") == texts(
        FILE, "feedback", "yard", "dash-0"
    )
    assert texts(FILE, "pid", "plaza", "tour")[-2:] == [
        "benefit_ratio min 0.9, such-paths",
        "benefit_ratio max_decrease 0.01, this-path",
    ]


def test_limits_know_their_line(tmp_path: Path) -> None:
    """An annotation can point at the line of a limit."""
    path = tmp_path / "limits.toml"
    path.write_text(FILE, encoding="utf-8")
    limits = read_limits(path).of("feedback", "plaza", "dash-0")
    assert {limit.metric: limit.line for limit in limits} == {
        "work_ms_p99": 4,
        "toggles_per_s": 10,
        "benefit_ratio": 15,
    }


def test_amounts() -> None:
    """A number, a share, frames and the budget; a frame at 50 Hz has 20 ms."""
    for value, size in ((16.7, 16.7), ("5%", 0.05), ("1 frame", 20.0), ("budget", 8.0)):
        amount = parse_amount(value)
        assert amount is not None
        assert amount.resolve(8.0, 50.0) == pytest.approx(size)
    half = parse_amount("0.5 frames")
    assert half is not None
    assert half.describe(8.0, 50.0) == "0.5 frames (10 ms)"
    for wrong in ("five", "5 %%", "-1 frame", True, None, float("nan"), [1]):
        assert parse_amount(wrong) is None


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("[limits]\nframe_ms_p98 = {max = 1}", 2, "did you mean frame_ms_p99?"),
        ("[limits]\n\nframe_ms_p99 = {maxi = 1}", 3, "got maxi; did you mean max?"),
        ("[limits]\nframe_ms_p99 = 16.7", 2, "expected { max = ... }"),
        ("[limits]\nframe_ms_p99 = {}", 2, "expected one of max, min"),
        ("[limits]\nframe_ms_p99 = []", 2, "expected { max = ... }"),
        ("[limits]\nframe_ms_p99 = {max = '5%'}", 2, "max: expected a number"),
        ("[limits]\nframe_ms_p99 = {max_increase = 'lots'}", 2, "got lots"),
        ("[limits]\nframe_ms_p99 = {max_increase = -1}", 2, "expected an amount >= 0"),
        ("[limits]\nframe_ms_p99 = {max = 1, floor = 1}", 2, "expected one of max, min"),
        ("[limits]\ntoggles_per_s = {max = 'budget'}", 2, "is in 1/s"),
        ("[limits]\n\nlag_ms_mean = {max = 1}", 3, 'expected population = "this-path"'),
        ("[limits]\nlag_ms_mean = {max = 1, population = 'all'}", 2, "got all"),
        ("population = 'all'\n[limits]\nlag_ms_mean = {max = 1}", 1, "got all"),
        (
            (
                "population = 'this-path'\n[limits]\nlag_ms_mean = {max = 1}\n"
                "work_ms_max = {max_increase = '5%'}"
            ),
            4,
            "max_increase: expected a metric that is a mean or a quantile, got an extreme",
        ),
        (
            "population = 'this-path'\n[limits]\nmemory_peak_fraction = {max_increase = 0.1}",
            3,
            "got an extreme",
        ),
        ("[limit]\nframe_ms_p99 = {max = 1}", 1, "did you mean limits?"),
        ("[limits]\n[for]\npolicy = 'a'", 2, "expected [[for]]"),
        ("[limits]\n[[for]]\npolicy = 1", 3, "expected a name of a policy"),
        ("limits = 1", 1, "expected a table of metrics"),
        ("[limits]", 1, "expected at least one limit"),
        ("[limits\n", 1, "expected TOML"),
        ("[limits]\n# frame_ms_p99 is odd\nframe_ms_p99 = 1", 3, "expected { max = ... }"),
        ("[limits] # max\nframe_ms_p99 = {max = true} # max", 2, "got True"),
        ("[[for]] # policy\npolicy = 'policy'\n[[for]]\npolicy = 1", 4, "for[1].policy"),
    ],
)
def test_what_cannot_be_meant(text: str, line: int, message: str, tmp_path: Path) -> None:
    """The error names file and line, what was expected, and the nearest name."""
    path = tmp_path / "limits.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as error:
        read_limits(path)
    assert error.value.line == line
    assert message in str(error.value)


def test_files_that_are_no_text(tmp_path: Path) -> None:
    """A missing file, one of other bytes and a huge one are told by name."""
    binary, huge = tmp_path / "binary.toml", tmp_path / "huge.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    huge.write_bytes(b"#" * (1 << 21))
    for path, message in (
        (tmp_path / "no.toml", "No such"),
        (binary, "UTF-8"),
        (huge, "1048576 bytes"),
    ):
        with pytest.raises(InputError, match=message) as error:
            read_limits(path)
        assert error.value.path == str(path)


def test_limits_without_a_file(tmp_path: Path) -> None:
    """Without a baseline only the budget is judged; without a relative limit none is written."""
    baseline = tmp_path / "baseline.json"
    assert [limit.kind for limit in choose_limits(None, baseline).of("", "", "")] == ["max"]
    baseline.touch()
    kinds = [limit.kind for limit in choose_limits(None, baseline).of("", "", "")]
    assert kinds == [limit.kind for limit in parse_limits(DEFAULT_LIMITS).of("", "", "")]
    fixed = tmp_path / "limits.toml"
    fixed.write_text(
        "population = 'this-path'\n[limits]\nframe_ms_p99 = {max = 1}\n", encoding="utf-8"
    )
    with pytest.raises(InputError, match="add max_increase"):
        choose_limits(fixed, baseline, updating=True)


def test_an_extreme_may_have_a_limit_of_its_own() -> None:
    """What a maximum may be is a limit; by how much it may rise is none."""
    limits = parse_limits("population = 'this-path'\n[limits]\nwork_ms_max = { max = 33.3 }")
    assert [limit.kind for limit in limits.of("", "", "")] == ["max"]
