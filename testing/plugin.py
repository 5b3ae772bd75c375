"""The pytest plugin: a frame budget and a replay as fixtures, and a marker for slow sweeps.

It is installed with the package and does nothing until a test asks for a fixture or bears the
marker: what the fixtures need is imported by them.
"""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:  # loaded by the fixtures, so that other people's tests start as quickly as ever
    from .budget import FrameBudget

_MARKER = "lodbench_sweep"
_OPTION = "--lodbench-sweeps"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add one option, and where limits and baseline stand."""
    group = parser.getgroup("lodbench", "frame budgets of level-of-detail policies")
    group.addoption(_OPTION, action="store_true", help=f"run tests marked {_MARKER} too")
    parser.addini("lodbench_limits", "TOML file of limits, relative to the root", default="")
    parser.addini(
        "lodbench_baseline", "baseline of limits, relative to the root", default="baseline.json"
    )


def pytest_configure(config: pytest.Config) -> None:
    """Make the marker known."""
    config.addinivalue_line("markers", f"{_MARKER}: a slow sweep, which {_OPTION} runs")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Skip slow sweeps unless they are asked for."""
    if config.getoption(_OPTION):
        return
    skip = pytest.mark.skip(reason=f"a slow sweep; run it with {_OPTION}")
    for item in items:
        if item.get_closest_marker(_MARKER) is not None:
            item.add_marker(skip)


@pytest.fixture(scope="session")
def frame_budget(request: pytest.FixtureRequest) -> "FrameBudget":
    """Return the limits that the project's configuration names; a project may override this."""
    from .budget import FrameBudget

    config = request.config
    limits = str(config.getini("lodbench_limits"))
    return FrameBudget(
        limits=config.rootpath / limits if limits else None,
        baseline=config.rootpath / Path(str(config.getini("lodbench_baseline"))),
    )


@pytest.fixture(scope="session")
def assert_budget(frame_budget: "FrameBudget") -> Callable[..., None]:
    """Return a function of policy, scene and trace that asserts the project's limits."""
    from .budget import assert_budget

    return partial(assert_budget, budget=frame_budget)


@pytest.fixture(scope="session")
def replay(frame_budget: "FrameBudget") -> Callable[..., Any]:
    """Return a function of policy, scene and trace that replays them to a frame log."""
    from .budget import replay_policy

    return partial(replay_policy, budget=frame_budget)
