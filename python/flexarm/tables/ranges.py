"""Physical ranges of numbers: one row a unit, within which no product that flexarm forms can overflow.

Each range is many orders of magnitude wider than what machines have, so that it refuses typing errors and
damaged files and nothing else. Lengths go from an atom to coordinates of maps, in millimetres for metres;
areas and moments of area are their powers; the others follow from materials and machines of such sizes. The
largest products, such as E I or m L^2, then stay below 1e60, and the smallest that divide above 1e-60. Both
are far from the ends of doubles. A value that no machine has within its range is a warning (`arm.sizes`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

RANGES: dict[str, tuple[float, float]] = {
    "m": (1e-9, 1e10),
    "m2": (1e-18, 1e20),
    "m4": (1e-36, 1e40),
    "rad": (1e-15, 1e9),
    "s": (1e-12, 1e11),
    "Hz": (1e-9, 1e9),
    "kg": (1e-12, 1e12),
    "kg m2": (1e-24, 1e32),
    "kg/m3": (1e-12, 1e12),
    "Pa": (1e-6, 1e18),
    "m/s2": (1e-12, 1e9),
    "N m/rad3": (1e-12, 1e24),
    "-": (1e-12, 1e12),
}
"""Smallest magnitude but zero, and largest, of values in a unit."""
NEVER_ZERO_ALONE = ("m2", "m4")
"""Units of vectors whose components are sizes, not coordinates, and must not be small either."""


def range_of(unit: str) -> tuple[float, float]:
    """Return the smallest magnitude but zero, and the largest, of values in `unit`."""
    # The same of all other units: forces, rates, gains, values in the unit of a signal.
    others = (1e-18, 1e18)
    return RANGES.get(unit, others)


def out_of_range(value: Any, unit: str, *, size: bool) -> str | None:
    """Return what is wrong with the magnitude of a number, or of the numbers in a list or table; else None.

    A `size` divides and must not be nearly zero, which a coordinate may be. What is no number passes.
    """
    least, most = range_of(unit)
    label = f" {unit}" if unit not in ("", "-", "unit", "SI") else ""
    for number in _numbers(value):
        if abs(number) > most:
            limits = f"at most {most:g}" if number > 0 else f"at least {-most:g}"
            return f"must be {limits}{label}, got {number:.9g}{label}"
        if size and 0 < abs(number) < least:
            return f"must not lie between 0 and {least:g}{label}, got {number:.9g}{label}"
    return None


def first_beyond(values: Any, unit: str, factor: float = 1.0) -> tuple[int, ...] | None:
    """Return the index of the first entry of an array that is too large, or None; NaN passes.

    `factor` leads from the unit of the values to the SI unit.
    """
    beyond = (abs(values) > range_of(unit)[1] / abs(factor)).nonzero()
    return tuple(int(i[0]) for i in beyond) if len(beyond[0]) else None


def _numbers(value: Any) -> Iterable[float]:
    if isinstance(value, float):
        yield value
    elif isinstance(value, tuple):
        yield from (item for item in value if isinstance(item, float))
    elif isinstance(value, Mapping):
        yield from (item for item in value.values() if isinstance(item, float))
