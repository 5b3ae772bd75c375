"""The bound met next, compared with a look at all of them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from lodbench.policies.solvers.near_bounds import NearBounds, Where


@given(seed=st.integers(0, 10_000), n=st.integers(1, 120), sign=st.sampled_from((1.0, -1.0)))
def test_the_first_bound_is_the_nearest_of_all(seed: int, n: int, sign: float) -> None:
    """Over passes that hold what is met while the target drifts; above and below."""
    rng = np.random.default_rng(seed)
    place = rng.uniform(0.2, 0.8, n)
    bound = np.maximum(sign * place, sign * rng.uniform(0.0, 1.5, n))
    bound[rng.random(n) < 0.1] = np.inf
    bounds = NearBounds(bound.copy(), sign)
    part, rest, target = 1.0, 0.0, 1.0 if sign > 0.0 else 0.3
    for _ in range(30):
        where = Where(place, part, rest, target)
        here = np.minimum(sign * (part * place + rest), bound)
        before = bound < sign * target
        way = np.where(before, (bound - here) / np.where(before, sign * target - here, 1.0), 1.0)
        first = bounds.first(where)
        if not bounds.sure(where, first.length):
            first = bounds.first_of_all(where)
        assert first.length == way.min()
        if first.length >= 1.0:
            break
        assert sorted(first.variables) == np.flatnonzero(way <= way.min()).tolist()
        bounds.strike(first.variables)
        bound[np.asarray(first.variables)] = np.inf
        part *= 1.0 - first.length
        rest += first.length * (target - rest)
        target *= 1.0 + sign * float(rng.choice([0.0, 0.001, 0.01, 0.2]))
