"""`lodbench check` as a CI job calls it."""

import json
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from lodbench.cli.main import run

QUICK = ["--seconds", "0:2", "--seeds", "2", "--workers", "1"]
FULL = ["check", "--policy", "full", *QUICK]
BROKEN = """
from lodbench.policies.protocol import Capabilities


class Broken:
    capabilities = Capabilities()

    def reset(self, scene, budget_ms):
        pass

    def select(self, view):
        raise ValueError("lost")
"""


@pytest.fixture(autouse=True)
def _empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run each test where there is no baseline yet."""
    monkeypatch.chdir(tmp_path)


def write_limits(tmp_path: Path, *lines: str) -> list[str]:
    """Write limits and return the option that names them."""
    (tmp_path / "limits.toml").write_text("\n".join(["[limits]", *lines]), encoding="utf-8")
    return ["--limits", "limits.toml"]


def test_the_budget_is_the_limit_by_default(capsys: pytest.CaptureFixture[str]) -> None:
    """Without a file of limits 16.7 ms are enough for a view of little, and 0.1 ms are not."""
    assert run(FULL) == 0
    out = capsys.readouterr().out
    assert "passes: full in plaza on tour: work_ms_p95" in out
    assert "limit max budget (16.67 ms)" in out
    assert out.endswith("passed: 1 passed, 0 failed, 0 undecided\n")
    assert run([*FULL, "--budget-ms", "0.1"]) == 1
    assert "worst frame" in capsys.readouterr().out


def test_every_form_tells_the_same(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """JSON, JUnit and annotations of one failed and one passed limit; stdout is one document."""
    limits = write_limits(tmp_path, "frame_ms_p99 = { max = 0.5 }", "toggles_per_s = {max=9}")
    arguments = [*FULL, *limits, "--json", "--github", "--junit", "out/junit.xml"]
    assert run(arguments) == 1
    captured = capsys.readouterr()
    document = json.loads(captured.out)
    assert next(iter(document)) == "schema"
    assert (document["schema"], document["passed"]) == ("lodbench.check/2", False)
    fails, passes = document["verdicts"]
    assert (fails["metric"], fails["outcome"], fails["line"]) == ("frame_ms_p99", "fails", 2)
    assert fails["low"] <= fails["value"] <= fails["high"]
    assert len(fails["worst"]["camera_m"]) == 3
    assert (passes["metric"], passes["outcome"]) == ("toggles_per_s", "passes")
    (annotation,) = captured.err.splitlines()
    assert annotation.startswith("::error title=frame_ms_p99 of full,file=limits.toml,line=2::")
    assert len(ET.parse("out/junit.xml").findall(".//failure")) == 1


def test_undecided_fails_only_if_strict(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """A step that never comes settles nothing."""
    limits = write_limits(tmp_path, "settle_ms = { max = 100 }")
    assert run([*FULL, *limits, "--github"]) == 0
    assert "::warning title=settle_ms of full" in capsys.readouterr().out
    assert run([*FULL, *limits, "--strict"]) == 1
    assert "strict: undecided is failure" in capsys.readouterr().out


def test_a_baseline_is_written_once_and_held_against(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Two processes write the same bytes as one; a rerun passes, a heavier policy fails."""
    two = ["check", "--policy", "static-screen", *QUICK, "--update-baseline"]
    assert run(two) == 0
    first = (tmp_path / "baseline.json").read_bytes()
    assert run([*two, "--workers", "2"]) == 0
    assert (tmp_path / "baseline.json").read_bytes() == first
    assert run(["check", "--policy", "static-screen", *QUICK, "--strict"]) == 0
    heavier = first.replace(b'"policy": "static-screen"', b'"policy": "full"')
    (tmp_path / "baseline.json").write_bytes(heavier)
    capsys.readouterr()
    assert run(FULL) == 1
    out = capsys.readouterr().out
    assert "FAILS: full in plaza on tour: work_ms_p99" in out
    assert "% on a baseline of" in out


def test_a_folder_of_compare_is_judged(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """What `compare --out` wrote is judged without a replay, its own baseline included."""
    compare = ["compare", "--policy", "full", "--seconds", "0:2", "--workers", "1", "--out", "run"]
    assert run(compare) == 0
    limits = write_limits(tmp_path, "frame_ms_p99 = { max = 100, max_increase = '1%' }")
    assert run(["check", "run", *limits, "--update-baseline"]) == 0
    capsys.readouterr()
    assert run(["check", "run", *limits, "--strict"]) == 0
    assert capsys.readouterr().out.count("passes: full") == 2


def test_several_scenes_and_traces(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Every policy meets every trace, and a rule may be for one of them."""
    rule = '[[for]]\ntrace = "walk*"\nlimits = { frame_ms_p99 = { max = 0.5 } }'
    limits = write_limits(tmp_path, "frame_ms_p99 = { max = 100 }", rule)
    assert run([*FULL, *limits, "--trace", "tour", "--trace", "walk"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("passes: full in plaza on tour")
    assert lines[1].startswith("FAILS: full in plaza on walk-0")
    assert run([*FULL, *limits, "--trace", "tour", "--trace", "tour"]) == 2


def test_a_broken_policy_fails(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """A policy that raises fails the check, and no baseline is written of it."""
    (tmp_path / "mine.py").write_text(BROKEN, encoding="utf-8")
    mine = ["check", "--policy", "mine.py:Broken", *QUICK]
    assert run(mine) == 1
    assert "contract: frame 0: ValueError: lost" in capsys.readouterr().out
    assert run([*mine, "--update-baseline"]) == 1
    assert not (tmp_path / "baseline.json").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "policy: expected the policies to check"),
        (["--policy", "ful"], "did you mean full?"),
        (["--policy", "full", "--seeds", "0"], "seeds: expected a whole number >= 1"),
        (["--policy", "full", "--warmup", "900"], "warmup: expected seconds >= 0 and less than"),
        (["--policy", "full", "--limits", "no.toml"], "no.toml: expected a file that can be read"),
        (
            ["--policy", "full", "--limits", "bad.toml"],
            "bad.toml:2: limits.fps: metric: expected one",
        ),
        (["--policy", "full", *QUICK, "--limits", "rel.toml"], "baseline.json: expected a"),
        (["no-run"], "no-run/comparison.json: expected a file that can be read"),
    ],
)
def test_bad_input(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Exit code 2, one line that names the file and line, and nothing written."""
    write = {"bad": "[limits]\nfps = {max = 1}", "rel": "[limits]\nlag_ms_mean={max_increase='1%'}"}
    for name, text in write.items():
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
    before = set(tmp_path.iterdir())
    assert run(["check", *arguments, "--junit", "junit.xml"]) == 2
    (error,) = capsys.readouterr().err.splitlines()
    assert error.startswith("error: ")
    assert message in error
    assert set(tmp_path.iterdir()) == before
