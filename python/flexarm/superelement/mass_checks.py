r"""M of a part is the inertia of a body: R^T M R with R the rigid motions about the middle of the interfaces.

.. math:: R^T M R = \begin{pmatrix} m \, 1 & -m \tilde c \\ m \tilde c & J \end{pmatrix}             (1)

The mass is alike in all directions and couples none of them, the products of mass and centre are skew, and
the principal moments satisfy the triangle inequality. Freedoms in a wrong order break one of these.

A wrong unit leaves (1) as it is, and makes a density that nothing has. Mass over the cube of the radius of
gyration is 17 times the density of a solid ball and 2e-5 times that of a rod 1000 times as long as thick, so
for anything between foam and tungsten it lies within `DENSITY`. Millimetres and tonnes read as metres and
kilograms change it by 10^12. Where a unit was stated, such a density is refused; elsewhere, as for masses
lumped in a point, it is a doubt.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from flexarm.errors import Problem
from flexarm.superelement.rigid_motion import rigid_motions
from flexarm.superelement.scaling import radius_of_gyration, size_of

if TYPE_CHECKING:
    from flexarm.superelement.element import SuperElement


DENSITY = (1e-3, 1e7)
"""Mass over the cube of the radius of gyration [kg/m3]."""


def no_body(element: SuperElement, tolerance: float) -> Iterator[Problem]:
    """Report R^T M R that has not the form (1)."""
    total = element.mass_total
    if total < 0:
        yield Problem("mass", f"the part must not weigh less than nothing, got {total:.6g} kg")
        return
    motions = rigid_motions(element.positions, element.n_modes, element.positions.mean(axis=0))
    block = motions.T @ element.mass @ motions
    inertia = np.sqrt(np.abs(np.diag(block)))
    # A symmetric part has nothing but rounding where freedoms do not couple: its size is that of the inertia.
    summed = np.abs(motions).T @ np.abs(element.mass) @ np.abs(motions) + np.outer(inertia, inertia)
    allowed = 10 * tolerance * summed
    translation, coupling = block[:3, :3], block[:3, 3:]
    apart = np.abs(translation - total * np.eye(3)) > allowed[:3, :3]
    if np.diag(apart).any():
        seen = ", ".join(f"{m:.6g}" for m in np.diag(translation))
        what = f"must be the same in all directions, got {seen} kg along x, y, z"
        yield Problem("mass", f"{what}: freedoms are in another order, or one is missing")
    elif apart.any():
        what = "R^T M R must not couple translations in different directions, and it does"
        yield Problem("mass", f"{what}: freedoms are in another order")
    elif (np.abs(coupling + coupling.T) > allowed[:3, 3:] + allowed[:3, 3:].T).any():
        what = "R^T M R couples translations and rotations as no body does"
        yield Problem(
            "mass", f"{what}: freedoms are in another order, or positions are not those of the matrix"
        )
    else:
        yield from _impossible_inertia(element)


def _impossible_inertia(element: SuperElement) -> Iterator[Problem]:
    principal = np.linalg.eigvalsh((element.inertia + element.inertia.T) / 2)
    slack = 1e-3 * np.abs(principal).sum() + 1e-4 * element.mass_total * size_of(element) ** 2
    if principal[0] < -slack or principal[2] > principal[0] + principal[1] + slack:
        seen = ", ".join(f"{value:.4g}" for value in principal)
        yield Problem("mass", f"no body has the principal moments of inertia {seen} kg m2 about its centre")


def unlikely_density(element: SuperElement) -> Iterator[Problem]:
    """Report a density that no material has, as a wrong unit makes it."""
    gyration = radius_of_gyration(element)
    if gyration == 0:
        return
    density = element.mass_total / gyration**3
    if not DENSITY[0] <= density <= DENSITY[1]:
        yield Problem(
            "mass",
            f"{element.mass_total:.6g} kg with a radius of gyration of {gyration:.4g} m make {density:.2g} "
            f"kg/m3; allowed is {DENSITY[0]:g} to {DENSITY[1]:g}. The unit is not that of the matrices",
        )


def other_mass(element: SuperElement, stated: float | None) -> Iterator[Problem]:
    """Compare the mass with the stated one."""
    # Share by which the mass may differ from a stated one: a weighing, a mesh with facets for curves.
    stated_mass = 1e-3
    if stated is not None and not abs(element.mass_total - stated) <= stated_mass * abs(stated):
        what = f"R^T M R weighs {element.mass_total:.6g} kg, stated are {stated:.6g} kg"
        yield Problem("mass", f"{what}; they may differ by {100 * stated_mass:g} %")


def outside(element: SuperElement) -> Iterator[Problem]:
    """Report a centre far from all interfaces, which is possible and unlikely.

    A uniform bar held at one end has its centre sqrt(3) radii of gyration away from there.
    """
    if element.mass_total <= 0:
        yield Problem("mass", "the part weighs nothing")
        return
    gyration = radius_of_gyration(element)
    far = 2 * gyration
    low, high = element.positions.min(axis=0) - far, element.positions.max(axis=0) + far
    for k in np.flatnonzero((element.centre < low) | (element.centre > high)):
        yield Problem(
            "mass",
            f"the centre stands at {'xyz'[k]} = {element.centre[k]:.4g} m, farther from the box of the "
            f"interfaces than twice the radius of gyration, {gyration:.3g} m; are they of one frame with M?",
        )
