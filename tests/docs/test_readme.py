"""The README's tour is true: its commands run, it prints what is shown, and its claims hold."""

import json
import re
import shlex
from itertools import pairwise
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


def ranks(folder: str) -> dict[str, Any]:
    """Return the rank of each policy, None for one that misses, in the order of the answer."""
    record = json.loads((Path(folder) / "comparison.json").read_text(encoding="utf-8"))
    policies: list[dict[str, Any]] = record["policies"]
    return {policy["label"]: policy["rank"] for policy in policies}


@pytest.mark.slow
@pytest.mark.realdata
def test_the_tour(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    data_dir: Path,
) -> None:
    """Full detail misses, the others are ranked, and alike where no display is waited for."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    Path("data").symlink_to(data_dir.resolve())
    compared: list[str] = []
    for line, shown in tour():
        _, *arguments = shlex.split(line)
        assert run(arguments) == 0, line
        printed = capsys.readouterr().out
        if arguments[0] == "compare":
            compared = arguments
            _, answer, _ = printed.split(TABLE, 2)
            assert answer.split() == shown.split()
        else:
            assert not shown
    assert compared
    told = ranks("out/field")
    assert told.pop("full") is None
    assert None not in told.values()
    at_once = ["immediate" if word == "vsync" else word for word in compared]
    assert run([*at_once, "--out", "out/immediate"]) == 0
    then = ranks("out/immediate")
    assert then.pop("full") is None
    assert next(iter(then)) == next(iter(told))
    # Who just passes the gate in one may miss it in the other; of who passes both, none overtakes.
    both = [label for label, rank in then.items() if rank is not None]
    assert len(both) > 1
    assert all(told[a] <= told[b] for a, b in pairwise(both))
