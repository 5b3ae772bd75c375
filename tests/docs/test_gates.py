"""Every gate that the documentation shows watches load, and does what its page says of it."""

import math
import re
import shlex
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from lodbench.analysis.study.paths import load_paths
from lodbench.analysis.study.score import World, score
from lodbench.cli.main import run
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.policies.controllers.hoppe import critical_gain
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs" / "ci.md").read_text(encoding="utf-8")
EXAMPLE = ROOT / "docs" / "examples" / "my-engine"
FENCE = re.compile(r"^```(\w+)(?: \w+=\S+)?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_SHELL = [block for kind, block in FENCE.findall(GUIDE) if kind == "sh"]
SHOWN = [block.strip().splitlines() for kind, block in FENCE.findall(GUIDE) if kind == "text"]
Check = Callable[..., tuple[int, list[str]]]


def commands(text: str) -> list[list[str]]:
    """Return the words of each `lodbench check` in a text, without options of its output."""
    joined = re.sub(r"\\?\n +(?=--)", " ", text)
    lines = re.findall(r"lodbench check --policy .*", joined)
    return [words(line) for line in lines if "--update-baseline" not in line]


def words(line: str) -> list[str]:
    """Return a command without what decides where it writes, and without its policy."""
    given = shlex.split(line)[2:]
    for option in ("--policy", "--junit", "--baseline"):
        while option in given:
            at = given.index(option)
            del given[at : at + 2]
    return [word for word in given if word not in {"--github", "--allow-new", "--strict"}]


GATES = {
    **{f"ci.md {at}": gate for at, gate in enumerate(commands("\n".join(_SHELL)))},
    **{
        name: gate
        for name in (".github/workflows/lod-budget.yml", ".gitlab-ci.yml")
        for gate in commands((EXAMPLE / name).read_text(encoding="utf-8"))
    },
}


@pytest.fixture
def check(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Check:
    """Return what checks a policy where the guide's limits are; what is new is allowed."""
    limits = next(block for kind, block in FENCE.findall(GUIDE) if kind == "toml")
    (tmp_path / "limits.toml").write_text(limits, encoding="utf-8")
    monkeypatch.chdir(tmp_path)

    def of(policy: str, *given: str) -> tuple[int, list[str]]:
        code = run(["check", "--policy", policy, *given, "--allow-new"])
        return code, capsys.readouterr().out.splitlines()

    return of


def test_all_gates_are_found() -> None:
    """The page shows three checks and each workflow one: the patterns miss none of them."""
    assert len(GATES) == 5
    assert all("--limits" in gate for gate in GATES.values())


@pytest.mark.slow
@pytest.mark.parametrize("limits", ["limits.toml", str(EXAMPLE / "limits.toml")])
def test_full_detail_fails_every_gate(check: Check, limits: str) -> None:
    """Whatever paths a gate watches, drawing everything in full breaks its budget there."""
    own = EXAMPLE.as_posix() in limits
    gates = {tuple(gate) for name, gate in GATES.items() if name.startswith(".git") == own}
    for gate in gates:
        code, lines = check("full", *(limits if word == "limits.toml" else word for word in gate))
        assert code == 1
        assert any(line.startswith("FAILS: full") and "max budget" in line for line in lines)


@pytest.mark.slow
def test_the_guide_prints_what_its_commands_print(check: Check) -> None:
    """Each line below a command is one of those that it prints."""
    policies = ("feedback:target=0.8", "full", "feedback:target=0.8,gain=2.5")
    check(policies[0], *GATES["ci.md 0"], "--update-baseline")
    for policy, shown in zip(policies, SHOWN, strict=True):
        code, lines = check(policy, *GATES["ci.md 0"])
        assert code == (policy != policies[0])
        assert set(shown) <= set(lines), policy


@pytest.mark.slow
def test_a_gain_beyond_the_critical_one_fails_the_gate(check: Check) -> None:
    """A frame late, a loop swings from gain · elasticity = 1; the elasticity is measured here."""
    profile, scene = load_hardware("desktop-assumed"), load_scene("district")
    paths = load_paths(["walk"], scene, paths=4, seconds=(0.0, 10.0))
    assert profile.frames_in_flight == 2
    low, high = 1.5, 2.0  # about the bias at which the target is met

    def work_ms(bias: float, at: int) -> float:
        world = World(scene, paths[at], profile, ReplayOptions(budget_ms=1e3 / 60.0, seed=at), 1.0)
        spec = parse_policy(f"static-screen:bias={bias}")
        found = score(world, spec, keeps_log=False, beat=lambda _: None).values["work_ms_mean"]
        assert found is not None
        return found

    rises = [math.log(work_ms(high, at) / work_ms(low, at)) for at in range(len(paths))]
    elasticity = float(np.median(rises)) / math.log(high / low)
    assert elasticity == pytest.approx(0.6, abs=0.05)
    critical = critical_gain(1) / elasticity
    gate = GATES["ci.md 0"]
    for factor, fails in ((0.3, False), (1.5, True)):
        code, lines = check(f"feedback:target=0.8,gain={factor * critical:.3g}", *gate)
        assert code == fails, lines
    assert any(line.startswith("FAILS") and "reversals_per_s" in line for line in lines)
