"""A profile of another machine: one factor on all, and not an error that differs by policy."""

import numpy as np
import pytest

from lodbench.analysis.validation.measures.machine_factor import advice, machine_factor
from lodbench.models.machine.scatter import Scatter


def test_one_factor_on_everything_is_another_machine() -> None:
    """Twice the costs, by a tenth more or less, is named with what to do."""
    found = machine_factor([1.9, 2.0, 2.1, 2.0])
    assert found is not None
    assert found.another
    assert found.factor == pytest.approx(2.0)
    assert (found.low, found.high) == (1.9, 2.1)
    text = advice(found, "llvmpipe")
    assert "2.00 times what llvmpipe says" in text
    assert "lodbench record --calibrate" in text


@pytest.mark.parametrize(
    "ratios",
    [
        [0.95, 1.1, 1.2, 1.05],  # an occasion's difference
        [1.0, 2.0, 4.0, 1.2],  # depends on the policy: the model is wrong, not the machine
        [1.24],
    ],
)
def test_what_differs_by_policy_or_little_is_the_same_machine(ratios: list[float]) -> None:
    """Its costs are not those of another machine, whatever else they are."""
    found = machine_factor(ratios)
    assert found is not None
    assert not found.another


def test_a_machine_of_half_the_costs_is_another_too() -> None:
    """The factor counts in both directions; of nothing there is none."""
    found = machine_factor((0.5 * np.array([1.0, 1.02, 0.98])).tolist())
    assert found is not None
    assert found.another
    assert machine_factor([]) is None


def test_what_the_profile_says_of_scenes_is_no_other_machine() -> None:
    """At a scatter of 25 % between scenes 1.5 times is one scene's way; of four it is not."""
    scatter = Scatter(0.09, {"triangles": 0.25}, assumed=True)
    ratios = [1.5, 1.48, 1.52, 1.5]
    one, four = machine_factor(ratios, scatter, 1), machine_factor(ratios, scatter, 4)
    assert one is not None
    assert four is not None
    assert (one.another, four.another) == (False, True)
