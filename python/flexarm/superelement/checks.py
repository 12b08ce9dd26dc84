"""Mechanical requirements on a reduced part, checked before its matrices are used.

A matrix of another program comes without coordinates, order of freedoms or unit; each of them stated wrongly
makes a part that swings and is wrong. K and M must therefore be positive semidefinite, K must annihilate the
rigid motions and nothing else (`stiffness_checks`), M must be the inertia of a body (`mass_checks`). Source:
R. R. Craig and A. J. Kurdila, Fundamentals of Structural Dynamics, 2006, chapter 17.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import Problem
from flexarm.superelement.mass_checks import no_body, other_mass, outside, unlikely_density
from flexarm.superelement.rigid_motion import PER_INTERFACE, freedom, rigid_motions
from flexarm.superelement.scaling import largest_of_kind, size_of, unit_diagonal
from flexarm.superelement.stiffness_checks import mechanisms, strained_by_rigid_motion

if TYPE_CHECKING:
    from flexarm.superelement.element import SuperElement

TOLERANCE = 1e-5
"""Relative error that an entry of a matrix may have: files with six digits pass."""


STATED_ORDER = "stated"
"""Words of a provenance whose file did not hold the order of the freedoms."""


def violations(element: SuperElement, mass: float | None, tolerance: float) -> list[Problem]:
    """Return everything that no elastic part could have; empty if there is nothing."""
    return [
        *strained_by_rigid_motion(element, tolerance),
        *_not_definite(element, tolerance),
        *mechanisms(element, tolerance),
        *no_body(element, tolerance),
        *other_mass(element, mass),
    ]


def implausible_values(element: SuperElement) -> list[Problem]:
    """Return what is allowed and yet looks wrong."""
    return [
        *outside(element),
        *unlikely_density(element),
        *_other_frequencies(element),
        *_other_load(element),
        *_damped_rigid_motion(element),
        *_one_place(element),
    ]


def _not_definite(element: SuperElement, tolerance: float) -> Iterator[Problem]:
    for name in ("stiffness", "mass", "damping"):
        matrix: Floats = getattr(element, name)
        diagonal = np.diag(matrix)
        negative = np.flatnonzero(diagonal < -tolerance * largest_of_kind(element, np.abs(diagonal)))
        if len(negative):
            i = int(negative[0])
            where = freedom(i, element.interfaces)
            what = f"the diagonal must not be negative, got {diagonal[i]:.6g} at [{i}, {i}] ({where})"
            yield Problem(name, what)
            continue
        values, vectors = np.linalg.eigh(unit_diagonal(element, matrix))
        if values[0] < -tolerance * element.n_dof:
            where = freedom(int(np.abs(vectors[:, 0]).argmax()), element.interfaces)
            what = (
                f"must be positive semidefinite, got the eigenvalue {values[0]:.3g} (diagonal scaled to one)"
            )
            yield Problem(name, f"{what}, mostly in {where}")


def _other_frequencies(element: SuperElement) -> Iterator[Problem]:
    """Compare the internal block with the stated frequencies and those possible for its size."""
    if not element.n_modes:
        return
    inner = slice(PER_INTERFACE * element.n_interfaces, None)
    M, K = element.mass[inner, inner], element.stiffness[inner, inner]
    try:
        half = np.linalg.inv(np.linalg.cholesky(M))
    except np.linalg.LinAlgError:
        yield Problem("mass", "some internal mode has no mass of its own")
        return
    found = np.sqrt(np.maximum(np.linalg.eigvalsh(half @ K @ half.T), 0)) / (2 * np.pi)
    stated = np.sort(element.frequency_hz)
    off = np.abs(found - stated) / stated
    if off.max() > 1e-3:
        i = int(off.argmax())
        what = f"says {stated[i]:.6g} Hz for mode {i + 1}, the matrices {found[i]:.6g} Hz"
        yield Problem("frequency_hz", what)
    lowest, size = float(found[0]), size_of(element)
    if lowest < 0.01 or lowest * size > 1e5:  # sound runs 6000 m/s in steel and crosses a part once a period
        what = f"a first internal mode of {lowest:.4g} Hz is unlikely for a part of {size:.3g} m"
        yield Problem("frequency_hz", what)


def _other_load(element: SuperElement) -> Iterator[Problem]:
    """Compare the inertia load with M R_t."""
    expected = element.mass @ rigid_motions(element.positions, element.n_modes)[:, :3]
    scale = largest_of_kind(element, np.abs(expected).max(axis=1))[:, None]
    off = np.abs(element.inertia_load - expected) - 1e-3 * scale - 1e-12 * np.abs(expected).max()
    if off.max() > 0:
        i, k = (int(j) for j in np.unravel_index(off.argmax(), off.shape))
        where = f"{freedom(i, element.interfaces)} for acceleration along {'xyz'[k]}"
        what = (
            f"must be M R_t, which is {expected[i, k]:.6g} at {where}; got {element.inertia_load[i, k]:.6g}"
        )
        yield Problem("inertia_load", what)


def _damped_rigid_motion(element: SuperElement) -> Iterator[Problem]:
    """Report damping of rigid motion."""
    force = np.abs(element.damping @ rigid_motions(element.positions, element.n_modes)).max(axis=1)
    if force.max() > 1e-3 * np.abs(element.damping).max():
        where = freedom(int(force.argmax()), element.interfaces)
        yield Problem("damping", f"resists rigid motion, most at {where}; it should not")


def _one_place(element: SuperElement) -> Iterator[Problem]:
    """Report interfaces at one place: they move alike in rigid motion, so that no check tells them apart."""
    if element.provenance.get("order_of_source") != STATED_ORDER:
        return
    for i, j in combinations(range(element.n_interfaces), 2):
        if np.linalg.norm(element.positions[i] - element.positions[j]) < 1e-6 * size_of(element):
            names = f"{element.interfaces[i]!r} and {element.interfaces[j]!r}"
            what = (
                f"{names} stand at one place; no check can tell which is which, the stated order alone does"
            )
            yield Problem("order", what)
