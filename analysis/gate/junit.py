"""A report as JUnit XML, which CI services show as tests: a suite a run, a case a limit."""

from itertools import groupby
from operator import attrgetter
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ...base.files.whole_file import write_whole
from .check_result import CheckReport
from .judgement import Verdict
from .plain_text import describe, explain, name_paths


def write_junit(path: Path, report: CheckReport) -> None:
    """Write a report, all of it or nothing; undecided limits are skipped tests unless strict."""
    root = Element("testsuites", name="lodbench check")
    for (policy, scene, paths), verdicts in groupby(
        report.verdicts, attrgetter("policy", "scene", "paths")
    ):
        _add_suite(root, _suite_name(policy, scene, paths), list(verdicts), report)
    indent(root)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, tostring(root, encoding="utf-8", xml_declaration=True) + b"\n")


def _suite_name(policy: str, scene: str, paths: tuple[str, ...]) -> str:
    return ".".join([scene, *([name_paths(paths)] if paths else []), policy])


def _add_suite(root: Element, name: str, verdicts: list[Verdict], report: CheckReport) -> None:
    failed = [verdict for verdict in verdicts if report.is_failure(verdict)]
    skipped = [v for v in verdicts if v.outcome == "undecided" and not report.is_failure(v)]
    suite = SubElement(
        root,
        "testsuite",
        name=name,
        tests=str(len(verdicts)),
        failures=str(len(failed)),
        errors="0",
        skipped=str(len(skipped)),
    )
    for verdict in verdicts:
        title = f"{verdict.metric} {verdict.limit}".strip()
        case = SubElement(suite, "testcase", classname=name, name=title)
        if verdict in failed:
            failure = SubElement(case, "failure", message=explain(verdict), type=verdict.outcome)
            failure.text = describe(verdict)
        elif verdict in skipped:
            SubElement(case, "skipped", message=explain(verdict))
