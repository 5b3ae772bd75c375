"""What the budget is asserted with: the same as the check in the workflow."""

from dataclasses import replace

import pytest

from lodbench.testing import FrameBudget


@pytest.fixture(scope="session")
def frame_budget(frame_budget: FrameBudget) -> FrameBudget:
    """Replay the paths that the baseline was written with."""
    return replace(frame_budget, paths=4)
