"""Rotation by quaternions against scipy's."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lodbench.models.scene.rotation import rotate, rotation_matrix


def test_rotation_agrees_with_scipy() -> None:
    """Vectors turn, and matrices look, as scipy's ``Rotation`` says."""
    turns = Rotation.random(50, random_state=1)
    vectors = np.random.default_rng(2).normal(size=(50, 3))
    quaternions = turns.as_quat()
    assert rotate(quaternions, vectors) == pytest.approx(turns.apply(vectors))
    for quaternion, matrix in zip(quaternions, turns.as_matrix(), strict=True):
        x, y, z, w = quaternion.tolist()
        assert rotation_matrix((x, y, z, w)) == pytest.approx(matrix)


def test_a_quarter_turn_by_hand() -> None:
    """A quarter turn about z takes x to y."""
    quarter = np.array([[0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5)]])
    assert rotate(quarter, np.array([[1.0, 0.0, 0.0]])) == pytest.approx(np.array([[0, 1, 0]]))
