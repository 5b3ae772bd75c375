"""JUnit XML and annotations of one report with every outcome."""

from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from lodbench.analysis.gate.check_result import CheckReport
from lodbench.analysis.gate.github import annotations
from lodbench.analysis.gate.judgement import Change, Verdict, Worst
from lodbench.analysis.gate.junit import write_junit
from lodbench.analysis.gate.measurements import Conditions
from lodbench.analysis.gate.plain_text import describe, describe_failures, lines
from lodbench.analysis.metrics.worst_moment import Moment

MOMENT = Moment("walk-2", 2.5, (1.0, -2.0, 1.65), 24.0, 8.0, "triangles", 11.0)
FAILS = Verdict(
    "mine:a=1,b=2",
    "yard",
    ("walk-1", "walk-2"),
    "work_ms_p99",
    "such-paths",
    "fails",
    "max 16.7",
    3,
    value=18.0,
    bound=19.0,
    unit="ms",
    p=0.0004,
    worst=Worst(7, 23.5, MOMENT),
)
UNSURE = Verdict(
    "pid",
    "yard",
    ("walk",),
    "settle_ms",
    "this-path",
    "undecided",
    "max 100",
    4,
    needed=12,
    reason="one\n<50 %",
)
GOOD = Verdict(
    "pid",
    "yard",
    ("walk",),
    "lag_ms_mean",
    "this-path",
    "passes",
    "max_increase 2.5%",
    5,
    value=30.0,
    unit="ms",
    change=Change(29.7, 1.01, 1.2, "%"),
)
VERDICTS = (FAILS, UNSURE, GOOD)


@pytest.fixture
def report(conditions: Conditions) -> CheckReport:
    """Return a failed report of a failure, an undecided limit and a passed one."""
    return CheckReport(False, False, conditions, VERDICTS, ("policy x, scene *, trace *",))


def test_a_line_says_what_how_much_the_limit_and_where(report: CheckReport) -> None:
    """A failure has value, end of the interval, limit, population, p, worst moment and place."""
    assert describe(FAILS) == (
        "FAILS: mine:a=1,b=2 in yard on 2 paths, walk-1 to walk-2: work_ms_p99 18.0 ms [< 19.0], "
        "limit max 16.7 on such paths, p 4e-4; worst 23.5 on walk-2, seed 7: at 2.50 s 24.0 ms, "
        "triangles +11.0 ms, camera at (1.00, -2.00, 1.65) m"
    )
    assert describe(UNSURE).endswith("max 100 on these paths: one\n<50 %; 12 seeds would decide")
    assert describe(GOOD) == (
        "passes: pid in yard on walk: lag_ms_mean 30.0 ms, +1.01 [< +1.2] % on a baseline of 29.7, "
        "limit max_increase 2.5% on these paths"
    )
    assert list(lines(report))[-1] == "failed: 1 passed, 1 failed, 1 undecided"
    assert describe_failures(report) == describe(FAILS)


@pytest.mark.parametrize(("strict", "failures", "skipped"), [(False, 1, 1), (True, 2, 0)])
def test_junit_counts(
    conditions: Conditions, strict: bool, failures: int, skipped: int, tmp_path: Path
) -> None:
    """Each limit is a test case; an undecided one is skipped, or a failure if strict."""
    path = tmp_path / "reports" / "junit.xml"
    write_junit(path, CheckReport(False, strict, conditions, VERDICTS))
    root = ET.parse(path).getroot()
    suites = root.findall("testsuite")
    assert [suite.get("name") for suite in suites] == [
        "yard.2 paths, walk-1 to walk-2.mine:a=1,b=2",
        "yard.walk.pid",
    ]
    totals = {
        key: sum(int(suite.get(key, "-1")) for suite in suites)
        for key in ("tests", "failures", "skipped", "errors")
    }
    assert totals == {"tests": 3, "failures": failures, "skipped": skipped, "errors": 0}
    assert len(root.findall(".//failure")) == failures
    assert len(root.findall(".//skipped")) == skipped
    failure = root.find(".//failure")
    assert failure is not None
    assert failure.text == describe(FAILS)
    assert [path.name for path in path.parent.iterdir()] == ["junit.xml"]


def test_annotations_are_escaped(report: CheckReport) -> None:
    """Colons, commas and line ends in a name or message do not end it."""
    error, warning = annotations(report, Path("ci/limits.toml"))
    assert error.startswith(
        "::error title=work_ms_p99 of mine%3Aa=1%2Cb=2,file=ci/limits.toml,line=3::FAILS"
    )
    assert warning.startswith("::warning title=settle_ms of pid,file=ci/limits.toml,line=4::")
    assert "one%0A<50 %25" in warning
    assert "\n" not in warning
    (bare,) = [line for line in annotations(report, None) if line.startswith("::error")]
    assert "file=" not in bare
