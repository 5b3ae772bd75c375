"""Intervals of one recording: they hold as many as they say, and fail where costs are wrong."""

from collections.abc import Callable, Iterator, Mapping

import numpy as np
import pytest

from lodbench.analysis.study.score import Scored
from lodbench.analysis.validation.measures.agreement import agree, predictive_interval
from lodbench.analysis.validation.recorded_frames import Measured, stretch_of
from lodbench.analysis.validation.replicates import Simulation
from lodbench.analysis.verdict.scores import LEVEL
from lodbench.models.machine.hardware import HardwareProfile

RECORDINGS = 6


def cells(
    simulation: Simulation, recordings: Mapping[str, list[dict[str, float | None]]]
) -> Iterator[bool]:
    """Yield whether each counted metric of each recording of each policy is inside."""
    for label, passed in recordings.items():
        replicates = [run.values for run in simulation.policies[label].replicates]
        for values in passed:
            for item in agree([values], replicates, LEVEL, 1).values():
                if item.counted:
                    yield bool(item.inside)


@pytest.mark.slow
def test_as_many_are_inside_as_are_said_to_be(
    simulation: Simulation,
    recorded: Callable[..., dict[str, tuple[Measured, ...]]],
    make_machine: Callable[..., HardwareProfile],
) -> None:
    """Of recordings that are simulations with other seeds and draws, 80 to 97 % are inside.

    With costs twice those of the profile, of which policies know nothing, at most half are.
    """
    draws = tuple(np.linspace(1, 62, RECORDINGS).astype(int).tolist())
    shares: list[float] = []
    for factor in (1.0, 2.0):
        found = recorded(make_machine(factor), draws=draws)
        values = {
            label: [stretch_of(item, simulation.window_s).values() for item in passed]
            for label, passed in found.items()
        }
        inside = list(cells(simulation, values))
        assert len(inside) > 150
        shares.append(float(np.mean(inside)))
    assert 0.80 <= shares[0] <= 0.97
    assert shares[1] < 0.5


def test_an_interval_holds_as_many_values_as_it_says() -> None:
    """Of one more value of the same distribution 90 % are inside, whatever that is."""
    rng = np.random.default_rng(0)
    for draw in (rng.standard_normal, rng.standard_exponential):
        inside = 0
        for _ in range(4000):
            *known, one_more = draw(41).tolist()
            low, high = predictive_interval(known, 0.9)
            assert low is not None
            assert high is not None
            inside += low <= one_more <= high
        assert inside / 4000 == pytest.approx(0.9, abs=0.015)  # three standard deviations


def test_without_a_value_in_each_replicate_there_is_no_interval() -> None:
    """A metric that a replicate lacks, or too few of them, tell of no interval."""
    assert predictive_interval([1.0] * 40 + [None], 0.9) == (None, None)
    assert predictive_interval([1.0] * 18, 0.9) == (None, None)
    nineteen = [float(value) for value in range(19)]
    assert predictive_interval(nineteen, 0.9) == pytest.approx((0.0, 18.0))


def test_what_cannot_differ_does_not_count(made_scored: Callable[..., Scored]) -> None:
    """Equal values everywhere do not count; where the recording differs from all, they do.

    Lag counts only where frames are drawn deeper than one.
    """
    made = made_scored().values
    some = dict.fromkeys(made, 1.0)
    found = agree([some], [some] * 40, LEVEL, 2)
    assert not any(item.counted for item in found.values())
    other = dict.fromkeys(made, 2.0)
    for deep, expected in ((1, False), (2, True)):
        found = agree([other], [some] * 40, LEVEL, deep)
        assert found["frame_ms_mean"].counted
        assert found["frame_ms_mean"].inside is False
        assert not found["work_ms_mean"].counted
        assert found["lag_ms_mean"].counted is expected
