"""`lodbench check` as a CI job calls it."""

import json
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from lodbench.cli.main import run

QUICK = ["--trace", "walk", "--paths", "2", "--seeds", "2", "--seconds", "0:3", "--workers", "1"]
FULL = ["check", "--policy", "full", *QUICK]
COARSE = ["check", "--policy", "static-screen:bias=0.5", *QUICK]
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
    """Write limits on these paths and return the option that names them."""
    text = "\n".join(['population = "this-path"', "[limits]", *lines])
    (tmp_path / "limits.toml").write_text(text, encoding="utf-8")
    return ["--limits", "limits.toml"]


def test_the_budget_is_promised_by_default(capsys: pytest.CaptureFixture[str]) -> None:
    """Without a file of limits coarse levels keep a refresh on such paths, and full ones do not."""
    assert run(COARSE) == 0
    out = capsys.readouterr().out
    assert (
        "passes: static-screen:bias=0.5 in district on 2 paths, walk-1 0:3 s to walk-2 0:3 s" in out
    )
    assert "limit max budget (16.67 ms) on such paths" in out
    assert out.endswith("passed: 1 passed, 0 failed, 0 undecided\n")
    assert run(["check", "--policy", "full", "--seeds", "1", "--workers", "1"]) == 1
    out = capsys.readouterr().out
    assert "FAILS: full in district on 4 paths, trial-1 to trial-4" in out
    assert "triangles +" in out


def test_every_form_tells_the_same(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """JSON, JUnit and annotations of one failed and one passed limit; stdout is one document."""
    limits = write_limits(tmp_path, "work_ms_p99 = { max = 0.5 }", "toggles_per_s = {max=9}")
    arguments = [*FULL, *limits, "--json", "--github", "--junit", "out/junit.xml"]
    assert run(arguments) == 1
    captured = capsys.readouterr()
    document = json.loads(captured.out)
    assert next(iter(document)) == "schema"
    assert (document["schema"], document["passed"]) == ("lodbench.check/2", False)
    assert document["conditions"]["seeds"] == 2
    fails, passes = document["verdicts"]
    assert (fails["metric"], fails["outcome"], fails["line"]) == ("work_ms_p99", "fails", 3)
    assert (fails["population"], fails["paths"]) == ("this-path", ["walk-1 0:3 s", "walk-2 0:3 s"])
    assert fails["p"] < 0.005
    assert fails["bound"] > fails["value"]
    assert len(fails["worst"]["moment"]["camera_m"]) == 3
    assert (passes["metric"], passes["outcome"]) == ("toggles_per_s", "passes")
    (annotation,) = [line for line in captured.err.splitlines() if line.startswith("::")]
    assert annotation.startswith("::error title=work_ms_p99 of full,file=limits.toml,line=3::")
    assert len(ET.parse("out/junit.xml").findall(".//failure")) == 1


def test_undecided_fails_only_if_strict(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """A prediction that is never made errs by nothing that could be judged."""
    limits = write_limits(tmp_path, "prediction_error_pct_mean = { max = 100 }")
    assert run([*FULL, *limits, "--github"]) == 0
    assert "::warning title=prediction_error_pct_mean of full" in capsys.readouterr().out
    assert run([*FULL, *limits, "--strict"]) == 1
    assert "strict: undecided is failure" in capsys.readouterr().out


def test_a_baseline_is_written_once_and_held_against(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Two processes write the same bytes as one; a rerun passes, a heavier policy fails."""
    assert run([*COARSE, "--update-baseline"]) == 0
    first = (tmp_path / "baseline.json").read_bytes()
    assert run([*COARSE, "--update-baseline", "--workers", "2"]) == 0
    assert (tmp_path / "baseline.json").read_bytes() == first
    assert run([*COARSE, "--strict"]) == 0
    light = first.replace(b'"policy": "static-screen:bias=0.5"', b'"policy": "full"')
    (tmp_path / "baseline.json").write_bytes(light)
    capsys.readouterr()
    assert run(FULL) == 1
    out = capsys.readouterr().out
    assert "% on a baseline of" in out
    assert "limit max_increase 2.5% on these paths" in out


def test_what_the_baseline_lacks_fails_unless_allowed(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Without a baseline, or the policy in it, a relative limit fails, unless it may be new."""
    limits = write_limits(tmp_path, "work_ms_p99 = { max_increase = '5%' }")
    assert run([*COARSE, *limits]) == 1
    assert "there is no baseline; update it, or --allow-new" in capsys.readouterr().out
    assert run([*COARSE, *limits, "--allow-new"]) == 0
    assert "there is no baseline; new, which --allow-new allows" in capsys.readouterr().out
    assert run([*COARSE, *limits, "--update-baseline"]) == 0
    assert run([*FULL, *limits]) == 1
    assert "the baseline has no full in district" in capsys.readouterr().out


def test_a_folder_of_compare_is_judged(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """What `compare --out` wrote is judged without a replay, its own baseline included."""
    compare = ["compare", "--policy", "static-screen:bias=0.5", *QUICK, "--draws", "0"]
    assert run([*compare, "--out", "run"]) == 0
    limits = write_limits(tmp_path, "work_ms_p99 = { max = 100, max_increase = '1%' }")
    assert run(["check", "run", *limits, "--update-baseline"]) == 0
    capsys.readouterr()
    assert run(["check", "run", *limits, "--strict"]) == 0
    assert capsys.readouterr().out.count("passes: static-screen:bias=0.5") == 2


def test_several_traces(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Every policy meets every path, and a rule may be for those of one kind."""
    rule = '[[for]]\ntrace = "drive*"\nlimits = { work_ms_mean = { max = 0.5 } }'
    limits = write_limits(tmp_path, "work_ms_mean = { max = 300 }", rule)
    assert run([*FULL, *limits, "--trace", "drive"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("passes: full in district on 2 paths, walk-1 0:3 s to walk")
    assert lines[1].startswith("FAILS: full in district on 2 paths, drive-1 0:3 s to dr")


def test_an_empty_street_is_no_gate(capsys: pytest.CaptureFixture[str]) -> None:
    """Where full detail keeps the budget no policy could fail, and the check says by how much."""
    assert run([*FULL, "--budget-ms", "500"]) == 2
    (error,) = capsys.readouterr().err.splitlines()[-1:]
    assert error.startswith("error: district: full detail of all in view takes ")
    assert "within the budget of 500 ms" in error
    plaza = ["check", "--policy", "full", "--scene", "plaza", "--trace", "tour", "--seconds", "0:3"]
    assert run([*plaza, "--seeds", "2", "--workers", "1"]) == 2
    assert "take a lower budget" in capsys.readouterr().err


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
        (["--policy", "full", "--paths", "0"], "paths: expected a whole number >= 1"),
        (["--policy", "full", *QUICK, "--paths", "1"], "expected 2 paths or more to judge such-pa"),
        (["--policy", "full", *QUICK, "--warmup", "3"], "warmup: expected seconds >= 0 and less"),
        (["--policy", "full", "--limits", "no.toml"], "no.toml: expected a file that can be read"),
        (
            ["--policy", "full", "--limits", "bad.toml"],
            "bad.toml:2: limits.fps: metric: expected one",
        ),
        (
            ["--policy", "full", "--limits", "rel.toml"],
            "rel.toml:3: limits.work_ms_max: max_increase: expected a metric that is a mean",
        ),
        (["no-run"], "no-run/comparison.json: expected a file that can be read"),
    ],
)
def test_bad_input(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Exit code 2, one line that names the file and line, and nothing written."""
    write = {
        "bad": "[limits]\nfps = {max = 1}",
        "rel": "population = 'this-path'\n[limits]\nwork_ms_max={max_increase='1%'}",
    }
    for name, text in write.items():
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
    before = set(tmp_path.iterdir())
    assert run(["check", *arguments, "--junit", "junit.xml"]) == 2
    errors = [line for line in capsys.readouterr().err.splitlines() if line.startswith("error")]
    (error,) = errors
    assert message in error
    assert set(tmp_path.iterdir()) == before
