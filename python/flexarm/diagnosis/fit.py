r"""A fitted model, the projection that eliminates its nuisance parameters, and its normal equations.

    C(r) = min over x of |r + J x|^2 + |x/sigma|^2                                                    (1)

r are residuals over their noise, J their Jacobian with respect to nuisance parameters x, counted from the
centres of their priors. With A = [J sigma; 1] = Q R and b = [r; 0],

    C(r) = |b - Q Q^T b|^2,     x = -sigma R^-1 Q^T b                                                 (2)

so that one factorisation serves every r. A `Fit` keeps the residual r(z) of its effects' parameters z and the
projected residual b - Q Q^T b. `diagnosis.estimator` makes fits. Source: variable projection [Golub2003].

The normal equations of all parameters are

    H = J^T W J + Lambda,     x = -H^-1 g                                                            (3)

with weights W of the rows and Lambda of the priors. Parameters differ by powers of ten, so H is kept scaled
to a unit diagonal, S H S. Eigenvectors of small eigenvalues are directions that neither data nor priors
determine; they have no inverse.

Fits weight rows by their stated noise. Where a gap stays, that is far too much, and values run many sigmas
from their priors. With the covariance C of noise and discrepancy, the evidence is greatest where

.. math:: (r + J_z \Delta z + J_x x)^T W (r + J_z \Delta z + J_x x) + |x/\sigma|^2
          + |\rho + \rho' \Delta z|^2                                                                (4)

with W = C^-1 is least (generalised least squares). z are the effects' parameters, rho the rows of their
priors (`diagnosis.candidate`). The step taken is that of (4) less that of (4) with W = 1, so that a fit that
leaves only noise stays where it is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.linalg import LinAlgError
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.diagnosis.candidate import Candidate, TransformedParameter, prior_rows
from flexarm.diagnosis.nuisance import NuisanceModel
from flexarm.diagnosis.policy import FIT
from flexarm.diagnosis.residual_rows import is_non_smooth
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.named_effects import Place

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


class Projection:
    """Projection of residuals orthogonal to nuisance parameters.

    `jacobian` (n, k) is J of (1), `sigma` (k,) that of the priors, infinite without a prior.
    """

    def __init__(self, jacobian: Floats, sigma: Floats) -> None:
        known = np.isfinite(sigma)
        norm = np.linalg.norm(jacobian, axis=0)
        self.scale = np.where(known, sigma, 1.0 / np.where(norm > 0, norm, 1.0))
        rows = np.vstack([jacobian * self.scale, np.diag(known.astype(float))])
        self.q, self.r = np.linalg.qr(rows)
        self.jacobian, self.sigma = jacobian, sigma
        self.added = jacobian.shape[1]

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
        """Return the covariance of x for residuals of unit white noise, shape (k, k)."""
        inverse = np.linalg.pinv(self.r)
        scaled = self.scale[:, None] * inverse
        found: Floats = scaled @ scaled.T
        return found


FIT_ERRORS = (InvalidParameter, NotConverged, LinAlgError)
"""Errors of models that cannot be simulated, and of least squares without a solution."""


@dataclass(frozen=True, eq=False)
class Fit:
    """A fitted model with a set of effects."""

    members: tuple[Candidate, ...]
    """The effects, each at its optimum."""
    parameters: tuple[TransformedParameter, ...]
    z: Floats
    """The fitted parameters, in sigmas of their priors. Shape (k,)."""
    residual: Floats
    """Residual of that model, eq. (1) of `problem`, shape (n,)."""
    projected: Floats
    """The residual projected orthogonally to nuisance parameters. Shape (n + m,)."""
    jacobian: Floats
    """Derivatives of `residual` by z. Shape (n, k)."""
    nuisance: NuisanceModel
    projection: Projection
    """The eliminated nuisance parameters, and their projection."""

    @property
    def cost(self) -> float:
        """C of (1)."""
        return float(self.projected @ self.projected)

    @property
    def non_smooth(self) -> bool:
        """Return True if some law of the model is non-smooth."""
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


@dataclass(frozen=True)
class NormalEquations:
    """H of (3): `hessian` is S H S, `scale` the diagonal of S, `unknown` as `FIT.undetermined`."""

    hessian: Floats
    scale: Floats
    unknown: float = FIT.undetermined

    @classmethod
    def of(
        cls, jacobian: Floats, prior: Floats, weight: Floats | None = None, unknown: float = FIT.undetermined
    ) -> NormalEquations:
        """From J of shape (n, m), Lambda or its diagonal, and the diagonal of W, all ones if not given."""
        held = prior if prior.ndim == 2 else np.diag(prior)
        weighted = jacobian if weight is None else weight[:, None] * jacobian
        scale = 1.0 / np.sqrt(np.maximum(np.sum(jacobian * weighted, axis=0) + np.diag(held), 1e-300))
        hessian = (jacobian * scale).T @ (weighted * scale) + held * np.outer(scale, scale)
        return cls(hessian, scale, unknown)

    def without(self, jacobian: Floats) -> NormalEquations:
        """Return the same less rows of which these are J."""
        own = jacobian * self.scale
        return NormalEquations(self.hessian - own.T @ own, self.scale, FIT.undetermined_after)

    def solved(self, gradient: Floats) -> Floats:
        """H^-1 times vectors of shape (m, ...)."""
        root = self.root()
        return root @ (root.T @ gradient)

    def inverse(self) -> Floats:
        """H^-1."""
        root = self.root()
        return root @ root.T

    def root(self) -> Floats:
        """R of H^-1 = R R^T."""
        values, vectors = np.linalg.eigh(self.hessian)
        known: NDArray[np.bool_] = values > self.unknown * values.max(initial=0.0)
        found: Floats = self.scale[:, None] * vectors[:, known] / np.sqrt(values[known])
        return found


def joint_jacobian(fit: Fit) -> tuple[Floats, Floats, Floats]:
    """Return J, the projected residuals, and the diagonal of Lambda, at the optimum of a fit."""
    x = fit.projection.solve(fit.residual)
    jacobian = np.column_stack([fit.jacobian, fit.projection.jacobian])
    residual = fit.residual + fit.projection.jacobian @ x
    held = [c.held**2 for c in fit.parameters]
    return jacobian, residual, np.concatenate([held, 1.0 / fit.projection.sigma**2])


def gls_step(fit: Fit, jacobian: Floats, residual: Floats) -> Floats:
    """Return dz and dx from a fit to the optimum of (4), from whitened derivatives and residual."""
    plain = np.column_stack([fit.jacobian, fit.projection.jacobian])
    return _least(fit, jacobian, residual) - _least(fit, plain, fit.residual)


def gls_nuisance(fit: Fit) -> Floats:
    """Return x of a fit, shape (m,), with rows weighted by the mean square of the residual."""
    root = 1.0 / np.sqrt(max(1.0, fit.cost / len(fit.residual)))
    jacobian = np.column_stack([fit.jacobian, fit.projection.jacobian])
    step = gls_step(fit, root * jacobian, root * fit.residual)
    return fit.projection.solve(fit.residual) + step[len(fit.z) :]


def _least(fit: Fit, jacobian: Floats, residual: Floats) -> Floats:
    """Return dz and x where (4) is least."""
    rows, bends = prior_rows(fit.parameters, fit.z)
    held = np.concatenate([bends**2, 1.0 / fit.projection.sigma**2])
    pull = np.concatenate([bends * rows, np.zeros_like(fit.projection.sigma)])
    return -NormalEquations.of(jacobian, held, unknown=FIT.undetermined_weighted).solved(
        jacobian.T @ residual + pull
    )


def posterior_covariance(fit: Fit) -> Floats:
    """Return the covariance of z and x, with rows weighted by the mean square of the residual."""
    jacobian, _, prior = joint_jacobian(fit)
    weight = np.full(len(jacobian), min(1.0, len(fit.residual) / max(fit.cost, 1e-300)))
    return NormalEquations.of(jacobian, prior, weight).inverse()
