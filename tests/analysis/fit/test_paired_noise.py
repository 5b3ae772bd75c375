"""Frames drawn twice tell the machine's noise from what a model misses of them."""

import numpy as np
import pytest
from numpy.typing import NDArray

from lodbench.analysis.fit.noise import residual_model
from lodbench.analysis.fit.paired_noise import paired_residual, pairs_of
from lodbench.base.arrays import FloatArray

FRAMES, STEP_S = 6_000, 0.05
Drawn = tuple[FloatArray, FloatArray, NDArray[np.int64]]


def drawn_twice(
    noise: float, missed: float, alike: float, *, spikes: float = 0.0, seed: int = 0
) -> Drawn:
    """Return residuals in the order of drawing, times, and places on the path.

    What is missed forgets along the path in `alike` frames; both passes are shuffled.
    """
    rng = np.random.default_rng(seed)
    keeps = np.exp(-1.0 / alike)
    fresh = rng.standard_normal(FRAMES) * np.sqrt(1.0 - keeps**2)
    wrong = np.zeros(FRAMES)
    for frame in range(1, FRAMES):
        wrong[frame] = keeps * wrong[frame - 1] + fresh[frame]
    path = np.concatenate([rng.permutation(FRAMES), rng.permutation(FRAMES)]).astype(np.int64)
    residual = missed * wrong[path] + noise * rng.standard_normal(2 * FRAMES)
    hit = rng.random(2 * FRAMES) < spikes
    residual[hit] += rng.exponential(0.5, int(hit.sum()))
    return residual, rng.uniform(5.0, 20.0, 2 * FRAMES), path


def model_of(drawn: Drawn, kind: str = "student-t") -> dict[str, float]:
    """Return the fields of the residual model of one log."""
    residual, time_ms, path = drawn
    pairs = pairs_of(path)
    assert pairs is not None
    found = paired_residual(
        [residual], [time_ms], [pairs], STEP_S, "gaussian" if kind == "gaussian" else "student-t"
    )
    return {name: getattr(found, name) for name in found.__slots__ if name != "kind"}


def test_pairs_are_both_drawings_of_a_frame_in_the_order_of_the_path() -> None:
    """Frames 0, 1 and 2 drawn as 2, 0, 1 and then 1, 2, 0; one that was drawn once is left out."""
    pairs = pairs_of(np.array([2, 0, 1, 1, 2, 0]))
    assert pairs is not None
    assert pairs.tolist() == [[1, 5], [2, 3], [0, 4]]
    partly = pairs_of(np.array([2, 0, 1, 1, 2]))
    assert partly is not None
    assert partly.tolist() == [[2, 3], [0, 4]]
    assert pairs_of(np.arange(6)) is None


def test_what_both_drawings_share_is_no_noise() -> None:
    """3 % of noise and 10 % that the model misses, alike for eight frames, are told apart.

    One drawing of each frame takes it all for noise, three times what it is.
    """
    found = model_of(drawn_twice(0.03, 0.10, 8.0))
    spread = found["scale"] * np.sqrt(found["dof"] / (found["dof"] - 2.0))
    assert spread == pytest.approx(0.03, rel=0.05)
    assert found["slow_scale"] == pytest.approx(0.10, rel=0.1)
    assert found["slow_time_s"] == pytest.approx(8.0 * STEP_S, rel=0.25)
    assert found["spike_share"] == 0.0
    assert found["correlation"] < 0.1
    residual, _, path = drawn_twice(0.03, 0.10, 8.0)
    once = residual_model([residual[:FRAMES]], "student-t", STEP_S, [path[:FRAMES]])
    assert once.scale > 0.08


def test_noise_that_lasts_is_seen_in_the_order_of_drawing() -> None:
    """Noise that keeps .6 from one drawn frame to the next, in a log whose frames are shuffled."""
    residual, time_ms, path = drawn_twice(0.0, 0.05, 8.0, seed=1)
    rng = np.random.default_rng(2)
    noise = 0.03 * rng.standard_normal(len(residual))
    for frame in range(1, len(noise)):
        noise[frame] = 0.6 * noise[frame - 1] + 0.8 * noise[frame]
    found = model_of((residual + noise, time_ms, path), "gaussian")
    assert found["correlation"] == pytest.approx(0.6, abs=0.06)
    assert found["scale"] == pytest.approx(0.03, rel=0.05)


def test_spikes_are_counted_for_frames_and_not_for_pairs() -> None:
    """One frame of a hundred takes half as long again, on average; that is no part of the noise."""
    found = model_of(drawn_twice(0.03, 0.05, 8.0, spikes=0.01))
    assert found["spike_share"] == pytest.approx(0.01, rel=0.25)
    assert found["spike_scale"] == pytest.approx(0.5, rel=0.25)
    spread = found["scale"] * np.sqrt(found["dof"] / (found["dof"] - 2.0))
    assert spread == pytest.approx(0.03, rel=0.1)


def test_frames_count_by_their_time() -> None:
    """Frames of 0.1 ms whose noise is ten times as large hardly raise that of frames of 10 ms."""
    residual, time_ms, path = drawn_twice(0.03, 0.0, 8.0, seed=3)
    short = path < FRAMES // 2
    residual[short] *= 10.0
    time_ms[:] = np.where(short, 0.1, 10.0)
    found = model_of((residual, time_ms, path), "gaussian")
    assert found["scale"] == pytest.approx(0.03, rel=0.5)
