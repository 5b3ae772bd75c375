"""The shipped properties catch what is broken, with small examples, and pass what is not."""

import importlib.util
import json
import os
import shlex
import sys
from pathlib import Path
from types import ModuleType
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from lodbench.cli.main import run
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.machine.profile_writer import profile_toml
from lodbench.models.scene.scene_file import read_scene
from lodbench.policies.protocol import Claims, claims_of
from lodbench.policies.registry import REGISTERED, parse_policy
from lodbench.testing import (
    PROPERTIES,
    Property,
    PropertyFailedError,
    budget_is_kept,
    lag_is_bounded,
    load_steps_settle,
    more_budget_is_never_worse,
    nothing_toggles_at_rest,
    order_does_not_matter,
    parametrize_with_properties,
    reset_forgets,
)
from lodbench.traces.cameras.read_trace import read_trace

EXAMPLES = 500 if os.environ.get("LODBENCH_STUDIES") == "full" else 100
ALL_CLAIMS = Claims(budget=True, monotone=True, settles_frames=0)
CLAIMING = [name for name in REGISTERED if claims_of(parse_policy(name).make()) != Claims()]


def load_broken() -> ModuleType:
    """Import the broken policies, which stand beside this file."""
    spec = importlib.util.spec_from_file_location(
        "broken_policies", Path(__file__).with_name("broken.py")
    )
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


BROKEN: Any = load_broken()
CAUGHT = [
    (budget_is_kept, BROKEN.Finest, 0, 1, 1),
    (lag_is_bounded, BROKEN.Finest, 0, 1, 1),
    (nothing_toggles_at_rest, BROKEN.Oscillating, 0, 1, 2),
    (load_steps_settle, BROKEN.Oscillating, 0, 1, 3),
    (load_steps_settle, BROKEN.SlowToSettle, 4, 1, 8),
    (more_budget_is_never_worse, BROKEN.Spoilt, 0, 1, 1),
    (order_does_not_matter, BROKEN.OrderDependent, 0, 2, 1),
    (reset_forgets, BROKEN.Leaking, 0, 1, 2),
    (budget_is_kept, BROKEN.Invalid, 0, 3, 1),
]


@pytest.mark.parametrize(
    ("item", "policy", "rest", "objects", "frames"),
    CAUGHT,
    ids=[f"{case[1].__name__}-{case[0].name}" for case in CAUGHT],
)
def test_broken_policies_are_caught(
    item: Property, policy: Any, rest: int, objects: int, frames: int, tmp_path: Path
) -> None:
    """Each is caught with an example of about as many objects and frames as it takes at least."""
    with pytest.raises(PropertyFailedError) as caught:
        item(policy, rest_frames=rest, folder=tmp_path)
    failure = caught.value.failure
    assert failure is not None
    for _, example in failure.runs:
        assert objects <= len(example.scene) <= min(5, objects + 1)
        assert frames <= example.frames <= min(10, frames + 1)


def test_a_failing_example_can_be_replayed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The command in the message shows the failure, and files hold the example bit for bit."""
    with pytest.raises(PropertyFailedError) as caught:
        budget_is_kept(BROKEN.Finest, folder=tmp_path)
    failure, message = caught.value.failure, str(caught.value)
    assert failure is not None
    (_, example) = failure.runs[0]
    folder = tmp_path / "budget_is_kept-of-Finest"
    assert {path.name for path in folder.iterdir()} == {
        "example.lodscene",
        "example.csv",
        "example.toml",
        "frame-times.svg",
    }
    scene = read_scene(folder / "example.lodscene")
    assert np.array_equal(scene.position_m, example.scene.position_m)
    trace = read_trace(str(folder / "example.csv"))
    # The last pose of the file is held until the example's frames can have begun.
    poses = len(example.trace.position_m)
    assert np.array_equal(trace.position_m[:poses], example.trace.position_m)
    assert (trace.position_m[poses:] == example.trace.position_m[-1]).all()
    read = load_hardware(str(folder / "example.toml"))
    assert profile_toml(read) == profile_toml(example.hardware)
    command = next(line for line in message.splitlines() if "lodbench compare" in line)
    words = shlex.split(command)[1:]
    assert run([*words, "--workers", "1", "--json"]) == 0
    (scored,) = json.loads(capsys.readouterr().out)["policies"]
    log = example.play(BROKEN.Finest()).log
    worst_ms = scored["metrics"]["work_ms_max"]["value"]
    assert worst_ms == np.maximum(log["cpu_ms"], log["gpu_ms"]).max()
    assert worst_ms > example.budget_ms


def test_the_picture_has_a_bar_a_frame_and_the_budget(tmp_path: Path) -> None:
    """The SVG is well formed, with a titled bar for each frame of each run."""
    with pytest.raises(PropertyFailedError) as caught:
        order_does_not_matter(BROKEN.OrderDependent, folder=tmp_path)
    failure = caught.value.failure
    assert failure is not None
    root = ET.parse(tmp_path / "order_does_not_matter-of-OrderDependent" / "frame-times.svg")
    names = {name for name, _ in failure.runs}
    titles = [title.text or "" for title in root.iter("{http://www.w3.org/2000/svg}title")]
    assert names == {"example", "renumbered"} == {title.partition(",")[0] for title in titles}
    assert len(titles) == sum(example.frames for _, example in failure.runs)
    assert len(list(root.iter("{http://www.w3.org/2000/svg}line"))) == 1


def test_a_policy_that_throws_dice_is_told_so(tmp_path: Path) -> None:
    """An example that fails once and passes then is no example, and is not written."""
    with pytest.raises(PropertyFailedError, match=r"decides differently|at rest"):
        nothing_toggles_at_rest(BROKEN.Random, rest_frames=0, folder=tmp_path)


def test_examples_are_always_the_same(tmp_path: Path) -> None:
    """The smallest example found does not depend on the day."""
    messages: list[str] = []
    for _ in range(2):
        with pytest.raises(PropertyFailedError) as caught:
            reset_forgets(BROKEN.Leaking, folder=tmp_path)
        messages.append(str(caught.value))
    assert messages[0] == messages[1]


def test_properties_are_claimed_one_by_one() -> None:
    """All properties follow from all claims; without any, those of the contract remain."""
    assert all(item.claimed(ALL_CLAIMS) for item in PROPERTIES)
    contract = [item.name for item in PROPERTIES if item.claimed(Claims())]
    assert contract == ["order_does_not_matter", "reset_forgets"]
    assert len({item.name for item in PROPERTIES}) == len(PROPERTIES)


@pytest.mark.parametrize("name", ["wimmer", "static-screen"])
def test_shipped_policies_keep_what_they_claim(name: str, tmp_path: Path) -> None:
    """A quick look at two policies; the slow test below looks at all, and longer."""
    policy = parse_policy(name)
    for item in PROPERTIES:
        if item.claimed(claims_of(policy.make())):
            item(policy.make, examples=15, folder=tmp_path)


def test_at_least_twelve_policies_claim_something() -> None:
    """The slow test below is about most of what is shipped."""
    assert len(CLAIMING) >= 12


@pytest.mark.slow
@pytest.mark.study
@parametrize_with_properties([parse_policy(name).cls for name in CLAIMING], examples=EXAMPLES)
def test_claims_hold_in_many_examples(policy_factory: Any, check_property: Any) -> None:
    """Every policy that claims something keeps it, and the contract; 500 worlds at full length."""
    check_property(policy_factory)
