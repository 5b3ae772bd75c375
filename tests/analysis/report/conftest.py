"""A small comparison, and the same with names that mean something to whoever prints them."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import msgspec
import pytest

from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.comparison import Comparison
from lodbench.analysis.study.comparison_folder import Compared
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.camera_trace import CameraTrace

ORDINARY = "a-policy-with-an-ordinary-name"
HOSTILE = (
    r"""<script>alert("x")</script> a|b & 5% _u_ **v** $x^2$ \end{tabular} {} ~ #1 @someone"""
    "\n| `c` | [l](http://e.org) www.e.org -- ?` ![i](j) &lt; <!-- \\\\ \\| = "
)


@pytest.fixture(scope="session")
def ordinary_name() -> str:
    """Return the name of the tuned policy."""
    return ORDINARY


@pytest.fixture(scope="session")
def hostile_name() -> str:
    """Return a name of every kind of markup, in two lines."""
    return HOSTILE


@pytest.fixture(scope="session")
def compared(
    small_scene: Scene, turn_trace: CameraTrace, machine: HardwareProfile, bad_policies: Path
) -> Compared:
    """Return a comparison of a tuned policy, one as it is, and one that failed."""
    specs = [
        replace(parse_policy("static-screen"), label=ORDINARY),
        parse_policy("full"),
        replace(parse_policy(f"{bad_policies}:Raises"), label="fails"),
    ]
    settings = CompareSettings(workers=1, warmup_s=0.2, seeds=2, command="lodbench compare")
    paths = [
        replace(turn_trace.stretch(0.5 - 0.05 * at, 2.0 - 0.05 * at), name=f"turn {at}")
        for at in (0, 1)
    ]
    return compare(specs, small_scene, paths, machine, ReplayOptions(budget_ms=8.0), settings)


@pytest.fixture(scope="session")
def renamed(compared: Compared) -> Callable[[str], Compared]:
    """Return what gives a policy, the scene and the first path another name everywhere."""

    def rename(name: str) -> Compared:
        def walk(value: Any) -> Any:
            if isinstance(value, str):
                return value.replace(ORDINARY, name)
            if isinstance(value, dict):
                record = cast("dict[str, Any]", value)
                return {walk(key): walk(item) for key, item in record.items()}
            if isinstance(value, list | tuple):
                return [walk(item) for item in cast("list[Any]", value)]
            return value

        record = walk(msgspec.to_builtins(compared.comparison))
        record |= {"scene": name, "paths": [name, *record["paths"][1:]]}
        logs = {walk(label): log for label, log in compared.logs.items()}
        return Compared(msgspec.convert(record, Comparison), logs, compared.runs)

    return rename


@pytest.fixture(scope="session")
def hostile(renamed: Callable[[str], Compared]) -> Compared:
    """Return the comparison with a name of every kind of markup."""
    return renamed(HOSTILE)
