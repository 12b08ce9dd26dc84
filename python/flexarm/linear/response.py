r"""State equations in which derivatives of inputs appear, and how they become proper ones.

.. math:: x' = A x + B_0 u + B_1 u' + B_2 u'',   y = C x + D_0 u + D_1 u' + D_2 u''               (1)

A prescribed angle acts by inertia (its second derivative), by dampers (its first) and by springs. With the
states s = x - (B_1 + A B_2) u - B_2 u' the derivatives leave the first of (1):

.. math:: s' = A s + (B_0 + A B_1 + A^2 B_2) u                                                     (2)
.. math:: y = C s + [D_0 + C (B_1 + A B_2)] u + (D_1 + C B_2) u' + D_2 u''                         (3)

The response is proper where the factors of u' and u'' in (3) are zero. Where they are not, an output follows
an acceleration of the drive at once; then the acceleration is the input, angle and rate u, u' become states:

.. math:: (x, u, u')' = [A, B_0, B_1; 0, 0, 1; 0, 0, 0] (x, u, u') + (B_2; 0; 1) u''                (4)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats


@dataclass(frozen=True, eq=False)
class Response:
    """Equation (1): A (states, states), C (outputs, states), and factors of the inputs and two derivatives.

    B and D have the shapes (3, states, inputs) and (3, outputs, inputs); `size` is the sum of the sizes of
    the summands of D.
    """

    A: Floats
    B: Floats
    C: Floats
    D: Floats
    size: Floats

    def improper(self) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        """Return True where (3) has derivatives of input k in output i: shape (outputs, inputs)."""
        rounding = 1e-9  # beside its summands, a factor of (3) below this is zero
        first = self.D[1] + self.C @ self.B[2]
        size = self.size[1] + np.abs(self.C) @ np.abs(self.B[2])
        second = np.abs(self.D[2]) > rounding * self.size[2]
        return np.asarray((np.abs(first) > rounding * size) | second)

    def by_acceleration(self, chosen: list[int]) -> Response:
        """Return (4): second derivatives of these inputs as inputs, values and rates as the last states."""
        k, n = len(chosen), len(self.A)
        if k == 0:
            return self
        B, D = self.B.copy(), self.D.copy()
        A = np.zeros((n + 2 * k, n + 2 * k))
        A[:n, :n] = self.A
        A[:n, n : n + k], A[:n, n + k :] = B[0][:, chosen], B[1][:, chosen]
        A[n : n + k, n + k :] = np.eye(k)
        C = np.hstack([self.C, D[0][:, chosen], D[1][:, chosen]])
        last, direct = B[2][:, chosen].copy(), D[2][:, chosen].copy()
        B[:, :, chosen], D[:, :, chosen] = 0, 0
        B = np.concatenate([B, np.zeros((3, 2 * k, B.shape[2]))], axis=1)
        B[0][:n, chosen], D[0][:, chosen] = last, direct
        B[0][n + k + np.arange(k), chosen] = 1
        return Response(A, B, C, D, self.size)

    def proper(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Return A, B, C, D of (2), (3), without the factors of u' and u''."""
        moved = self.B[1] + self.A @ self.B[2]
        return self.A, self.B[0] + self.A @ moved, self.C, self.D[0] + self.C @ moved
