"""Place and deformation of a super-element in an equilibrium."""

from __future__ import annotations

from dataclasses import dataclass

from flexarm.arrays import Floats


@dataclass(frozen=True, eq=False)
class PartShape:
    """Where a super-element is, and how it is deformed."""

    rotation: Floats
    position: Floats
    """The part's frame in the base, fixed to its first interface; position in m."""
    freedoms: Floats
    """Displacements in that frame, in the freedoms of the super-element: of each interface three translations
    [m] and three rotations [rad], then its modes. `SuperElement.recovery` turns them into the mesh's, shape
    (dof,)."""
