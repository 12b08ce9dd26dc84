"""The form that super-element data have, whatever the part: shapes, finite numbers, symmetry, names, axes.

What mechanics demands of the numbers is in `checks`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import Problem
from flexarm.superelement.rigid_motion import PER_INTERFACE, freedom
from flexarm.tables.table import check_label

if TYPE_CHECKING:
    from flexarm.superelement.element import SuperElement


HUGE = 1e30
"""No entry is as large: moduli end at 1e18 Pa, lengths at 1e10 m (`flexarm.tables.ranges`). The largest entry
of a matrix is not as small as its inverse, but in a matrix of zeros."""

VARIABLES = {
    "positions": ("interface_position", ("interface", "axis"), "m"),
    "rotations": ("interface_rotation", ("interface", "axis", "interface_axis"), "1"),
    "stiffness": ("stiffness", ("dof", "dof"), "N/m, N, N m"),
    "mass": ("mass", ("dof", "dof"), "kg, kg m, kg m2"),
    "damping": ("damping", ("dof", "dof"), "N s/m, N s, N m s"),
    "frequency_hz": ("frequency_hz", ("mode",), "Hz"),
    "inertia_load": ("inertia_load", ("dof", "axis"), "kg, kg m"),
}
"""Field of the data class -> variable in a file, which problems name, its dimensions and unit."""


def problems_of_shape(element: SuperElement) -> list[Problem]:
    """Return everything that keeps the data from being a super-element; empty if nothing does."""
    names = list(_names(element.interfaces))
    sizes = list(_sizes(element))
    if names or sizes:
        return names + sizes
    finite = list(_not_finite(element))
    if finite:
        return finite
    return [*_frames(element), *_asymmetry(element), *_frequencies(element.frequency_hz)]


def _names(interfaces: tuple[str, ...]) -> Iterator[Problem]:
    if not interfaces:
        yield Problem("interface_name", "there must be at least one interface, got none")
    for i, name in enumerate(interfaces):
        if not name:
            yield Problem("interface_name", f"interface {i + 1} has no name")
            continue
        try:
            check_label(name)
        except ValueError as error:
            yield Problem("interface_name", str(error))
        if name in interfaces[:i]:
            yield Problem("interface_name", f"{name!r} is given twice; names must differ")


def _sizes(element: SuperElement) -> Iterator[Problem]:
    n, modes = len(element.interfaces), element.frequency_hz.size
    dof = PER_INTERFACE * n + modes
    because = f"{n} interfaces with 6 freedoms and {modes} modes"
    size = {"interface": n, "axis": 3, "interface_axis": 3, "dof": dof, "mode": modes}
    for field, (variable, dimensions, _) in VARIABLES.items():
        shape, found = tuple(size[d] for d in dimensions), getattr(element, field).shape
        if found != shape:
            yield Problem(variable, f"must have the shape {shape} for {because}, got {found}")
    recovery = element.recovery
    if recovery is not None and (recovery.ndim != 2 or recovery.shape[1] != dof or recovery.shape[0] % 3):
        yield Problem("recovery", f"must have the shape (3 n_points, {dof}), got {recovery.shape}")


def _not_finite(element: SuperElement) -> Iterator[Problem]:
    for field, variable in [*((field, row[0]) for field, row in VARIABLES.items()), ("recovery", "recovery")]:
        values: Any = getattr(element, field)
        if values is None:
            continue
        bad = np.argwhere(~(np.abs(values) < HUGE))
        if len(bad):
            at = tuple(int(i) for i in bad[0])
            count = f" and {len(bad) - 1} more" if len(bad) > 1 else ""
            what = f"must be finite and below {HUGE:g}, got {values[at]} at {list(at)}{count}"
            yield Problem(variable, what)
        elif field in ("stiffness", "mass", "damping") and 0 < np.abs(values).max() < 1 / HUGE:
            what = f"must have an entry above {1 / HUGE:g}, got {np.abs(values).max():.3g} at most"
            yield Problem(variable, what)


def _frames(element: SuperElement) -> Iterator[Problem]:
    orthonormal = 1e-6  # how far R^T R may be from 1: frames printed with seven digits pass
    for name, rotation in zip(element.interfaces, element.rotations, strict=True):
        off = float(np.abs(rotation.T @ rotation - np.eye(3)).max())
        if off > orthonormal:
            what = f"the axes of {name!r} must be orthonormal, got R^T R off by {off:.3g}"
            yield Problem("interface_rotation", what)
        elif np.linalg.det(rotation) < 0:
            yield Problem("interface_rotation", f"the axes of {name!r} must be right-handed, got left-handed")


def _asymmetry(element: SuperElement) -> Iterator[Problem]:
    for field in ("stiffness", "mass", "damping"):
        matrix: Floats = getattr(element, field)
        place = asymmetric_entry(matrix)
        if place:
            i, j = place
            places = f"[{i}, {j}] ({freedom(i, element.interfaces)}; {freedom(j, element.interfaces)})"
            what = f"must be symmetric, got {matrix[i, j]:.8g} at {places} and {matrix[j, i]:.8g} across"
            yield Problem(field, what)


def asymmetric_entry(matrix: Floats) -> tuple[int, int] | None:
    """Return the place where a matrix is most asymmetric, or None if it is symmetric to rounding."""
    # Part of sqrt(a_ii a_jj) by which a_ij and a_ji may differ: single precision is good to 1e-7.
    symmetry = 1e-6
    scale = np.sqrt(np.abs(np.diag(matrix)))
    rounding = 1e-4 * np.abs(matrix).max(initial=0)  # where a row is nothing else
    off = np.abs(matrix - matrix.T) - symmetry * np.maximum(np.outer(scale, scale), rounding)
    if not (off > 0).any():
        return None
    i, j = np.unravel_index(off.argmax(), off.shape)
    return int(i), int(j)


def _frequencies(frequency_hz: Floats) -> Iterator[Problem]:
    for i, value in enumerate(frequency_hz):
        if value <= 0:
            yield Problem("frequency_hz", f"must be positive, got {value:g} Hz for mode {i + 1}")
