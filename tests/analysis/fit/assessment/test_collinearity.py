"""Columns that cannot be told apart are named, with what of them can be."""

from collections.abc import Callable

import numpy as np
import pytest

from lodbench.analysis.fit.assessment.collinearity import examine
from lodbench.analysis.fit.assessment.sensitivity import sensitivity
from lodbench.analysis.fit.design import Design, design_of
from lodbench.analysis.fit.estimate import estimate
from lodbench.analysis.fit.fit_frames import Sample
from lodbench.analysis.fit.sampling.priors import Priors
from lodbench.analysis.fit.sampling.sampler import SamplerOptions
from lodbench.analysis.fit.terms import parse_terms

MakeSample = Callable[..., Sample]

TERMS = parse_terms("draw_calls,triangles")


def test_the_condition_number_is_numpys():
    """Of columns scaled to unit length."""
    columns = np.random.default_rng(1).uniform(0.0, 2.0, (3, 40))
    lengths = np.sqrt((columns**2).sum(axis=1))
    found = examine(Design(("base", "a", "b"), np.ones(3), columns, 3), [1.0, 1.0, 1.0])
    expected = np.linalg.cond((columns / lengths[:, np.newaxis]).T)
    assert found.condition_number == pytest.approx(float(expected), rel=1e-9)
    assert found.groups == ()


def test_collinear_columns_are_named_with_their_ratio(make_sample: MakeSample):
    """5,000 triangles come with a draw; the costlier column comes first."""
    design = design_of(make_sample("collinear"), TERMS)
    (group,) = examine(design, [4.0, 9.0, 1.0]).groups
    assert group.names == ("draw_calls", "triangles")
    assert group.ratio == pytest.approx(np.array([1.0, 5e3]), rel=0.01)
    assert group.condition_index > 100.0
    assert group.combination == "draw_calls + 5e+03 triangles"
    (other,) = examine(design, [4.0, 1.0, 9.0]).groups
    assert other.combination == "triangles + 0.0002 draw_calls"


def test_equal_columns_do_not_divide_by_zero(make_sample: MakeSample):
    """A column twice is as collinear as can be."""
    sample = make_sample()
    twice = np.column_stack([sample.column("triangles")] * 2)
    design = design_of(
        Sample(("triangles", "vertices"), twice, sample.time_ms, sample.series),
        parse_terms("triangles,vertices"),
    )
    found = examine(design, [1.0, 1.0, 1.0])
    assert found.condition_number > 1e6
    assert [set(group.names) for group in found.groups] == [{"triangles", "vertices"}]


def test_the_combination_is_known_better_than_its_parts(make_sample: MakeSample):
    """Its deviation is a tenth of what independent parts would have."""
    sample = make_sample("collinear")
    found = estimate(sample, TERMS, "gaussian", SamplerOptions(max_steps=1_000))
    (group,) = examine(found.design, found.chain.flat[:, :3].mean(axis=0)).groups
    columns = [found.design.names.index(name) for name in group.names]
    parts = found.coefficients_ms[:, columns] * group.ratio
    assert parts.sum(axis=1).std() < 0.1 * np.sqrt((parts.std(axis=0) ** 2).sum())


def test_a_coefficient_that_only_the_prior_knows_is_not_informed():
    """Samples of the prior have no contraction; narrow ones do, whatever the prior's width."""
    rng = np.random.default_rng(5)
    priors = Priors(10.0)
    samples = np.column_stack(
        [np.abs(20.0 * rng.standard_normal(40_000)), 5.0 + 0.1 * rng.standard_normal(40_000)]
    )
    vague, sharp = sensitivity(samples, priors)
    assert abs(vague.contraction) < 0.05
    assert vague.shift_sd > 0.5
    assert not vague.informed
    assert sharp.contraction > 0.99
    assert sharp.shift_sd < 0.05
    assert sharp.informed


def test_the_shift_is_that_of_the_posterior_under_the_other_prior():
    """For a half-normal prior alone, halving the scale halves the mean: 0.66 deviations."""
    samples = np.abs(20.0 * np.random.default_rng(5).standard_normal((200_000, 1)))
    (found,) = sensitivity(samples, Priors(10.0))
    half = 0.5 * np.sqrt(2.0 / np.pi) / np.sqrt(1.0 - 2.0 / np.pi)
    assert found.shift_sd >= half - 0.02


def test_priors_are_said_with_their_reasons():
    """Each line of the priors names what it is of and why; Gaussian noise has no tails to guess."""
    student, gaussian = Priors(8.0).describe("student-t"), Priors(8.0).describe("gaussian")
    assert len(student) == 4
    assert "about 16 ms" in student[0]
    assert student[:2] == gaussian
