r"""Inertia tensors: three or six numbers, about the body's own centre.

The matrix J has Ixx, Iyy, Izz on its diagonal and Ixy, Ixz, Iyz beside it, as in URDF: Ixy = -\int x y dm.
A body of positive mass has

.. math:: \Sigma = \tfrac12 \operatorname{tr}(J) \, 1 - J = \int r r^T dm \succeq 0                  (1)

which says at once that J is positive semidefinite and that its principal values satisfy the triangle
inequality.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator

from flexarm.tables import Number, to_python

Matrix = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]


def _three_or_six(value: Any) -> Any:
    value = to_python(value)
    if not isinstance(value, list | tuple) or len(value) not in (3, 6):
        raise ValueError(f"must be [Ixx, Iyy, Izz] or [Ixx, Iyy, Izz, Ixy, Ixz, Iyz] [kg m2], got {value!r}")
    return tuple(value)


Inertia = Annotated[tuple[Number, ...], BeforeValidator(_three_or_six)]


def inertia_matrix(inertia: tuple[float, ...]) -> Matrix:
    """Return the tensor as a matrix [kg m2]."""
    xx, yy, zz, xy, xz, yz = (*inertia, 0.0, 0.0, 0.0)[:6]
    return (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)


def impossible(inertia: tuple[float, ...]) -> str | None:
    """Return why no body has this inertia, or None if one has."""
    rounding = 1e-3  # share of the trace by which (1) may be missed: tables print inertias to three digits
    xx, yy, zz, xy, xz, yz = (*inertia, 0.0, 0.0, 0.0)[:6]
    if min(xx, yy, zz) < 0:
        return f"moments of inertia must not be negative, got {list(inertia)} kg m2"
    trace = xx + yy + zz
    slack = rounding * trace
    a, b, c = trace / 2 - xx + slack, trace / 2 - yy + slack, trace / 2 - zz + slack  # diagonal of (1)
    if min(a, b, c) < 0:
        return f"no body has these moments: none may exceed the sum of the others, got {list(inertia)} kg m2"
    determinant = a * (b * c - yz * yz) + xy * (-xy * c - yz * xz) - xz * (xy * yz + b * xz)
    minors = (a * b - xy * xy, a * c - xz * xz, b * c - yz * yz)
    if min(minors) < 0 or determinant < -1e-9 * trace**3:
        return f"no body has these products of inertia: they are too large, got {list(inertia)} kg m2"
    return None
