r"""Known shapes of a curve: which one is closest, and its sizes.

.. math:: f(x) \approx \sum_i a_i g_i(x; b), \qquad
          \mathrm{BIC} = \chi^2 + k \ln M                                                               (1)

g are the functions of a shape, a its linear parameters by generalised least squares with the covariance of
the curve's M values, b one non-linear parameter, found on a grid. The shape of the least BIC is told if it
misses the curve by less than a part of its peak. Source: [Schwarz1978].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats
from flexarm.missing_law.policy import LawPolicy
from flexarm.wording import with_unit

CONSTANT = "is constant"
Functions = Callable[[Floats, float], list[Floats]]


@dataclass(frozen=True)
class Shape:
    """A family of curves: `functions` of x and b, and the grid of b, over max |x| if it is `of_x`.

    `only` holds the states that it is sought for; all if empty.
    """

    name: str
    functions: Functions
    grid: tuple[float, ...] = (1.0,)
    word: str = ""
    of_x: bool = True
    only: tuple[str, ...] = ()


def _one(x: Floats) -> Floats:
    return np.ones_like(x)


_WIDTHS = tuple(np.geomspace(0.03, 1.0, 30).tolist())
_PLACES = tuple(np.linspace(-0.9, 0.9, 37).tolist())

SHAPES = (
    Shape("linear", lambda x, b: [_one(x), x]),
    Shape("quadratic", lambda x, b: [_one(x), x, x**2]),
    Shape("cubic", lambda x, b: [_one(x), x, x**3]),
    Shape("dead zone", lambda x, b: [_one(x), np.sign(x) * np.maximum(np.abs(x) - b, 0)], _WIDTHS, "beyond"),
    Shape("sign", lambda x, b: [_one(x), np.tanh(x / (0.02 * b))]),
    Shape(
        "Stribeck",
        lambda x, b: [_one(x), np.tanh(x / (0.1 * b)), np.tanh(x / (0.1 * b)) * np.exp(-((x / b) ** 2)), x],
        _WIDTHS,
        "with the rate",
        only=("rate",),
    ),
    Shape("saturation", lambda x, b: [_one(x), np.tanh(x / b)], _WIDTHS, "with the width"),
    Shape("step", lambda x, b: [_one(x), np.tanh((x - b) / (0.02 * np.abs(x).max()))], _PLACES, "at"),
    Shape("exponential", lambda x, b: [_one(x), np.exp(x / b)], (*_WIDTHS, *(-w for w in _WIDTHS)), "over"),
    Shape(
        "sine",
        lambda x, b: [_one(x), np.sin(b * x), np.cos(b * x)],
        tuple(float(k) for k in range(1, 13)),
        "of order",
        False,
        ("angle", "motor_angle"),
    ),
)


def is_constant(value: Floats, policy: LawPolicy) -> bool:
    """Return True if a curve varies less about its mean than a known shape may miss it by."""
    mean = float(np.mean(value))
    return float(np.std(value)) <= policy.shape_error * abs(mean)


def closest_shape(
    x: Floats, value: Floats, covariance: Floats, policy: LawPolicy, unit: str, of: str, of_unit: str
) -> str:
    """Return words such as "is linear: 2.1e-06 rad per N m", or that no known shape is close."""
    if is_constant(value, policy):
        return CONSTANT
    peak = float(np.abs(value - np.median(value)).max())
    if peak == 0:
        return "is zero"
    scaled = covariance + (policy.shape_scatter * peak) ** 2 * np.eye(len(x))
    weight = np.linalg.inv(np.linalg.cholesky(scaled))
    reach = float(np.abs(x).max())
    found = []
    for shape in SHAPES:
        if shape.only and of.partition(" of ")[0] not in shape.only:
            continue
        for b in shape.grid:
            size = b * reach if shape.of_x else b
            design = np.stack(shape.functions(x, size), axis=1)
            a, *_ = np.linalg.lstsq(weight @ design, weight @ value, rcond=None)
            rest = value - design @ a
            count = design.shape[1] + (len(shape.grid) > 1)
            bic = float(np.sum((weight @ rest) ** 2)) + count * np.log(len(x))  # eq. (1)
            found.append((bic, shape, size, a, float(np.sqrt(np.mean(rest**2))) / peak))
    _, shape, size, a, error = min(found, key=lambda each: each[0])
    if error > policy.shape_error:
        at = float(x[int(np.argmax(np.abs(value - np.median(value))))])
        return f"has none of the known shapes, and its peak at {with_unit(at, of_unit, 3)}"
    if shape.name == "linear":
        return f"is linear: {a[1]:.3g} {unit} per {of_unit}"
    where = ""
    if shape.word:
        where = f" {shape.word} {size:.3g}" + (f" {of_unit}" if shape.of_x else "")
    return f"is like a {shape.name}{where}"
