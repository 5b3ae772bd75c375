"""Policies by name: registered ones, users' own, and what is wrong with a name."""

from pathlib import Path

import pytest

from lodbench.base.errors import InputError, PolicyError
from lodbench.policies.bounds.full import Full
from lodbench.policies.controllers.feedback import Feedback
from lodbench.policies.protocol import Policy
from lodbench.policies.registry import REGISTERED, parameters, parse_policy
from lodbench.policies.thresholds.static_distance import StaticDistance

OWN = """
from dataclasses import dataclass
from lodbench.policies.bounds.full import Full

@dataclass
class Mine(Full):
    near_m: float = 1.0
    count: int = 2
    fast: bool = False
    label: str = "x"
    limit: float | None = None

class Plain:
    capabilities = Full.capabilities
    def __init__(self, near_m: float):
        if near_m < 0:
            raise KeyError("near_m")
        self.near_m = near_m
    def reset(self, scene, budget_ms): pass
    def select(self, view): return None

class Bare:
    capabilities = Full.capabilities
    def reset(self, scene, budget_ms): pass
    def select(self, view): return None

class NoSelect:
    def reset(self, scene, budget_ms): pass

number = 3
"""


UNRESOLVED = b"""
from __future__ import annotations
from lodbench.policies.bounds.full import Full

class Mine(Full):
    def __init__(self, scene: Scene):
        pass
"""


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """Return a file with policies of a user's own."""
    path = tmp_path / "my_policy.py"
    path.write_text(OWN, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", sorted(REGISTERED))
def test_every_registered_policy_can_be_made(name: str) -> None:
    """Each name leads to a class that follows the protocol and needs no parameter."""
    spec = parse_policy(name)
    assert (spec.label, spec.name, spec.params) == (name, name, {})
    assert isinstance(spec.make(), Policy)
    assert all(parameter.name[0] != "_" for parameter in parameters(spec.cls))


def test_parameters_are_converted() -> None:
    """Keys may have hyphens, values become what the annotation says, spaces do not matter."""
    spec = parse_policy("static-distance:near-m=5, far_m = 1e2,hysteresis=0.1")
    assert spec.params == {"near_m": 5.0, "far_m": 100.0, "hysteresis": 0.1}
    assert spec.make() == StaticDistance(5.0, 100.0, 0.1)
    assert parse_policy("static-distance:near_m=none").make() == StaticDistance()
    assert parse_policy("feedback:gain=1").make() == Feedback(gain=1.0)


def test_parameters_tell_their_defaults() -> None:
    """What `list policies` shows: names, types and defaults in order."""
    known = parameters(StaticDistance)
    assert [parameter.name for parameter in known] == ["near_m", "far_m", "hysteresis", "scale"]
    assert [parameter.default for parameter in known] == [None, None, 0.0, 1.0]
    assert known[2].kind is float


def test_a_users_file(own: Path) -> None:
    """``file.py:Class`` loads the class, with parameters of every simple type."""
    spec = parse_policy(f"{own}:Mine:near_m=2,count=3,fast=on,label=a-b,limit=none")
    assert spec.params == {"near_m": 2.0, "count": 3, "fast": True, "label": "a-b", "limit": None}
    assert spec.name == f"{own}:Mine"
    assert isinstance(spec.make(), Full)
    assert parse_policy(f"{own}:Mine:fast=off").params == {"fast": False}
    assert isinstance(parse_policy(f"{own}:Bare").make(), Policy)
    assert parse_policy(f"{own}:Plain:near_m=4").params == {"near_m": 4.0}


def test_an_installed_module() -> None:
    """``package.module:Class`` imports the class."""
    assert parse_policy("lodbench.policies.bounds.full:Full").cls is Full


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("fedback", r"policy: .* or your own as file.py:NAME, got fedback; did you mean feedback"),
        (":", "policy: no module: .*; is it installed"),
        ("xyzzy", "one of .*full, .*or your own as file.py:NAME, got xyzzy;"),
        ("", "expected one of .*, got nothing; name one of them"),
        (
            "feedback:gian=1",
            r"policy feedback: expected one of dead_band, .*, got gian; did you mean gain\?",
        ),
        ("full:level=1", "policy full: expected no such name, got level; remove it"),
        ("feedback:gain=fast", "policy feedback:gain=fast: gain: Expected `float`, .*got fast"),
        ("feedback:gain=", "gain: Expected `float`"),
        ("feedback:gain=1,target", "expected key=value, got target"),
        ("feedback:gain", "policy feedback: expected key=value after the colon, got gain"),
        ("feedback:", "policy feedback: expected key=value after the colon, got feedback:"),
        ("gain=1", "expected name:key=value, got no colon before the key"),
        ("no.such.module:Class", "policy: no.such.module: No module named 'no'; is it"),
        ("lodbench.policies.bounds.full:Ful", "got Ful; did you mean Full"),
        ("nowhere.py:Mine", "nowhere.py: expected a Python file with a policy, got no file"),
    ],
)
def test_wrong_names_say_what_to_do(text: str, message: str) -> None:
    """Each mistake has its message, with the nearest name and the known ones."""
    with pytest.raises(InputError, match=message):
        parse_policy(text)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("Min", r"expected one of .*Mine, .*, got Min; did you mean Mine\?"),
        ("number", "number: expected a class with reset and select"),
        ("NoSelect", "expected a class with reset and select"),
    ],
)
def test_wrong_classes_of_a_users_file(own: Path, name: str, message: str) -> None:
    """A name that is missing, no class or no policy is told from the others."""
    with pytest.raises(InputError, match=message):
        parse_policy(f"{own}:{name}")


def test_a_missing_parameter_is_bad_input_and_what_a_constructor_raises_is_not(own: Path) -> None:
    """The first is told without running the class; the second is the policy's own failure."""
    missing = parse_policy(f"{own}:Plain")
    for refuse in (missing.check_parameters, missing.make):
        with pytest.raises(InputError, match=r"Plain: expected its parameters, .*'near_m'$"):
            refuse()
    raises = parse_policy(f"{own}:Plain:near_m=-1")
    raises.check_parameters()
    with pytest.raises(PolicyError, match=r"cannot be made: KeyError: 'near_m'$"):
        raises.make()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("static-screen:first=-1", r"expected first in \(0, inf\], got -1.0"),
        ("feedback:ratio=1", r"expected ratio in \(0, 1\), got 1.0"),
        ("hoppe:min_px=100", "expected min_px <= start_px <= max_px, got 100, 1, 64"),
        ("static-distance:hysteresis=1", r"expected hysteresis in \[0, 1\), got 1.0"),
    ],
)
def test_our_ranges_are_known_before_a_policy_is_made(text: str, message: str) -> None:
    """Ranges, choices and orders that a class declares hold without an object and a scene."""
    with pytest.raises(InputError, match=message):
        parse_policy(text).check_parameters()


def test_one_parameter_is_looked_at_without_the_others() -> None:
    """An order that another value may still mend is not judged, and a range is."""
    parse_policy("hoppe:min_px=100").check_parameter("min_px")
    with pytest.raises(InputError, match="expected target in"):
        parse_policy("hoppe:target=2").check_parameter("target")


def test_every_default_is_in_its_range() -> None:
    """No policy of ours is refused as it comes."""
    for name in REGISTERED:
        parse_policy(name).check_parameters()


@pytest.mark.parametrize(
    ("source", "message"),
    [
        (b"x = 1\nclass Mine(:\n", r"broken.py:2: expected a Python file that loads, got Synta"),
        (b"import no_such_module\n", "expected a Python file that loads, got ModuleNotFoundError"),
        (b"1 / 0\n", "expected a Python file that loads, got ZeroDivisionError"),
        (b"raise SystemExit\n", "expected a Python file that loads, got SystemExit"),
        (b"\xff\xfe\x00", "expected a Python file that loads, got "),
        (b"", "expected no such name, got Mine"),
        (UNRESOLVED, "expected annotations that resolve .*'Scene' is not defined"),
    ],
)
def test_broken_files_are_named(tmp_path: Path, source: bytes, message: str) -> None:
    """A file that does not load is an error of input with its path, and the line if known."""
    path = tmp_path / "broken.py"
    path.write_bytes(source)
    with pytest.raises(InputError, match=message):
        parse_policy(f"{path}:Mine")
