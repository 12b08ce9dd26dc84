"""Metres and radians side by side: scales that make the freedoms of a super-element comparable."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.superelement.rigid_motion import PER_INTERFACE

if TYPE_CHECKING:
    from flexarm.superelement.element import SuperElement


def size_of(element: SuperElement) -> float:
    """Return the greatest distance of an interface from their centre [m], or else the radius of gyration."""
    middle = element.positions.mean(axis=0)
    size = float(np.linalg.norm(element.positions - middle, axis=1).max())
    return size or radius_of_gyration(element) or 1.0


def radius_of_gyration(element: SuperElement) -> float:
    """Return the radius of gyration [m], tr J = 2 m r^2; 0 without mass."""
    mass, trace = element.mass_total, float(np.trace(element.inertia))
    return float(np.sqrt(trace / (2 * mass))) if mass > 0 and trace > 0 else 0.0


def largest_of_kind(element: SuperElement, values: Floats) -> Floats:
    """Return for each freedom the largest value among those of its kind: translations, rotations, modes."""
    kind = np.append(np.tile([0] * 3 + [1] * 3, element.n_interfaces), np.full(element.n_modes, 2))
    largest = np.array([values[kind == k].max(initial=0.0) for k in range(3)])
    return np.asarray(largest[kind])


def unit_diagonal(element: SuperElement, matrix: Floats) -> Floats:
    """Scale the matrix to a diagonal of ones; freedoms whose entries are mere rounding stay small."""
    diagonal = np.diag(matrix)
    largest = largest_of_kind(element, np.abs(diagonal))
    if element.n_interfaces == 1:  # its block of K and C is rounding as a whole
        largest[:PER_INTERFACE] = np.maximum(largest[:PER_INTERFACE], np.abs(matrix).max(initial=0.0))
    scale = np.sqrt(np.maximum(diagonal, 1e-10 * largest))
    scale[scale == 0] = 1.0
    return np.asarray((matrix + matrix.T) / 2 / np.outer(scale, scale))
