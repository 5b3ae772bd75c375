"""Ranks: by hand, and how often equal policies are torn apart."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from lodbench.analysis.verdict.criterion import Criterion
from lodbench.analysis.verdict.ranking import RankGroup, ranking

Study = Callable[[np.random.Generator], tuple[list[str], list[Criterion]]]

NOISE = 0.01 * np.random.default_rng(0).standard_normal((3, 5, 10))


def rows(means: list[float], metric: int = 0) -> np.ndarray:
    """Return policies of these means on ten paths, with little noise of their own."""
    return np.array(means)[:, None] + NOISE[metric, : len(means)]


def standing(groups: tuple[RankGroup, ...]) -> list[set[str]]:
    """Return who shares a rank, best first."""
    return [set(group.members) for group in groups]


def test_margins_by_hand() -> None:
    """Errors 1, 1.2, 1.4, 4 and 4.3: a quarter of a pixel counts at 1, a tenth at 4."""
    error = Criterion("error", rows([1.0, 1.2, 1.4, 4.0, 4.3]), absolute=0.25)
    groups = ranking(list("abcde"), [error])
    assert standing(groups) == [{"a", "b"}, {"c"}, {"d", "e"}]
    assert [group.leader for group in groups] == ["a", "c", "d"]
    assert [group.rank for group in groups] == [1, 2, 3]
    assert [group.behind_by for group in groups] == [None, "error", "error"]


def test_equality_is_with_the_leader() -> None:
    """1.2 is equal with 1, and 1.4 with 1.2, but 1.4 is not with 1: it leads the next group."""
    error = Criterion("error", rows([1.2, 1.4, 1.0]), absolute=0.25)
    assert standing(ranking(list("abc"), [error])) == [{"a", "c"}, {"b"}]


def test_equals_are_split_by_the_next_metric() -> None:
    """Of three equal in error, pops split two off, and work these; who is behind says by what."""
    criteria = [
        Criterion("error", rows([1.0, 1.1, 1.2, 3.0]), absolute=0.25),
        Criterion("pops", rows([90.0, 20.0, 20.5, 1.0], 1)),
        Criterion("work", rows([5.0, 8.0, 5.0, 1.0], 2)),
    ]
    groups = ranking(list("abcd"), criteria)
    assert standing(groups) == [{"c"}, {"b"}, {"a"}, {"d"}]
    assert [group.behind_by for group in groups] == [None, "work", "pops", "error"]


def test_few_pops_do_not_decide_for_a_far_coarser_picture() -> None:
    """Of 4 and 29 px on four paths neither is shown to be less, as one path has 100 px.

    Pops are shown to differ, and yet both share the rank, which is named after the finer; where
    errors are within the margin, pops decide as ever.
    """
    pops = Criterion("pops", np.array([[26.0, 27.0, 26.0, 27.0], [7.0, 8.0, 7.0, 8.0]]))
    error = Criterion("error", np.array([[4.0] * 4, [4.0, 5.0, 7.0, 100.0]]), absolute=0.25)
    (both,) = ranking(["fine", "coarse"], [error, pops])
    assert both.members == ("fine", "coarse")
    alike = Criterion("error", np.array([[4.0] * 4, [4.0, 4.1, 4.2, 4.1]]), absolute=0.25)
    assert standing(ranking(["fine", "coarse"], [alike, pops])) == [{"coarse"}, {"fine"}]


def test_noise_in_errors_does_not_hide_what_pops_show() -> None:
    """Equal errors, log-normal by half between paths, and 180 pops a second beside .3.

    Of 400 studies of four paths the noisy policy shares the rank in few, of ten in next to none.
    """
    for paths, most in ((4, 0.05), (10, 0.01)):
        shared = 0
        for seed in range(400):
            rng = np.random.default_rng((paths, seed))
            errors = np.exp(0.5 * rng.standard_normal((2, paths)))
            pops = np.array([[180.0], [0.3]]) + np.array([[2.0], [0.1]]) * rng.random((2, paths))
            order = [Criterion("error", 2.0 * errors, absolute=0.25), Criterion("pops", pops)]
            shared += ranking(["noisy", "calm"], order)[0].members != ("calm",)
        # Where the noisy one is shown to be finer, which is one study in twenty, it is first.
        assert shared <= (most + 0.05) * 400


def test_higher_is_better() -> None:
    """A metric in which more is better ranks the other way round, with a tenth below the best."""
    benefit = Criterion("benefit", rows([10.0, 9.2, 8.0]), better="higher")
    assert standing(ranking(list("abc"), [benefit])) == [{"a", "b"}, {"c"}]


def test_zero_of_the_best_has_no_relative_margin() -> None:
    """A tenth of nothing is nothing: what is always seen to differ then differs."""
    pops = Criterion("pops", np.array([[0.0] * 10, [0.01] * 10]))
    assert standing(ranking(["a", "b"], [pops])) == [{"a"}, {"b"}]
    error = Criterion("error", np.array([[0.0] * 10, [0.01] * 10]), absolute=0.25)
    assert standing(ranking(["a", "b"], [error])) == [{"a", "b"}]


def test_what_paths_do_not_show_is_equal() -> None:
    """A difference within the scatter of paths is none; from one path nothing is shown."""
    scatter = np.random.default_rng(3).standard_normal((2, 10))
    loud = Criterion("error", np.array([[5.0], [6.0]]) + 3 * scatter)
    assert standing(ranking(["a", "b"], [loud])) == [{"a", "b"}]
    one = Criterion("error", np.array([[1.0], [9.0]]))
    assert standing(ranking(["b", "a"], [one])) == [{"a", "b"}]


def test_common_paths_are_paired() -> None:
    """Paths ten times apart hide nothing, as both policies share them."""
    path = np.geomspace(1, 10, 10)
    paired = Criterion("error", np.array([path, 1.3 * path]))
    assert standing(ranking(["a", "b"], [paired])) == [{"a"}, {"b"}]


def test_noisy_policies_hold_nobody_together() -> None:
    """On four paths, b is too noisy to be shown worse than a; that makes c, far off, no equal.

    Nor does b lead, although it has the least work and pops are not shown to differ: its error, of
    1.75 px, is a pixel above that of a.
    """
    criteria = [
        Criterion("error", np.array([[0.6, 0.4, 0.7, 0.7], [2.0, 0.3, 2.3, 2.4], [9.0, 9, 5, 5]])),
        Criterion("pops", np.array([[1.0, 2, 1, 1], [30, 1, 9, 20], [7, 6, 8, 7]]), absolute=1.0),
        Criterion("work", np.array([[9.9, 10, 9.8, 10.1], [4.0, 9.9, 5, 6], [3.5, 3.7, 3.9, 3.6]])),
    ]
    groups = ranking(list("abc"), criteria)
    assert [group.members for group in groups] == [("a", "b"), ("c",)]


def test_order_of_input_does_not_matter() -> None:
    """Shuffled policies have the same groups with the same members in the same order."""
    rng = np.random.default_rng(7)
    labels = [f"policy-{i}" for i in range(12)]
    values = np.round(rng.gamma(4, size=(12, 1)) + 0.3 * rng.standard_normal((3, 12, 8)), 1) + 5
    values[:, 3] = values[:, 8]  # identical policies too

    def groups(order: NDArray[np.int64]) -> tuple[RankGroup, ...]:
        criteria = [Criterion(name, of[order]) for name, of in zip("epw", values, strict=True)]
        return ranking([f"policy-{i}" for i in order], criteria)

    expected = groups(np.arange(12))
    assert sorted(label for group in expected for label in group.members) == sorted(labels)
    for _ in range(20):
        assert groups(rng.permutation(12)) == expected


def test_nobody() -> None:
    """Where nobody keeps the budget there is nothing to rank."""
    assert ranking([], [Criterion("error", np.empty((0, 10)))]) == ()


def alone(rng: np.random.Generator) -> tuple[list[str], list[Criterion]]:
    """Two policies equal in distribution, without margin and without common paths."""
    return ["a", "b"], [Criterion(k, rng.standard_normal((2, 10)) + 5, relative=0.0) for k in "epw"]


def rare_pops(rng: np.random.Generator) -> tuple[list[str], list[Criterion]]:
    """Two on common paths, whose pops are so few that a tenth of them is nothing."""
    path = np.exp(0.3 * rng.standard_normal(10))
    own = np.exp(0.05 * rng.standard_normal((2, 2, 10)))
    pops = rng.poisson(0.5 * path, (2, 10)) / 12.0
    criteria = [Criterion("error", path * own[0], absolute=0.25), Criterion("pops", pops)]
    return ["a", "b"], [*criteria, Criterion("work", path * own[1])]


def in_company(rng: np.random.Generator) -> tuple[list[str], list[Criterion]]:
    """Two among six others, where borders of groups run close by them."""
    factor = np.array([1, 1, 0.9, 0.95, 1.05, 1.1, 1.2, 0.85])[:, None]
    path = np.exp(0.3 * rng.standard_normal(10))

    def own(sd: float) -> np.ndarray:
        return factor * path * np.exp(sd * rng.standard_normal((8, 10)))

    criteria = [Criterion("error", 3 * own(0.05), absolute=0.25), Criterion("pops", 100 * own(0.1))]
    return list("abcdefgh"), [*criteria, Criterion("work", own(0.02))]


@pytest.mark.parametrize("study", [alone, rare_pops, in_company])
def test_equal_policies_are_rarely_torn_apart(study: Study) -> None:
    """Two that are equal in distribution have different ranks in at most 5 % of 200 studies."""
    apart = 0
    for seed in range(200):
        labels, criteria = study(np.random.default_rng(seed))
        rank = {m: group.rank for group in ranking(labels, criteria) for m in group.members}
        apart += rank["a"] != rank["b"]
    assert apart <= 10 + 3 * np.sqrt(200 * 0.05 * 0.95)


def test_different_policies_in_company_are_told_apart() -> None:
    """Holding equals together does not hold all: a fifth more error is another rank."""
    for seed in range(50):
        labels, criteria = in_company(np.random.default_rng(seed))
        groups = ranking(labels, criteria)
        rank = {m: group.rank for group in groups for m in group.members}
        assert rank["h"] < rank["g"]
        assert len(groups) >= 3
