"""The page of several cameras is true: its commands run, and its table is what they say."""

import json
import re
import shlex
from pathlib import Path
from typing import Any

import pytest

from lodbench.cli.main import run

PAGE = (Path(__file__).parents[2] / "docs" / "several-cameras.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```sh\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
EYES, PLAYERS = (block.replace("\\\n", " ").splitlines() for block in BLOCKS)


def shown() -> dict[str, list[tuple[bool, float]]]:
    """Return whether each policy of the table keeps the budget, and its work time, by column."""
    rows = re.findall(r"^\| `([a-z-]+)` \| (.*) \|$", PAGE, re.MULTILINE)
    cell = re.compile(r"(keeps|misses), ([\d.]+) ms")
    return {
        name: [(word == "keeps", float(ms)) for word, ms in cell.findall(cells)]
        for name, cells in rows
    }


def compared(line: str, capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    """Return the document of a comparison."""
    _, *arguments = shlex.split(line)
    assert run([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.slow
@pytest.mark.realdata
def test_two_eyes(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    data_dir: Path,
) -> None:
    """Drawn one after the other, two eyes have no room for a pixel's error; in one pass they do."""
    monkeypatch.chdir(tmp_path)
    Path("data").symlink_to(data_dir.resolve())
    table = shown()
    assert set(table) == {"full", "pixel-error", "feedback", "static-screen"}
    assert len(EYES) == 3
    for column, line in enumerate(EYES):
        document = compared(line, capsys)
        for policy in document["policies"]:
            keeps, work_ms = table[policy["label"]][column]
            assert (policy["keeps_budget"]["kept"] == 1) == keeps, (line, policy["label"])
            value = policy["metrics"]["work_ms_mean"]["value"]
            assert float(f"{value:.3g}") == work_ms, (line, policy["label"])
            if policy["label"] in {"static-screen", "feedback"} and column == 1:
                error_px = policy["metrics"]["visible_error_px"]["value"]
                assert f"at {error_px:.2f} px" in PAGE
        eyes = document["conditions"]["eyes"]
        assert (eyes is None, bool(eyes and eyes["single_pass"])) == (column == 0, column == 2)


@pytest.mark.slow
def test_a_split_screen(capsys: pytest.CaptureFixture[str]) -> None:
    """Four paths of two players are two screens, each of two of the paths."""
    (line,) = PLAYERS
    together = compared(line, capsys)["paths"]
    apart = compared(line.replace("--players 2", ""), capsys)["paths"]
    assert len(apart) == 4
    assert [name.split(" + ") for name in together] == [apart[:2], apart[2:]]
