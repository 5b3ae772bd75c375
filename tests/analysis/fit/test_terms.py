"""Terms as users write them, and the means that they make."""

import numpy as np
import pytest

from lodbench.analysis.fit.design import design_of
from lodbench.analysis.fit.fit_frames import Sample, gather
from lodbench.analysis.fit.terms import Term, parse_terms, predictors_of
from lodbench.base.errors import InputError
from lodbench.traces.logs.render_log import RenderLog

SMALL = Sample(
    ("draw_calls", "triangles", "shaded_samples"),
    np.array([[1.0, 10.0, 400.0], [3.0, 30.0, 100.0]]),
    np.array([1.0, 2.0]),
    np.zeros(2, dtype=np.int64),
)


def test_all_kinds_of_terms_are_read():
    """Predictors, a type's own, products and a roofline with two geometry predictors."""
    text = (
        "draw_calls, triangles[oak, old],draw_calls*triangles,"
        "max(vertices+triangles, shaded_samples)"
    )
    with pytest.raises(InputError, match=r"got triangles\[oak"):
        parse_terms(text)
    terms = parse_terms(text.replace("oak, old", "oak"))
    assert terms == (
        Term("linear", ("draw_calls",)),
        Term("linear", ("triangles[oak]",)),
        Term("product", ("draw_calls", "triangles")),
        Term("roofline", ("vertices", "triangles", "shaded_samples")),
    )
    assert [str(term) for term in terms[2:]] == [
        "draw_calls*triangles",
        "max(vertices+triangles,shaded_samples)",
    ]
    assert predictors_of(terms) == (
        "draw_calls",
        "triangles[oak]",
        "triangles",
        "vertices",
        "shaded_samples",
    )


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "got nothing in ''"),
        ("draw_calls,,triangles", "got nothing"),
        ("draws", "got draws in 'draws'"),
        ("triangles,triangles", "expected each term once"),
        ("max(triangles)", r"got max\(triangles\)"),
        (
            "max(triangles,shaded_samples),max(vertices,shaded_samples)",
            "expected one roofline",
        ),
    ],
)
def test_what_is_no_term_is_refused(text: str, says: str):
    """Each mistake has its message."""
    with pytest.raises(InputError, match=says):
        parse_terms(text)


def test_means_are_those_computed_by_hand():
    """1 + 2 · draws + max(0.1 · triangles, 0.01 · samples) is 7 and 10; scaled or not."""
    design = design_of(SMALL, parse_terms("draw_calls,max(triangles,shaded_samples)"))
    assert design.names == (
        "base",
        "draw_calls",
        "roofline.triangles",
        "roofline.shaded_samples",
    )
    assert design.unit.tolist() == [1.0, 2.0, 20.0, 250.0]
    scaled = np.array([1.0, 2.0, 0.1, 0.01]) * design.unit
    assert design.mean(scaled[np.newaxis]) == pytest.approx(np.array([[7.0, 10.0]]))


def test_a_product_multiplies_its_factors():
    """Draws times triangles are 10 and 90."""
    design = design_of(SMALL, parse_terms("draw_calls*triangles"))
    assert (design.columns[1] * design.unit[1]).tolist() == [10.0, 90.0]


def test_a_constant_predictor_is_refused():
    """It cannot be told from the base."""
    still = Sample(("triangles",), np.full((5, 1), 7.0), np.ones(5), np.zeros(5, dtype=np.int64))
    with pytest.raises(InputError, match="got triangles, which is 7 in all frames"):
        design_of(still, parse_terms("triangles"))


def log_of(header: tuple[tuple[str, str], ...] = ()) -> RenderLog:
    """Return six frames, one of them with a missing time and one with a negative count."""
    counts = np.array([[1.0], [2.0], [3.0], [4.0], [-1.0], [6.0]])
    gpu_ms = np.array([1.0, 2.0, 3.0, np.nan, 5.0, 6.0])
    return RenderLog("run", "csv", ("triangles",), counts, gpu_ms=gpu_ms, header=header)


def test_frames_are_gathered_from_several_logs_and_the_others_counted():
    """The first three frames of each log are left out, and frames that measure nothing."""
    sample, rejected = gather([log_of(), log_of()], ["triangles"], "gpu_ms", None)
    assert sample.time_ms.tolist() == [6.0, 6.0]
    assert sample.series.tolist() == [0, 1]
    assert {str(rejection) for rejection in rejected} == {
        "2 gpu_ms that is missing or not finite",
        "2 a predictor that is missing or negative",
        "6 first frames (1 to 3)",
    }


def test_rows_of_averages_have_no_first_frames():
    """A table that says so in its header is used from its first row."""
    sample, _ = gather([log_of((("rows", "averages of runs"),))], ["triangles"], "gpu_ms", None)
    assert sample.time_ms.tolist() == [1.0, 2.0, 3.0, 6.0]


def test_a_log_without_one_measurement_is_refused():
    """The reasons are listed."""
    with pytest.raises(InputError, match="expected frames that measure gpu_ms, got none"):
        gather([log_of()], ["triangles"], "gpu_ms", 6)
