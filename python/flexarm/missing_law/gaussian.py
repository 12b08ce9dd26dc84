r"""Linear Gaussian model of low rank: marginal likelihood and cross-validation.

.. math:: y = s A \xi + B u + e, \quad \xi, u \sim N(0, 1), \quad e \sim N(0, v)                       (1)

With P the projection that eliminates u (`diagnosis.fit`), and P A = Q \Lambda^{1/2} V^T,

.. math:: -2 \ln p(y) = n \ln v + \sum_i \ln(1 + s^2 \lambda_i/v)
          + \frac1v \Big(|P y|^2 - \sum_i \frac{s^2 c_i^2}{v + s^2 \lambda_i}\Big), \quad
          c = V^T (P A)^T P y                                                                         (2)

up to a constant. s and v, at least the noise's own 1, maximise (2). With U = [s A/sqrt(v), B] the covariance
is v (1 + U U^T), and a block b left out has the predictive density [Rasmussen2006, 5.4.2]

.. math:: \ln p(y_b | y_{-b}) = -\tfrac12 (\alpha_b^T C_b \alpha_b + \ln |C_b| + n_b \ln 2\pi), \quad
          C_b = ((\Sigma^{-1})_{bb})^{-1}, \quad \alpha = \Sigma^{-1} y                                (3)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from flexarm.arrays import Floats
from flexarm.diagnosis.fit import Projection
from flexarm.missing_law.policy import LawPolicy


@dataclass(frozen=True, eq=False)
class GaussianData:
    """y and B of (1)."""

    y: Floats
    """Minus the residual over its noise, shape (n,)."""
    projection: Projection
    """Eliminates nuisance parameters."""
    policy: LawPolicy = field(default_factory=LawPolicy)
    """Has the grid of s and v."""

    @property
    def nuisance(self) -> Floats:
        """B of (1), shape (n, k); parameters without a prior get a wide one."""
        found: Floats = self.projection.jacobian * self.nuisance_size
        return found

    @property
    def nuisance_size(self) -> Floats:
        """Prior deviation of nuisance parameters, shape (k,)."""
        known = np.isfinite(self.projection.sigma)
        wide = np.where(known, 1.0, 1e3 * max(float(np.linalg.norm(self.y)), 1.0))
        found: Floats = self.projection.scale * wide
        return found

    def cost(self) -> float:
        """|P y|^2."""
        projected = self.projection.project(self.y)
        return float(projected @ projected)


@dataclass(frozen=True, eq=False)
class GaussianModel:
    """Eq. (1) at the s and v that maximise (2)."""

    data: GaussianData
    """y and B."""
    size: float
    """s."""
    factor: Floats
    """s A, shape (n, m)."""
    noise: float
    """v."""
    log_evidence: float
    """Eq. (2)."""

    @classmethod
    def of(cls, data: GaussianData, columns: Floats) -> GaussianModel:
        """Maximise (2) for A = columns, over a grid of s and v."""
        return ColumnSpace.of(data, columns).model(np.eye(columns.shape[1]))

    @classmethod
    def likely(cls, data: GaussianData, columns: Floats, reach: float) -> list[GaussianModel]:
        """Return the models of all s on a grid whose (2), at the best v, is within reach of the greatest."""
        return ColumnSpace.of(data, columns).models(np.eye(columns.shape[1]), reach)

    def _whitened(self) -> Floats:
        """Return U."""
        return np.column_stack([self.factor / np.sqrt(self.noise), self.data.nuisance])

    @cached_property
    def _lower(self) -> Floats:
        """Cholesky factor of 1 + U^T U."""
        u = self._whitened()
        return np.asarray(np.linalg.cholesky(u.T @ u + np.eye(u.shape[1])))

    def posterior(self) -> tuple[Floats, Floats]:
        """Return mean of s^-1 s xi and a root of its covariance, for what multiplies `factor`."""
        mean, root = self._posterior
        m = self.factor.shape[1]
        return mean[:m] / np.sqrt(self.noise), root[:m]

    def nuisance_posterior(self) -> tuple[Floats, Floats]:
        """Return mean and deviation of the nuisance parameters, in their own units."""
        mean, root = self._posterior
        m, size = self.factor.shape[1], self.data.nuisance_size
        return size * mean[m:], size * np.sqrt(self.noise) * np.linalg.norm(root[m:], axis=1)

    @cached_property
    def _posterior(self) -> tuple[Floats, Floats]:
        """Return the mean of what multiplies U, and a root of its covariance over v."""
        from scipy.linalg import solve_triangular

        inverse = solve_triangular(self._lower, np.eye(len(self._lower)), lower=True)
        return inverse.T @ (inverse @ (self._whitened().T @ self.data.y)), inverse.T

    def predictive(self, blocks: Sequence[NDArray[np.intp]]) -> float:
        """Return the sum of (3) over blocks."""
        from scipy.linalg import LinAlgError, cholesky, solve_triangular

        half = solve_triangular(self._lower, self._whitened().T, lower=True).T
        alpha = (self.data.y - half @ (half.T @ self.data.y)) / self.noise
        total = 0.0
        for rows in blocks:
            inverse = (np.eye(len(rows)) - half[rows] @ half[rows].T) / self.noise
            try:
                lower = cholesky(inverse, lower=True)
            except LinAlgError:
                return -np.inf
            z = solve_triangular(lower, alpha[rows], lower=True)
            logdet = 2.0 * float(np.sum(np.log(np.diag(lower))))
            total -= 0.5 * (float(z @ z) - logdet + len(rows) * np.log(2 * np.pi))  # eq. (3)
        return total

    def left(self) -> float:
        """Return the squared residual of the posterior mean, nuisance parameters fitted along."""
        mean, _ = self.posterior()
        rest = self.data.projection.project(self.data.y - self.factor @ mean)
        return float(rest @ rest)


@dataclass(frozen=True, eq=False)
class ColumnSpace:
    """Columns R, shape (n, m), and the products of (2), for A = R L of many L, shape (m, k)."""

    data: GaussianData
    """y and B."""
    columns: Floats | csr_matrix
    """R."""
    gram: Floats
    """(P R)^T P R, shape (m, m)."""
    moment: Floats
    """(P R)^T P y, shape (m,)."""
    square: float
    """|P y|^2."""

    @classmethod
    def of(cls, data: GaussianData, columns: Floats | csr_matrix) -> ColumnSpace:
        """Project columns and data; dense columns are projected, of sparse ones their explained part."""
        y = data.projection.project(data.y)
        if isinstance(columns, csr_matrix):
            explained = data.projection.explained(columns)
            gram = (columns.T @ columns).toarray() - explained.T @ explained
            moment = columns.T @ y[: len(data.y)]  # P y is orthogonal to the eliminated columns
            return cls(data, columns, gram, moment, float(y @ y))
        projected = data.projection.project(columns)
        return cls(data, columns, projected.T @ projected, projected.T @ y, float(y @ y))

    def about(self, data: GaussianData) -> ColumnSpace:
        """Return the same columns for another y."""
        y = data.projection.project(data.y)
        moment = data.projection.project(self.columns).T @ y
        return replace(self, data=data, moment=moment, square=float(y @ y))

    def spectrum(self, root: Floats) -> tuple[Floats, Floats]:
        """Return Lambda and V of A = R L, which do not depend on y."""
        values, vectors = np.linalg.eigh(root.T @ self.gram @ root)
        return np.maximum(values, 0.0), vectors

    def log_evidence(self, root: Floats, spectrum: tuple[Floats, Floats] | None = None) -> float:
        """Return the greatest (2) for A = R L."""
        return float(self._evidence(root, spectrum)[0].max())

    def model(self, root: Floats, spectrum: tuple[Floats, Floats] | None = None) -> GaussianModel:
        """Return the model of the greatest (2) for A = R L."""
        return max(self.models(root, 0.0, spectrum), key=lambda each: each.log_evidence)

    def models(
        self, root: Floats, reach: float, spectrum: tuple[Floats, Floats] | None = None
    ) -> list[GaussianModel]:
        """Return the models of all s on a grid whose (2), at the best v, is within reach of the greatest."""
        found, sizes, noises = self._evidence(root, spectrum)
        best = np.argmax(found, axis=1)
        likely = [(i, j) for i, j in enumerate(best) if found[i, j] >= found.max() - reach]
        columns = self.columns @ root
        return [
            GaussianModel(
                self.data, float(sizes[i]), sizes[i] * columns, float(noises[j]), float(found[i, j])
            )
            for i, j in likely
        ]

    def _evidence(
        self, root: Floats, spectrum: tuple[Floats, Floats] | None
    ) -> tuple[Floats, Floats, Floats]:
        """Return (2) over a grid, shape (s, v), and the values of s and v."""
        n, yy, policy = len(self.data.y), self.square, self.data.policy
        values, vectors = spectrum or self.spectrum(root)
        c = vectors.T @ (root.T @ self.moment)
        greatest = float(values.max(initial=0.0)) or 1.0
        sizes2 = np.concatenate([[0.0], np.geomspace(1.0, policy.size_range, policy.sizes) / greatest])
        noises = np.geomspace(1.0, max(yy / n, 1.0) * 1.01, policy.noises)  # not of one value
        part = sizes2[:, None] / noises
        more = 1.0 + part[:, :, None] * values
        square = yy - part * ((1.0 / more) @ c**2)
        found = -0.5 * (n * np.log(noises) + np.log(more).sum(axis=2) + square / noises)  # eq. (2)
        return found, np.sqrt(sizes2), noises


def matern_root(places: Floats, length: float) -> Floats:
    """Return L of K = L L^T, the Matern covariance (5/2) of size one [Rasmussen2006, 4.2.1], shape (m, k).

    Directions of less than 1e-12 of the greatest variance, which are rounding, are left out.
    """
    d = np.sqrt(5.0) * np.abs(places[:, None] - places[None]) / length
    variances, directions = np.linalg.eigh((1 + d + d**2 / 3) * np.exp(-d))
    seen = variances > 1e-12 * variances[-1]
    return np.asarray(directions[:, seen] * np.sqrt(variances[seen]))
