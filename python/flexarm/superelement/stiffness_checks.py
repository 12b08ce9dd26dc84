r"""K of a part strains nothing in rigid motion, and resists every other motion.

With R the rigid motions, K R = 0. Numbers are rounded, so the question is how far every entry of K would have
to move for it to hold, relative to its size (the componentwise backward error of Oettli and Prager):

.. math:: \eta_i = \max_k \frac{|K R|_{ik}}{\sum_j |K_{ij}| \rho_j + s}                              (1)

with rotations about the middle of the interfaces; R of translations and rho of translational freedoms are the
part's size, so that all rows are moments, and rho is 1 for rotations and 0 for internal modes, which rigid
motion leaves at rest. Numbers of d digits make eta 10^-d; a freedom that is tied to the ground, or stands
where another should, makes it near one. The floor s keeps rows that are nothing but rounding from being
asked: 10^-4 of the largest row. With a single interface, which rigid motion is all that it can do, all rows
are such; there s is the part's inertia at its first natural frequency.

Source: W. Oettli and W. Prager, Numerische Mathematik 6, 1964, 405-409.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import Problem
from flexarm.superelement.rigid_motion import PER_INTERFACE, freedom, rigid_motions
from flexarm.superelement.scaling import size_of, unit_diagonal

if TYPE_CHECKING:
    from flexarm.superelement.element import SuperElement


def strained_by_rigid_motion(element: SuperElement, tolerance: float) -> Iterator[Problem]:
    """Report freedoms that violate K R = 0, the worst first."""
    named = 6  # how many freedoms a message names
    if element.n_interfaces == 1 and not element.n_modes:  # a rigid body: K is rounding, there is no scale
        return
    error = rigid_body_error(element)
    bad = np.flatnonzero(error > tolerance)
    if not len(bad):
        return
    worst = bad[np.argsort(-error[bad], kind="stable")][:named]
    places = "; ".join(f"{freedom(int(i), element.interfaces)} ({error[i]:.2g})" for i in worst)
    more = f" and {len(bad) - len(worst)} more" if len(bad) > len(worst) else ""
    yield Problem(
        "stiffness",
        f"rigid motion must strain nothing (K R = 0), but it meets forces at {places}{more}; allowed is "
        f"{tolerance:.2g} of the row. A freedom is tied to the ground, or the order of freedoms, positions, "
        "axes or unit are not those of the matrix",
    )


def rigid_body_error(element: SuperElement) -> Floats:
    """Return the relative error of K R = 0 in every freedom, eq. (1)."""
    size, held = size_of(element), PER_INTERFACE * element.n_interfaces
    middle = element.positions.mean(axis=0)
    motions = rigid_motions(element.positions, element.n_modes, middle) * ([size] * 3 + [1.0] * 3)
    to_moment = np.append(np.tile([size] * 3 + [1.0] * 3, element.n_interfaces), np.ones(element.n_modes))
    rho = np.where(np.arange(element.n_dof) < held, to_moment, 0.0)
    force = to_moment * np.abs(element.stiffness @ motions).max(axis=1)
    row = to_moment * (np.abs(element.stiffness) @ rho)
    floor = 1e-4 * float(row[:held].max())
    if element.n_interfaces == 1 and element.n_modes:
        inertia = float((to_moment * (np.abs(element.mass) @ rho))[:held].max())
        floor = max(floor, inertia * (2 * np.pi * float(element.frequency_hz.min())) ** 2)
    if floor == 0:
        return np.zeros(element.n_dof)
    return np.asarray(force / (row + floor), dtype=float)  # eq. (1)


def mechanisms(element: SuperElement, tolerance: float) -> Iterator[Problem]:
    """Report motions without stiffness beyond the six rigid ones: eigenvalues as small as rounding."""
    if element.n_interfaces == 1:
        return
    values, vectors = np.linalg.eigh(unit_diagonal(element, element.stiffness))
    rounding = 10 * max(float(np.abs(values[:6]).max()), 1e-14)
    loose = int(np.count_nonzero(values < rounding)) - 6
    if loose > 0 and rounding < 10 * tolerance * element.n_dof:  # else K R = 0 fails and says more
        where = freedom(int(np.abs(vectors[:, 6]).argmax()), element.interfaces)
        what = f"must resist all but the six rigid motions, got {loose} more without stiffness"
        yield Problem("stiffness", f"{what}, one mostly in {where}")
