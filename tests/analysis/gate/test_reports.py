"""JUnit XML and annotations of one report with every outcome."""

from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from lodbench.analysis.gate.check_result import CheckReport
from lodbench.analysis.gate.github import annotations
from lodbench.analysis.gate.judgement import Verdict
from lodbench.analysis.gate.junit import write_junit
from lodbench.analysis.gate.measurements import Conditions
from lodbench.analysis.gate.plain_text import describe, describe_failures, lines
from lodbench.analysis.gate.worst_frame import WorstFrame

CONDITIONS = Conditions("machine", 10.0, 60.0, 0, 4, 1.0, 1.0)
WORST = WorstFrame(2, 153, 2.5, 24.0, (1.0, -2.0, 1.65))
FAILS = Verdict(
    "mine:a=1,b=2",
    "yard",
    "walk",
    "frame_ms_p99",
    "fails",
    "max 16.7",
    3,
    18.0,
    17.0,
    19.0,
    "ms",
    worst=WORST,
)
UNSURE = Verdict("pid", "yard", "walk", "settle_ms", "undecided", "max 100", 4, reason="one\n<50 %")
GOOD = Verdict("pid", "yard", "walk", "lag_ms_mean", "passes", "max 40", 5, 30.0, 29.0, 31.0, "ms")
VERDICTS = (FAILS, UNSURE, GOOD)


def test_a_line_says_what_how_much_the_limit_and_where() -> None:
    """The line of a failure has value, interval, limit, worst frame and the camera's place."""
    assert describe(FAILS) == (
        "FAILS: mine:a=1,b=2 in yard on walk: frame_ms_p99 18.0 ms [17.0, 19.0], limit max 16.7; "
        "worst frame 153 of seed 2 at 2.50 s with 24.0, camera at (1.00, -2.00, 1.65) m"
    )
    assert describe(GOOD) == (
        "passes: pid in yard on walk: lag_ms_mean 30.0 ms [29.0, 31.0], limit max 40"
    )
    report = CheckReport(False, False, CONDITIONS, VERDICTS, ("policy x, scene *, trace *",))
    assert list(lines(report))[-1] == "failed: 1 passed, 1 failed, 1 undecided"
    assert describe_failures(report) == describe(FAILS)


@pytest.mark.parametrize(("strict", "failures", "skipped"), [(False, 1, 1), (True, 2, 0)])
def test_junit_counts(strict: bool, failures: int, skipped: int, tmp_path: Path) -> None:
    """Each limit is a test case; an undecided one is skipped, or a failure if strict."""
    path = tmp_path / "reports" / "junit.xml"
    write_junit(path, CheckReport(False, strict, CONDITIONS, VERDICTS))
    root = ET.parse(path).getroot()
    suites = root.findall("testsuite")
    assert [suite.get("name") for suite in suites] == ["yard.walk.mine:a=1,b=2", "yard.walk.pid"]
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


def test_annotations_are_escaped() -> None:
    """Colons, commas and line ends in a name or message do not end it."""
    report = CheckReport(False, False, CONDITIONS, VERDICTS)
    error, warning = annotations(report, Path("ci/limits.toml"))
    assert error.startswith(
        "::error title=frame_ms_p99 of mine%3Aa=1%2Cb=2,file=ci/limits.toml,line=3::FAILS: mine:a"
    )
    assert warning.startswith("::warning title=settle_ms of pid,file=ci/limits.toml,line=4::")
    assert warning.endswith("limit max 100: one%0A<50 %25")
    strict = annotations(CheckReport(False, True, CONDITIONS, VERDICTS), None)
    assert [text.partition(" ")[0] for text in strict] == ["::error", "::error"]
