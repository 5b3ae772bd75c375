"""`compare` and `report` write figures and tables, and print Markdown; what they refuse."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from lodbench.cli.main import run

COMPARE = ("compare", "--quick", "--seconds", "0:1", "--warmup", "0.2", "--seeds", "2")
POLICIES = ("--policy", "full", "--policy", "static-screen:bias=2", "--workers", "1")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder of a short comparison."""
    out = tmp_path_factory.mktemp("compared") / "out"
    assert run([*COMPARE, *POLICIES, "--out", str(out)]) == 0
    return out


@pytest.fixture
def tried(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    """Return what runs a command line: its exit code, and what it printed on either side."""

    def run_line(*words: object) -> tuple[int, str, str]:
        capsys.readouterr()
        code = run([str(word) for word in words])
        printed = capsys.readouterr()
        return code, printed.out, printed.err

    return run_line


@pytest.mark.slow
def test_files_of_a_comparison(
    folder: Path, tmp_path: Path, tried: Callable[..., tuple[int, str, str]]
) -> None:
    """Tables and figures are written where they are wanted, and told; the page stays as it was."""
    page = (folder / "report.html").stat().st_mtime_ns
    options = [("--csv", "csv"), ("--latex", "tex"), ("--figures", "pdf")]
    words = [word for option, kind in options for word in (option, tmp_path / kind)]
    code, out, _ = tried("report", folder, *words)
    assert code == 0
    for _, kind in options:
        written = list((tmp_path / kind).glob(f"*.{kind}"))
        assert written
        assert all(str(path) in out.splitlines() for path in written)
    code, out, _ = tried("report", folder, "--csv", tmp_path / "again", "--json")
    names = [Path(path).name for path in json.loads(out)["written"]]
    assert names[0] == "ranking.csv"
    assert all(
        (tmp_path / "csv" / name).read_bytes() == (tmp_path / "again" / name).read_bytes()
        for name in names
    )
    assert (folder / "report.html").stat().st_mtime_ns == page


@pytest.mark.slow
def test_markdown_of_a_comparison(
    folder: Path, tmp_path: Path, tried: Callable[..., tuple[int, str, str]]
) -> None:
    """Compare prints and writes what report does; with a baseline, that nothing changed."""
    code, summary, _ = tried("report", folder, "--markdown")
    assert (code, summary.splitlines()[0]) == (0, "### Which policy keeps 16.67 ms?")
    assert tried(*COMPARE, *POLICIES, "--markdown", "--csv", tmp_path / "now")[1] == summary
    assert tried("report", folder, "--csv", tmp_path / "later")[0] == 0
    names = sorted(path.name for path in (tmp_path / "now").iterdir())
    assert names == sorted(path.name for path in (tmp_path / "later").iterdir())
    for name in names:
        assert (tmp_path / "now" / name).read_bytes() == (tmp_path / "later" / name).read_bytes()
    code, changed, _ = tried("report", folder, "--markdown", "--baseline", folder)
    assert code == 0
    assert "None of 12 metrics changed beyond noise" in changed
    assert tried("compare", folder, folder, "--markdown")[1] == changed


@pytest.mark.slow
def test_engine_settings_of_a_comparison(
    folder: Path, tmp_path: Path, tried: Callable[..., tuple[int, str, str]]
) -> None:
    """The first policy that the engine has is meant, in the comparison's scene."""
    code, out, _ = tried("export", folder, "--engine", "unity", "--json")
    found = json.loads(out)
    assert (code, found["policy"], found["scene"]) == (0, "static-screen:bias=2.0", "district")
    assert found["project"] == {"QualitySettings.lodBias": 2.0}
    file = tmp_path / "unity.json"
    assert tried("export", folder, "--engine", "unity", "--out", file)[0] == 0
    assert json.loads(file.read_text()) == found
    for words, message in (
        (("--engine", "cesium"), "expected a comparison of screen-space-error or pixel-error"),
        (("--engine", "unity", "--policy", "full"), "got full, which has no counterpart"),
        (("--engine", "unity", "--policy", "fall"), "expected one of static-screen:bias=2, full"),
    ):
        code, _, err = tried("export", folder, *words)
        assert (code, err.count("\n")) == (2, 1)
        assert message in err


def test_settings_without_a_folder(tried: Callable[..., tuple[int, str, str]]) -> None:
    """A policy with its parameters is enough where an engine has one setting for all."""
    code, out, _ = tried("export", "--engine", "cesium", "--policy", "screen-space-error")
    assert code == 0
    assert "  maximumScreenSpaceError = 16\n" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("report", "x", "--markdown", "--json"), "--markdown: expected no --json"),
        (("report", "x", "--baseline", "y"), "--baseline: expected --markdown"),
        (("report", "x", "--csv", "x/csv"), "--csv: expected a folder outside of the comparison's"),
        (("compare", "--out", "x", "--latex", "x"), "--latex: expected a folder outside"),
        (("compare", "x", "y", "--markdown", "--baseline", "z"), "expected none beside two"),
        (("compare", "--markdown", "--baseline", "gone"), "gone/comparison.json"),
        (("export",), "--format: expected one of"),
        (("export", "--format", "presentmon"), "expected a folder or file of frames"),
        (("export", "--engine", "unity", "--format", "capframex"), "expected no --format"),
        (("export", "x", "--format", "capframex", "--scene", "district"), "expected --engine"),
        (("export", "--engine", "unity"), "expected a folder or a --policy"),
        (("export", "--engine", "unit", "--policy", "full"), "did you mean unity"),
    ],
)
def test_refusals(
    words: tuple[str, ...], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    tried: Callable[..., tuple[int, str, str]],
) -> None:  # fmt: skip
    """One line before any work, and exit code 2."""
    monkeypatch.chdir(tmp_path)
    code, out, err = tried(*words)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert message in err
