"""Covariance of noise and model discrepancy: against the same matrix written out, and on drawn processes."""

import numpy as np
import pytest

from flexarm.diagnosis.discrepancy import (
    PoseDiscrepancy,
    TimeDiscrepancy,
    in_time,
    of_poses,
    pose_kernels,
    stretches,
)

RNG = np.random.default_rng(3)
N = 300
APART = np.abs(np.subtract.outer(np.arange(N), np.arange(N)))


def covariance(noise, size, length, parts):
    """Eq. (1), nothing in common across pauses."""
    found = np.zeros((N, N))
    for rows in parts:
        found[rows, rows] = size * np.exp(-APART[rows, rows] / length)
    return found + noise * np.eye(N)


@pytest.mark.parametrize(
    ("noise", "size", "length"), [(1.2, 4.0, 20.0), (1.0, 900.0, 500.0), (1.0, 0.04, 3.0)]
)
def test_the_filter_whitens_as_the_inverse_of_the_covariance_does(noise, size, length):
    """The gain is taken as constant after 64 samples; it has settled to 1e-3 of the likelihood by then."""
    parts = [slice(0, 120), slice(120, N)]
    there, matrix = TimeDiscrepancy(parts, noise, size, length), covariance(noise, size, length, parts)
    values = np.linalg.cholesky(matrix) @ RNG.normal(size=(N, 2))
    squares = np.einsum("ik,ik->k", values, np.linalg.solve(matrix, values))
    assert np.sum(there.whitened(values) ** 2, axis=0) == pytest.approx(squares, rel=1e-3)
    assert there.log_determinant == pytest.approx(np.linalg.slogdet(matrix)[1], abs=1e-2)
    assert there.times(values) == pytest.approx(matrix @ values, rel=1e-9)


def test_white_noise_has_no_discrepancy_that_matters():
    """The most likely one of noise is small; 0.2 of 4000 samples would show at four sigmas."""
    found = in_time(RNG.normal(size=4000), np.arange(4000.0), 1.0)
    assert found.size < 0.1


def test_size_and_length_of_a_process_are_found():
    """200 correlation lengths know the variance to sqrt(2/100), one sigma; the length to some 20 %."""
    n, length, size = 8000, 40.0, 9.0
    phi = np.exp(-1 / length)
    process = np.zeros(n)
    for t, step in enumerate(np.sqrt(size * (1 - phi**2)) * RNG.normal(size=n)):
        process[t] = phi * process[t - 1] + step
    found = in_time(process + RNG.normal(size=n), np.arange(float(n)), 1.0)
    assert found.size == pytest.approx(size, rel=0.45)
    assert found.length == pytest.approx(length, rel=0.6)


def test_a_pause_parts_a_record():
    time = np.concatenate([np.arange(50) * 0.1, 9.0 + np.arange(30) * 0.1])
    assert stretches(time) == [slice(0, 50), slice(50, 80)]


def test_poses_that_are_near_share_their_discrepancy():
    """A wave over the angle of a joint is a discrepancy of the poses; scatter alone is none."""
    angle = RNG.uniform(-1, 1, size=(80, 2))
    kernels = pose_kernels(angle)
    noise, wave = RNG.normal(size=80), 5.0 * np.sin(3.0 * angle[:, 0])
    found, nothing = of_poses(noise + wave, kernels, 1.0), of_poses(noise, kernels, 1.0)
    assert np.sum(found.whitened(wave) ** 2) < 0.2 * np.sum(wave**2)
    assert nothing.variances.max() < 4.0


def test_poses_are_whitened_by_eigenvectors_as_by_the_matrix():
    values, vectors = pose_kernels(RNG.normal(size=(40, 3)))[2]
    there, matrix = (
        PoseDiscrepancy(vectors, 1.0 + 4.0 * values),
        np.eye(40) + 4.0 * (vectors * values) @ vectors.T,
    )
    y = RNG.normal(size=40)
    assert np.sum(there.whitened(y) ** 2) == pytest.approx(y @ np.linalg.solve(matrix, y))
    assert there.log_determinant == pytest.approx(np.linalg.slogdet(matrix)[1])
    assert there.times(y) == pytest.approx(matrix @ y)
