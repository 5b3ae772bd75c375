"""The README's tour is true: its commands run, it prints what is shown, and its claims hold."""

import json
import re
import shlex
from pathlib import Path
from typing import Any

import pytest

from lodbench.cli.main import run

PAGE = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
TABLE = "\n\n"  # ends the sentences that a comparison prints first


def tour() -> list[tuple[str, str]]:
    """Return the tour's commands, each with the text that is shown below its block."""
    blocks: list[tuple[str, str]] = FENCE.findall(PAGE)
    found: list[tuple[str, str]] = []
    for place, (language, block) in enumerate(blocks):
        lines = block.replace("\\\n", " ").splitlines() if language == "sh" else []
        below = [text for kind, text in blocks[place + 1 : place + 2] if kind == "text"]
        found += [(line, "".join(below)) for line in lines if line.startswith("lodbench ")]
    return found


def policies(folder: str) -> list[dict[str, Any]]:
    """Return what a comparison says of each policy."""
    record = json.loads((Path(folder) / "comparison.json").read_text(encoding="utf-8"))
    return record["policies"]


def ranks(folder: str) -> dict[str, int | None]:
    """Return the rank of each policy, None for one that misses."""
    return {policy["label"]: policy["rank"] for policy in policies(folder)}


def pops(folder: str) -> dict[str, float]:
    """Return the visible pops a second of each policy."""
    metrics = {policy["label"]: policy["metrics"] for policy in policies(folder)}
    return {label: of["visible_pops_per_s"]["value"] for label, of in metrics.items()}


@pytest.mark.slow
@pytest.mark.realdata
def test_the_tour(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    data_dir: Path,
) -> None:
    """A ladder wins, full detail misses, and ranks are alike where no display is waited for."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    Path("data").symlink_to(data_dir.resolve())
    compared: list[str] = []
    for line, shown in tour():
        _, *arguments = shlex.split(line)
        if arguments[0] == "record":  # tests run beside others, for which the page has this option
            arguments += ["--clock", "thread"]
        assert run(arguments) == 0, line
        printed = capsys.readouterr().out
        if arguments[0] == "compare":
            compared = arguments
            answer, _, _ = printed.split(TABLE, 2)
            assert answer.split() == shown.split()
        else:
            assert not shown
    assert compared
    told = ranks("out/field")
    assert told == {"static-screen": 1, "feedback": 2, "full": None}
    assert pops("out/field")["static-screen"] == 0.0
    assert pops("out/field")["feedback"] > 1.0
    at_once = ["immediate" if word == "vsync" else word for word in compared]
    assert run([*at_once, "--out", "out/immediate"]) == 0
    assert ranks("out/immediate") == told
