"""The gradient as printed: rays, line searches and costs worked by hand."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lodbench.policies.solvers.printed_ascent import PrintedAscent, SmoothVariables


def variables(benefit: Any, full: Any, **more: Any) -> SmoothVariables:
    """Return variables that begin at a millionth, each of one group, without set-up."""
    n = len(benefit)
    arrays = {
        "setup": np.zeros(n),
        "whole": np.ones(n),
        "start": np.full(n, 1e-6),
        "members": np.ones(n),
    }
    arrays |= {name: np.array(value, dtype=float) for name, value in more.items()}
    return SmoothVariables(np.array(benefit, float), full=np.array(full, float), **arrays)


def test_one_variable_rises_to_where_its_slope_is_the_one_sought() -> None:
    """Of 6 sqrt(r) at 2 ms a unit the slope is 1.5 / sqrt(r): 3 at r = 1/4."""
    ascent = PrintedAscent(variables([6.0], [2.0]), barrier=0.0)
    assert ascent.slope() == pytest.approx(1.5e3)
    spent = ascent.raise_to(3.0, 10.0)
    assert ascent.r == pytest.approx([0.25], rel=2e-4)
    assert spent == pytest.approx(2.0 * ascent.r[0] - 2e-6, rel=1e-12)
    assert 3.0 * (1.0 - 1e-4) <= ascent.slope() <= 3.0


def test_a_ray_is_the_gradient_and_not_the_best_path() -> None:
    """From equal resolutions variables of benefit 1 and 2 rise as 1 to 2; best were 1 to 4."""
    ascent = PrintedAscent(variables([1.0, 2.0], [1.0, 1.0]), barrier=0.0)
    ascent.slope()
    spent = ascent.raise_to(0.0, 0.3)
    assert spent == pytest.approx(0.3, rel=1e-8)
    assert ascent.r - 1e-6 == pytest.approx([0.1, 0.2], rel=1e-7)


def test_a_ray_ends_where_the_first_variable_is_full() -> None:
    """Then that one stays, and the next ray is of the other alone."""
    ascent = PrintedAscent(variables([1.0, 2.0], [1.0, 1.0]), barrier=0.0)
    ascent.slope()
    ascent.raise_to(0.0, 10.0)
    assert ascent.r[1] == 1.0
    assert ascent.r[0] == pytest.approx(0.5, rel=1e-5)
    assert ascent.slope() == pytest.approx(0.5 / np.sqrt(0.5), rel=1e-5)
    ascent.raise_to(0.0, 10.0)
    assert (ascent.r == 1.0).all()
    assert ascent.slope() == 0.0
    assert ascent.raise_to(0.0, 1.0) == 0.0


def test_the_barrier_takes_from_what_is_nearly_full() -> None:
    """At r = 0.99 a gradient of 2 loses 0.01 / 0.01; what is left leads the ray."""
    ascent = PrintedAscent(variables([1.0, 4.0], [1.0, 1.0], start=[0.25, 0.99]), barrier=0.01)
    ascent.slope()
    ascent.raise_to(0.0, 0.001)
    gradient = (1.0 - 0.01 / 0.75, 2.0 / np.sqrt(0.99) - 1.0)
    rise = ascent.r - (0.25, 0.99)
    assert rise[1] / rise[0] == pytest.approx(gradient[1] / gradient[0], rel=1e-6)


def test_below_whole_a_fraction_is_set_up() -> None:
    """8 ms of set-up, 20 ms of splats, whole at a tenth: 5 ms at a twentieth, 18 at a half."""
    some = variables([1.0], [20.0], setup=[8.0], whole=[0.1])
    assert [some.cost(np.array([r])) for r in (0.05, 0.1, 0.5)] == pytest.approx([5.0, 10.0, 18.0])
    ascent = PrintedAscent(some, barrier=0.0)
    for budget_ms, r in ((4.9999, 0.05), (13.0, 0.5)):
        ascent.slope()
        ascent.raise_to(0.0, budget_ms)
        assert ascent.r == pytest.approx([r], rel=1e-3)


def test_equal_groups_do_as_well_with_one_variable() -> None:
    """Four of benefit 3 and 2 ms beside a fifth rise as one of 12 and 8 ms does."""
    apart = PrintedAscent(variables([3.0] * 4 + [5.0], [2.0] * 4 + [1.0]), barrier=1e-3)
    shared = PrintedAscent(variables([12.0, 5.0], [8.0, 1.0], members=[4.0, 1.0]), barrier=1e-3)
    for slope, spend in ((20.0, 1.0), (5.0, 9.0), (0.0, 0.5)):
        assert apart.slope() == pytest.approx(shared.slope(), rel=1e-9)
        assert apart.raise_to(slope, spend) == pytest.approx(
            shared.raise_to(slope, spend), rel=1e-6
        )
        assert_allclose(apart.r[3:], shared.r, rtol=1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_what_is_spent_is_never_more_than_allowed(seed: int) -> None:
    """Nor much less, unless the slope or a full variable ends the step; slopes fall along a ray."""
    rng = np.random.default_rng(seed)
    n = 200
    some = variables(
        rng.uniform(0.1, 9.0, n) ** 3,
        rng.uniform(0.1, 2.0, n),
        setup=rng.uniform(0.0, 3.0, n),
        whole=np.full(n, 0.01),
    )
    ascent, left = PrintedAscent(some, barrier=1e-3), 40.0
    for _ in range(200):
        if ascent.slope() <= 0.0 or left < 1e-6:
            break
        spent = ascent.raise_to(0.0, left)
        assert 0.0 <= spent <= left * (1.0 + 1e-12)
        left -= spent
    assert left < 1e-6
    assert some.cost(ascent.r) == pytest.approx(40.0 + some.cost(some.start), rel=1e-6)
