"""Claims about the regressors of a channel: their span counts, not their sizes, copies or zeros."""

import numpy as np

from flexarm.validation.channel import orthonormal_columns


def test_columns_become_orthonormal_and_span_the_same():
    A = np.random.default_rng(2).normal(size=(300, 3)) * [1e-9, 1.0, 1e6]
    Q = orthonormal_columns(A)
    np.testing.assert_allclose(Q.T @ Q, np.eye(3), atol=1e-13)
    np.testing.assert_allclose(Q @ (Q.T @ A), A, rtol=1e-9, atol=1e-22)


def test_copies_and_zeros_add_no_direction():
    a, b = np.random.default_rng(3).normal(size=(2, 50))
    Q = orthonormal_columns(np.column_stack([a, np.zeros(50), 3 * a, b]))
    assert Q.shape == (50, 2)
    assert orthonormal_columns(np.zeros((5, 2))).shape == (5, 0)
