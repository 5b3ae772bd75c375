"""Terms chosen by held-out log score, and the logs that have none to choose from."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from lodbench.analysis.fit.assessment.choose_terms import candidate_predictors, choose_terms
from lodbench.analysis.fit.fit_frames import Origin, Sample
from lodbench.base.errors import InputError
from lodbench.traces.logs.render_log import RenderLog

MakeSample = Callable[..., Sample]


def with_noise_column(sample: Sample) -> Sample:
    """Add a predictor that has nothing to do with the time."""
    shaded = np.random.default_rng(1).uniform(1e4, 1e5, len(sample))
    return Sample(
        (*sample.names, "shaded_samples"),
        np.column_stack([sample.predictors, shaded]),
        sample.time_ms,
        sample.series,
    )


@pytest.mark.parametrize("kind", ["clean", "outliers", "heteroscedastic"])
def test_the_terms_that_made_the_times_are_chosen(make_sample: MakeSample, kind: str):
    """On each of ten logs, and the one that does nothing only by rare chance."""
    chosen: list[str] = []
    for seed in range(10):
        sample = with_noise_column(make_sample(kind, seed=seed, frames=400))
        terms, candidates = choose_terms(sample)
        assert [str(term) for term in terms][:2] == ["draw_calls", "triangles"]
        chosen += [str(term) for term in terms][2:]
        linear = [candidate for candidate in candidates if "(" not in "".join(candidate.terms)]
        assert len(linear) == 7
    assert len(chosen) <= 3
    terms, candidates = choose_terms(with_noise_column(make_sample(kind, frames=400)))
    assert candidates[0].behind == pytest.approx(0.0, abs=1e-12)
    assert all(a.log_score >= b.log_score for a, b in pairwise(candidates))


def bent(seed: int, at: float | None) -> Sample:
    """Return 800 frames of 2 ms + 10 us a draw + 20 ns a triangle, 20 ns more beyond `at`."""
    rng = np.random.default_rng((seed, 9))
    draws, triangles = rng.uniform(50, 400, 800), rng.uniform(2e4, 4e5, 800)
    mean = 2.0 + 0.01 * draws + 2e-5 * triangles
    if at is not None:
        mean = mean + 2e-5 * np.maximum(triangles - at, 0.0)
    time_ms = mean * (1.0 + 0.03 * rng.standard_normal(800))
    names = ("draw_calls", "triangles")
    return Sample(names, np.column_stack([draws, triangles]), time_ms, np.zeros(800, np.int64))


def test_a_knee_is_found_where_there_is_one_and_nowhere_else():
    """Triangles that cost twice as much beyond 158,000: a knee near it; of five plain logs none."""
    terms, _ = choose_terms(bent(0, 158_000.0))
    (knee,) = [term for term in terms if term.kind == "knee"]
    assert knee.predictors == ("triangles",)
    assert knee.at == pytest.approx(158_000.0, rel=0.3)
    for seed in range(5):
        assert {term.kind for term in choose_terms(bent(seed, None))[0]} == {"linear"}


def test_a_roofline_is_found_where_there_is_one():
    """Frames bound by triangles or by samples are told from frames that pay for both."""
    rng = np.random.default_rng(4)
    triangles, samples = rng.uniform(1e5, 1e6, (2, 800))
    mean = 1.0 + np.maximum(1e-5 * triangles, 1e-5 * samples)
    time_ms = mean * (1.0 + 0.03 * rng.standard_normal(800))
    names = ("triangles", "shaded_samples")
    sample = Sample(names, np.column_stack([triangles, samples]), time_ms, np.zeros(800, np.int64))
    assert [str(term) for term in choose_terms(sample)[0]] == ["max(triangles,shaded_samples)"]


def test_of_three_scenes_each_is_predicted_from_the_others():
    """A predictor that only tells scenes apart is no term, though blocks would have it."""
    rng = np.random.default_rng(5)
    scene = np.repeat([0, 1, 2], 300)
    draws, triangles = rng.uniform(50, 400, 900), rng.uniform(2e4, 4e5, 900)
    vertices = 1e5 * (1.0 + scene) + rng.uniform(0, 1e3, 900)
    slower = np.array([1.0, 1.3, 1.3])[scene]
    mean = slower * (2.0 + 0.01 * draws + 2e-5 * triangles)
    names = ("draw_calls", "triangles", "vertices")
    sample = Sample(
        names,
        np.column_stack([draws, triangles, vertices]),
        mean * (1.0 + 0.03 * rng.standard_normal(900)),
        scene,
        tuple(Origin(name, "one") for name in "abc"),
    )
    assert "vertices" in {str(term) for term in choose_terms(replace(sample, origins=()))[0]}
    assert "vertices" not in {str(term) for term in choose_terms(sample)[0]}


def test_of_terms_that_say_the_same_the_smaller_set_is_chosen(make_sample: MakeSample):
    """Collinear columns are not both taken."""
    terms, _ = choose_terms(make_sample("collinear", frames=400))
    assert len(terms) == 1


def test_many_predictors_are_tried_in_small_sets():
    """Of eight predictors, sets of up to three: 92 of them."""
    rng = np.random.default_rng(2)
    columns = rng.uniform(1.0, 2.0, (500, 8))
    time_ms = 1.0 + 2.0 * columns[:, 3] + 0.05 * rng.standard_normal(500)
    names = tuple(f"p{i}" for i in range(8))
    sample = Sample(names, columns, time_ms, np.zeros(500, dtype=np.int64))
    terms, candidates = choose_terms(sample)
    assert [str(term) for term in terms] == ["p3"]
    assert len(candidates) == 8 + 28 + 56


def log_of(**columns: list[float]) -> RenderLog:
    """Return a log with these predictors and a time."""
    counts = np.column_stack(list(columns.values())) if columns else np.empty((4, 0))
    return RenderLog("run", "csv", tuple(columns), counts, gpu_ms=np.ones(4), cpu_ms=np.ones(4))


def test_candidates_are_what_all_logs_hold_and_what_varies():
    """Constant, missing and foreign columns are no candidates; the CPU has its own."""
    one = log_of(
        draw_calls=[1.0, 2.0, 3.0, 4.0],
        triangles=[5.0, 5.0, 5.0, 5.0],
        vertices=[1.0, 2.0, np.nan, np.nan],
        comparisons=[1.0, 2.0, 3.0, 4.0],
    )
    assert candidate_predictors([one], "gpu_ms") == ("draw_calls",)
    assert candidate_predictors([one], "cpu_ms") == ("comparisons", "draw_calls")
    other = log_of(triangles=[5.0, 6.0, 7.0, 8.0])
    assert candidate_predictors([one, other], "gpu_ms") == ("triangles",)


def test_a_log_without_predictors_is_told_which_are_missing():
    """All that would do are named."""
    with pytest.raises(InputError, match=r"draw_calls, vertices, triangles.*none of them"):
        candidate_predictors([log_of()], "gpu_ms")
    with pytest.raises(InputError, match=r"expected predictors that vary, got .* triangles"):
        candidate_predictors([log_of(triangles=[5.0] * 4)], "gpu_ms")


def test_one_predictor_needs_no_choice_and_many_need_frames(make_sample: MakeSample):
    """Nine rows of one predictor are fitted as they are; of two they are too few to choose."""
    few = make_sample(frames=9)
    one = Sample(("triangles",), few.predictors[:, 1:], few.time_ms, few.series)
    assert [str(term) for term in choose_terms(one)[0]] == ["triangles"]
    with pytest.raises(InputError, match="at least 16 frames to choose among draw_calls, triang"):
        choose_terms(few)
