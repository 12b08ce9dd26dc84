r"""Dual numbers: values that carry their derivatives, for laws that are written for numbers.

.. math:: (u, du) \pm (v, dv) = (u \pm v, \; du \pm dv), \quad
          (u, du)(v, dv) = (u v, \; v \, du + u \, dv), \quad 1/(v, dv) = (1/v, \; -dv/v^2)          (1)

A law computed with them gives its derivatives with its value. They compare by their values, so a law takes
the branch that it takes without them, and a limit passes on the derivative of the side on which it is
[Griewank2008]_.

References
----------
.. [Griewank2008] A. Griewank, A. Walther, "Evaluating Derivatives", 2nd ed., SIAM, 2008, chapter 3.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import numpy as np

from flexarm.arrays import Floats


class Dual:
    """A number and its derivatives, shape (parameter,)."""

    __slots__ = ("slopes", "value")
    __array_ufunc__ = None  # numbers of NumPy leave operations with it to it
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, value: float, slopes: Floats) -> None:
        self.value = value
        self.slopes = slopes

    def __add__(self, other: Real) -> Dual:
        if isinstance(other, Dual):
            return Dual(self.value + other.value, self.slopes + other.slopes)
        return Dual(self.value + other, self.slopes)

    __radd__ = __add__

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.slopes)

    def __sub__(self, other: Real) -> Dual:
        return self + -other

    def __rsub__(self, other: float) -> Dual:
        return Dual(other - self.value, -self.slopes)

    def __mul__(self, other: Real) -> Dual:
        if isinstance(other, Dual):
            return Dual(self.value * other.value, other.value * self.slopes + self.value * other.slopes)
        return Dual(self.value * other, other * self.slopes)

    __rmul__ = __mul__

    def __truediv__(self, other: Real) -> Dual:
        if isinstance(other, Dual):
            return self * (1.0 / other)
        return Dual(self.value / other, self.slopes / other)

    def __rtruediv__(self, other: float) -> Dual:
        return Dual(other / self.value, -other / self.value**2 * self.slopes)  # eq. (1)

    def __eq__(self, other: object) -> bool:
        return self.value == (other.value if isinstance(other, Dual) else other)

    def __lt__(self, other: Real) -> bool:
        return self.value < value_of(other)

    def __gt__(self, other: Real) -> bool:
        return self.value > value_of(other)

    def __repr__(self) -> str:
        return f"Dual({self.value:g}, {self.slopes})"


Real = float | Dual
"""Numbers of control laws."""


def value_of(number: Real) -> float:
    """Return the number without its derivatives."""
    return number.value if isinstance(number, Dual) else number


def slopes_of(number: Real, count: int) -> Floats:
    """Return its derivatives with respect to `count` parameters; zeros of a plain number."""
    return number.slopes if isinstance(number, Dual) else np.zeros(count)


def between(value: float, pairs: Sequence[tuple[float, float]], spreads: Sequence[float]) -> Real:
    """Return a number with its derivatives by finite differences; an infinite one has none.

    For each parameter a pair is what the number is with a little more and a little less of it, and a spread
    by how much the two values of the parameter differ.
    """
    if not isfinite(value) or all(plus == minus for plus, minus in pairs):
        return value
    return Dual(
        value,
        np.array([(plus - minus) / spread for (plus, minus), spread in zip(pairs, spreads, strict=True)]),
    )
