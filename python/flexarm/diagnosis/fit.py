"""A fitted model, and the projection that eliminates its nuisance parameters.

    C(r) = min over x of |r + J x|^2 + |x/sigma|^2                                                    (1)

r are residuals over their noise, J their Jacobian with respect to nuisance parameters x, counted from the
centres of their priors. With A = [J sigma; 1] = Q R and b = [r; 0],

    C(r) = |b - Q Q^T b|^2,     x = -sigma R^-1 Q^T b                                                 (2)

so that one factorisation serves every r. A `Fit` keeps the residual r(z) of its effects' parameters z and the
projected residual b - Q Q^T b. `diagnosis.estimator` makes fits. Source: variable projection [Golub2003].
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.linalg import LinAlgError

from flexarm.arrays import Floats
from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.nuisance import NuisanceModel
from flexarm.diagnosis.parameters import TransformedParameter
from flexarm.diagnosis.residual_rows import is_non_smooth
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.named_effects import Place

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


class Projection:
    """Residuals without what unknowns explain.

    Parameters
    ----------
    jacobian : ndarray, shape (n, k)
        J of (1).
    sigma : ndarray, shape (k,)
        Of the priors; infinite: none.
    """

    def __init__(self, jacobian: Floats, sigma: Floats) -> None:
        count = jacobian.shape[1]
        known = np.isfinite(sigma)
        norm = np.linalg.norm(jacobian, axis=0)
        self.scale = np.where(known, sigma, 1.0 / np.where(norm > 0, norm, 1.0))
        rows = np.vstack([jacobian * self.scale, np.diag(known.astype(float))])
        self.q, self.r = np.linalg.qr(rows)
        self.jacobian, self.sigma = jacobian, sigma
        self.added = count

    def project(self, residual: Floats) -> Floats:
        """b - Q Q^T b of (2), shape (n + k, ...): its square is C of (1)."""
        b = np.concatenate([residual, np.zeros((self.added, *residual.shape[1:]))])
        found: Floats = b - self.q @ (self.q.T @ b)
        return found

    def explained(self, columns: csr_matrix) -> Floats:
        """Q^T b of (2) for sparse residuals of shape (n, m): shape (k, m)."""
        return np.asarray((columns.T @ self.q[: columns.shape[0]]).T)

    def solve(self, residual: Floats) -> Floats:
        """x of (2), shape (k,)."""
        b = np.concatenate([residual, np.zeros(self.added)])
        found: Floats = -self.scale * np.linalg.lstsq(self.r, self.q.T @ b, rcond=None)[0]
        return found

    def solve_within(self, residual: Floats, reach: Floats) -> Floats:
        """x of (1) with |x| <= reach, shape (k,); infinite reach is no bound."""
        from scipy.optimize import lsq_linear

        b = np.concatenate([residual, np.zeros(self.added)])
        bound = reach / self.scale
        return np.asarray(self.scale * lsq_linear(self.r, -self.q.T @ b, (-bound, bound)).x)

    def covariance(self) -> Floats:
        """Of x, shape (k, k), if the residuals are white noise of size one."""
        inverse = np.linalg.pinv(self.r)
        scaled = self.scale[:, None] * inverse
        found: Floats = scaled @ scaled.T
        return found


FIT_ERRORS = (InvalidParameter, NotConverged, LinAlgError)
"""Where there is no fit: of models that cannot be simulated, and of least squares without a solution."""


@dataclass(frozen=True, eq=False)
class Fit:
    """A model with a set of effects, fitted.

    Attributes
    ----------
    members : tuple of Candidate
        The effects, each at its optimum.
    parameters, z : tuple of TransformedParameter and ndarray, shape (k,)
        What was fitted, in sigmas of the priors.
    residual : ndarray, shape (n,)
        Of that model, eq. (1) of `problem`.
    projected : ndarray, shape (n + m,)
        Of which clocks, frames and nominal values explain nothing more.
    jacobian : ndarray, shape (n, k)
        Derivatives of `residual` by z.
    nuisance, projection
        What was eliminated.
    """

    members: tuple[Candidate, ...]
    parameters: tuple[TransformedParameter, ...]
    z: Floats
    residual: Floats
    projected: Floats
    jacobian: Floats
    nuisance: NuisanceModel
    projection: Projection

    @property
    def cost(self) -> float:
        """C of (1)."""
        return float(self.projected @ self.projected)

    @property
    def non_smooth(self) -> bool:
        """Return True if some law of the model has corners."""
        return is_non_smooth(self.nuisance.arm) or not all(member.effect.smooth for member in self.members)

    @property
    def places(self) -> tuple[tuple[str, Place], ...]:
        """Name and place of each effect."""
        return tuple(member.place for member in self.members)

    @property
    def spots(self) -> frozenset[tuple[str, str]]:
        """Name and place of each effect, all places of a family."""
        return frozenset().union(*(member.spots for member in self.members))

    def key(self, k: int) -> tuple[str, Place, str]:
        """Name and place of the effect of coordinate k, and its parameter."""
        parameter = self.parameters[k]
        return (*self.members[parameter.candidate].place, parameter.name)
