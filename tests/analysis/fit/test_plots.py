"""Plots of a chain."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench.analysis.fit import plots
from lodbench.analysis.fit.plots import require_plots, write_plots
from lodbench.analysis.fit.sampling.sampler import Chain
from lodbench.base.errors import InputError

PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture
def chain() -> Chain:
    """Return a chain of noise."""
    samples = np.random.default_rng(0).standard_normal((200, 8, 2))
    return Chain(("base", "log_scale"), samples, 0.3, np.ones(2))


def test_both_plots_are_drawn_and_are_the_same_each_time(chain: Chain, tmp_path: Path):
    """Two PNG files, and nothing of the clock in them."""
    pytest.importorskip("matplotlib")
    pytest.importorskip("corner")
    first = [path.read_bytes() for path in write_plots(chain, tmp_path / "one")]
    second = [path.read_bytes() for path in write_plots(chain, tmp_path / "two")]
    assert first == second
    assert all(content.startswith(PNG) for content in first)
    assert sorted(path.name for path in (tmp_path / "one").iterdir()) == ["corner.png", "trace.png"]


def test_without_the_extra_the_error_names_it(monkeypatch: pytest.MonkeyPatch):
    """What is missing, and what to type."""

    def no_corner(name: str) -> Any:
        return None if name == "corner" else object()

    monkeypatch.setattr(plots, "find_spec", no_corner)
    with pytest.raises(InputError, match=r"got no corner; pip install lodbench\[fit-plots\]"):
        require_plots()
