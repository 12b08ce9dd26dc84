"""A model with effects that were fitted, and what was eliminated along.

    residual = r(z),    rest = what clocks, frames and nominal values leave of it,    C = |rest|^2     (1)

`fitting.fitter` makes fits, `projection` says what is left.
"""

from __future__ import annotations

from dataclasses import dataclass

from numpy.linalg import LinAlgError

from flexarm.arrays import Floats
from flexarm.diagnosis.candidates.candidate import Candidate
from flexarm.diagnosis.fitting.coordinate import Coordinate
from flexarm.diagnosis.fitting.projection import Projection
from flexarm.diagnosis.fitting.unknowns import Unknowns
from flexarm.diagnosis.residuals.corners import CORNERS, has_corners
from flexarm.errors import InvalidParameter, NotConverged

FAILED = (InvalidParameter, NotConverged, LinAlgError)
"""Where there is no fit: of models that cannot be simulated, and of least squares without a solution."""


@dataclass(frozen=True, eq=False)
class Fit:
    """A model with a set of effects, fitted.

    Attributes
    ----------
    members : tuple of Candidate
        The effects, each at its optimum.
    coordinates, z : tuple of Coordinate and ndarray, shape (k,)
        What was fitted, in sigmas of the priors.
    residual : ndarray, shape (n,)
        Of that model, eq. (1) of `observed`.
    rest : ndarray, shape (n + m,)
        Of which clocks, frames and nominal values explain nothing more.
    slopes : ndarray, shape (n, k)
        Derivatives of `residual` by z.
    unknowns, projection
        What was eliminated.
    """

    members: tuple[Candidate, ...]
    coordinates: tuple[Coordinate, ...]
    z: Floats
    residual: Floats
    rest: Floats
    slopes: Floats
    unknowns: Unknowns
    projection: Projection

    @property
    def cost(self) -> float:
        """C of (1)."""
        return float(self.rest @ self.rest)

    @property
    def has_corners(self) -> bool:
        """Whether some law of the model has corners."""
        return has_corners(self.unknowns.arm) or any(member.name in CORNERS for member in self.members)

    @property
    def places(self) -> tuple[tuple[str, str], ...]:
        """Name and place of each effect."""
        return tuple(member.place for member in self.members)

    def key(self, k: int) -> tuple[str, str, str]:
        """Name and place of the effect of coordinate k, and its parameter."""
        coordinate = self.coordinates[k]
        return (*self.members[coordinate.candidate].place, coordinate.name)
