"""Whatever a policy does to its process fails that policy, in words, and nothing else."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from lodbench.base.user_code import load_file
from lodbench.cli.main import run

FILE = Path(__file__).with_name("hostile_neighbours.py")
DEEDS: Any = load_file(FILE, "policies").DEEDS
NAMES = [
    pytest.param(name, marks=() if deed.quick else pytest.mark.slow) for name, deed in DEEDS.items()
]
COMPARE = [
    *("compare", "--scene", "plaza", "--trace", "walk", "--seconds", "0:2", "--json"),
    *("--paths", "1", "--seeds", "1"),
]
OTHERS = ("full", "static-screen:bias=1")


def compared(capfd: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict[str, Any]]:
    """Return the exit code of a comparison and its policies, by label, of its one document."""
    code = run([*COMPARE, *arguments])
    document = json.loads(capfd.readouterr().out)
    return code, {policy["label"]: policy for policy in document["policies"]}


def scores(policy: dict[str, Any]) -> dict[str, Any]:
    """Return what of a policy does not depend on whom it is compared with."""
    among = {"rank", "leader", "same_as"}
    return {key: value for key, value in policy.items() if key not in among}


@pytest.fixture(scope="module")
def alone() -> dict[str, Any]:
    """Return where results of the others alone are kept."""
    return {}


@pytest.mark.parametrize("name", NAMES)
def test_only_the_hostile_policy_fails(
    name: str, alone: dict[str, Any], capfd: pytest.CaptureFixture[str]
) -> None:
    """It fails by frame and reason, and the others' scores are to the bit what they are alone.

    One that does no harm has the scores of the policy that it is made from.
    """
    for other in OTHERS:
        if other not in alone:
            alone[other] = scores(compared(capfd, "--policy", other)[1][other])
    deed, label = DEEDS[name], f"{FILE}:Hostile:deed={name}"
    names = [OTHERS[0], label, OTHERS[1]]
    policies = [word for policy in names for word in ("--policy", policy)]
    code, found = compared(capfd, *policies, "--workers", "2", *deed.options)
    assert {other: scores(found[other]) for other in OTHERS} == alone
    hostile = found[label]
    if deed.reason is None:
        assert (code, hostile["status"]) == (0, "ok"), hostile["reason"]
        assert hostile["metrics"] == alone["full"]["metrics"]
    else:
        assert (code, hostile["status"]) == (1, "failed")
        assert re.search(deed.reason, hostile["reason"]), hostile["reason"]
