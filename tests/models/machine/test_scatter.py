"""Scatter between occasions and scenes: what a draw's factors are of, and how few cover it."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from lodbench.analysis.study.runs import choose_draws
from lodbench.base.arrays import FloatArray
from lodbench.base.errors import InputError
from lodbench.base.predictors import GPU_PREDICTORS
from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.hardware import HardwareProfile, Posterior
from lodbench.models.machine.knee import Knee
from lodbench.models.machine.residual import Residual
from lodbench.models.machine.scatter import SCATTERED, Scatter

P = len(GPU_PREDICTORS)
ONE = CostModel(
    1.0, np.ones(P), np.ones(P), (Knee("triangles", 9.0, 1.0), Knee("vertices", 9.0, 1.0))
)


def base_factors(scatter: Scatter, draws: int) -> FloatArray:
    """Return the factors of the base by draw."""
    return np.array([scatter.apply(ONE, draw).base_ms for draw in range(draws)])


@pytest.mark.parametrize("draws", [4, 8, 16, 64])
@pytest.mark.parametrize("name", ["occasion", *SCATTERED])
def test_few_draws_cover_the_distribution(name: str, draws: int):
    """Of the first n factors of any name one lies in each n-th of the log-normal distribution."""
    scatter = Scatter(0.09) if name == "occasion" else Scatter(0.0, {name: 0.09})
    at = 0 if name in ("occasion", "base") else 1 + GPU_PREDICTORS.index(name)
    models = [scatter.apply(ONE, draw) for draw in range(draws)]
    drawn = np.array([(model.base_ms, *model.linear_ms)[at] for model in models])
    part = norm.cdf(np.log(drawn) / 0.09) * draws
    assert np.floor(np.sort(part)).tolist() == list(range(draws))


def test_quantiles_of_eight_and_sixty_four_draws():
    """Log-sd .25: median 1, mean of the logs 0, and the ends of 64 beyond those of 90 %."""
    scatter = Scatter(0.0, {"base": 0.25})
    for draws, within in ((8, 0.05), (64, 0.01)):
        logs = np.log(base_factors(scatter, draws))
        assert logs.mean() == pytest.approx(0.0, abs=within)
        assert logs.std(ddof=1) == pytest.approx(0.25, rel=0.15)
    logs = np.sort(np.log(base_factors(scatter, 64)))
    assert logs[[3, 60]] == pytest.approx([-1.6 * 0.25, 1.6 * 0.25], rel=0.1)  # of .055 and .945


def test_factors_of_different_names_do_not_go_together():
    """No two names correlate by more than luck; those that a fit scatters hardly do."""
    scatter = Scatter(0.0, dict.fromkeys(SCATTERED, 0.1))
    logs = np.log([(m.base_ms, *m.linear_ms) for m in (scatter.apply(ONE, d) for d in range(64))])
    correlation = np.corrcoef(logs.T) - np.eye(len(SCATTERED))
    assert np.abs(correlation).max() < 0.5  # 190 pairs of 64: luck alone goes up to some .4
    names = ("base", "triangles", "rasterized_triangles")
    fitted = logs[:, [SCATTERED.index(name) for name in names]]
    occasion = np.log(base_factors(Scatter(0.1), 64))[:, None]
    for draws in (8, 16, 32, 64):
        few = np.hstack([occasion, fitted])[:draws]
        assert np.abs(np.corrcoef(few.T) - np.eye(4)).max() < 0.34


def test_an_occasion_is_common_to_all():
    """Base, linear, roofline and knee prices of a draw have the one factor of its occasion."""
    alike = Scatter(0.1).apply(ONE, 3)
    assert set(alike.linear_ms) | set(alike.roofline_ms) == {alike.base_ms}
    assert {knee.ms for knee in alike.knees} == {alike.base_ms}


def test_a_term_has_one_factor_wherever_it_is_priced():
    """Linear, roofline and knee prices of triangles share it, and nothing else has any."""
    model = Scatter(0.0, {"triangles": 0.5}).apply(ONE, 2)
    triangles = GPU_PREDICTORS.index("triangles")
    factor = model.linear_ms[triangles]
    assert factor != 1.0
    assert model.roofline_ms[triangles] == factor
    assert [knee.ms for knee in model.knees] == [factor, 1.0]
    others = np.delete(model.linear_ms, triangles)
    assert (model.base_ms, set(others)) == (1.0, {1.0})
    assert [knee.at for knee in model.knees] == [9.0, 9.0]


def test_a_factor_does_not_depend_on_what_else_scatters():
    """A fit that adds a term leaves the occasions of all draws as they were."""
    alone, among = Scatter(0.09), Scatter(0.09, {"triangles": 0.25})
    assert base_factors(alone, 16).tolist() == base_factors(among, 16).tolist()


def test_a_draw_is_a_row_of_the_posterior_under_its_factors(
    make_hardware: Callable[..., HardwareProfile],
):
    """Row 1 of the posterior, knees among it, times the occasion of draw 1; the residual is its."""
    posterior = Posterior(
        np.array([1.0, 2.0]),
        np.full((2, P), 3.0),
        np.array([0.1, 0.2]),
        knee_ms=np.array([[5.0], [6.0]]),
    )
    gpu = CostModel.of(1.0, {"triangles": 1.0}, knees=[Knee("triangles", 100.0, 4.0)])
    plain = replace(make_hardware(residual=Residual("gaussian", 0.5)), gpu=gpu, posterior=posterior)
    hardware = replace(plain, scatter=Scatter(0.09))
    model, residual = hardware.truth(1)
    (factor,) = base_factors(Scatter(0.09), 2)[1:]
    assert model.base_ms == 2.0 * factor
    assert set(model.linear_ms) == {3.0 * factor}
    assert model.knees == (Knee("triangles", 100.0, 6.0 * factor),)
    assert residual.scale == 0.2
    assert plain.truth(1)[0].knees == (Knee("triangles", 100.0, 6.0),)
    assert hardware.truth(None) == (gpu, hardware.gpu_residual)


def test_scatter_alone_has_draws(make_hardware: Callable[..., HardwareProfile]):
    """A profile without a fit has 64 machines where it scatters, and none where it does not."""
    hardware = replace(make_hardware(), scatter=Scatter(0.1))
    assert hardware.draws == 64
    assert hardware.truth(5)[0].base_ms == base_factors(Scatter(0.1), 6)[5]
    with pytest.raises(InputError, match="has 64 draws, got 64"):
        hardware.truth(64)
    assert make_hardware().draws == 0
    assert not Scatter(0.0, {"triangles": 0.0}).any


def test_studies_take_the_first_draws_of_what_scatters(
    make_hardware: Callable[..., HardwareProfile],
):
    """As the first n cover it; of a fit alone, evenly spaced ones as ever."""
    posterior = Posterior(np.ones(10), np.ones((10, P)), np.ones(10))
    fitted = replace(make_hardware(), posterior=posterior)
    assert choose_draws(fitted, 4) == [0, 3, 6, 9]
    assert choose_draws(replace(fitted, scatter=Scatter(0.1)), 4) == [0, 1, 2, 3]
    assert choose_draws(replace(fitted, scatter=Scatter(0.1)), 99) == list(range(10))
    assert choose_draws(replace(make_hardware(), scatter=Scatter(0.1)), 8) == list(range(8))
    assert choose_draws(make_hardware(), 8) == []
