"""Units that files may use, as factors to SI.

A unit is read for what is measured: `g` is a gram for a mass and 9.80665 m/s2 for an acceleration. Spaces,
dots, stars and `^` do not matter: "N m", "N*m" and "Nm" are one unit, as are "m/s2" and "m/s^2".
"""

from __future__ import annotations

from functools import lru_cache
from math import pi

from flexarm.errors import InvalidParameter

_DEGREE = pi / 180
FACTORS: dict[str, dict[str, float]] = {
    "m": {"m": 1, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "km": 1e3, "in": 0.0254},
    "rad": {
        "rad": 1,
        "mrad": 1e-3,
        "urad": 1e-6,
        "µrad": 1e-6,
        "deg": _DEGREE,
        "°": _DEGREE,
        "arcmin": _DEGREE / 60,
        "arcsec": _DEGREE / 3600,
        "rev": 2 * pi,
        "turn": 2 * pi,
    },
    "rad/s": {
        "rad/s": 1,
        "mrad/s": 1e-3,
        "deg/s": _DEGREE,
        "°/s": _DEGREE,
        "dps": _DEGREE,
        "rpm": pi / 30,
        "rev/s": 2 * pi,
    },
    "m/s": {"m/s": 1, "mm/s": 1e-3, "cm/s": 1e-2},
    "m/s2": {"m/s2": 1, "m/s²": 1, "mm/s2": 1e-3, "g": 9.80665, "mg": 9.80665e-3},
    "N m": {"N m": 1, "mN m": 1e-3, "kN m": 1e3},
    "N": {"N": 1, "mN": 1e-3, "kN": 1e3},
    "V": {"V": 1, "mV": 1e-3},
    "A": {"A": 1, "mA": 1e-3},
    "Pa": {"Pa": 1, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "bar": 1e5, "N/mm2": 1e6, "N/m2": 1},
    "kg/m3": {"kg/m3": 1, "g/cm3": 1e3, "t/m3": 1e3, "t/mm3": 1e12, "kg/mm3": 1e9},
    "kg": {"kg": 1, "g": 1e-3, "t": 1e3},
    "s": {"s": 1, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "μs": 1e-6, "ns": 1e-9, "min": 60},
    "1": {"1": 1, "-": 1, "": 1, "%": 1e-2, "um/m": 1e-6, "µm/m": 1e-6, "ustrain": 1e-6, "mm/m": 1e-3},
}


def _normal(unit: str) -> str:
    return unit.translate(str.maketrans("", "", " ·.*^"))


@lru_cache(maxsize=1024)
def factor_to(si: str, unit: str) -> float | None:
    """Factor from `unit` to the SI unit `si`, or None if it is not a unit of that kind.

    >>> factor_to("m", "mm"), factor_to("m", "rad")
    (0.001, None)
    """
    return {_normal(name): factor for name, factor in FACTORS[si].items()}.get(_normal(unit))


def unit_in_name(column: str) -> str:
    """Return the unit in which the name of a column ends, empty if in none.

    >>> unit_in_name("q_deg"), unit_in_name("rate_deg_s"), unit_in_name("joint_1")
    ('deg', 'deg/s', '')
    """
    *_, before, last = ["", *column.split("_")]
    ends = (f"{before}/{last}", last if last.strip("-%1") else "")
    return next((end for end in ends if end and any(factor_to(si, end) is not None for si in FACTORS)), "")


def contradicted_unit(column: str, unit: str) -> str:
    """Return what is to be said of a column whose name ends in another unit than its own, else nothing.

    Letters and words that may mean something else count as units of the same kind only, such as `T_N_m`.

    >>> contradicted_unit("q_deg", "rad")
    "column 'q_deg' ends in 'deg', but its unit is 'rad'"
    """
    ending = unit_in_name(column)
    factors = ((factor_to(si, ending), factor_to(si, unit)) for si in FACTORS)
    alike = next((pair for pair in factors if None not in pair), None)
    ambiguous = len(ending) < 2 or ending in ("in", "min", "rev", "turn", "bar")
    if not ending or (ambiguous if alike is None else alike[0] == alike[1]):
        return ""
    return f"column {column!r} ends in {ending!r}, but its unit is {unit!r}"


def si_factor(unit: str, allowed: tuple[str, ...]) -> tuple[str, float]:
    """Return the SI unit among `allowed` that `unit` belongs to, and the factor to it.

    Allowed are ("rad", "m") for the angle of a joint that may be prismatic.

    Raise InvalidParameter if `unit` belongs to none of them.
    """
    for si in allowed:
        factor = factor_to(si, unit)
        if factor is not None:
            return si, factor
    known = ", ".join(name for si in allowed for name in FACTORS[si] if name)
    raise InvalidParameter(f"unit {unit!r} does not fit; allowed are {known}")


def ratio_factor(
    unit: str | None, above: tuple[str, ...], below: tuple[str, ...]
) -> tuple[tuple[str, str], float]:
    """Return the SI units of a ratio and the factor to them: `"mm/kN"` is 1e-6 m/N.

    `unit` is what the file says, such as "rad/(N m)", "1" for a ratio of like units, None for SI; `above` and
    `below` are SI units that fit, the first ones by default.

    Raise InvalidParameter if it is no ratio of such units.

    >>> ratio_factor("mm/(kN)", ("m",), ("N", "kg"))
    (('m', 'N'), 1e-06)
    """
    alike = next((si for si in above if si in below), None)
    if unit is None or (alike is not None and factor_to("1", unit) == 1):
        return ((alike, alike) if unit is not None and alike else (above[0], below[0])), 1.0
    for i in (k for k, sign in enumerate(unit) if sign == "/"):
        parts = []
        for part, allowed in ((unit[:i], above), (unit[i + 1 :], below)):
            plain = part.strip()
            plain = plain[1:-1] if plain.startswith("(") and plain.endswith(")") else plain
            parts += [(si, factor) for si in allowed if (factor := factor_to(si, plain)) is not None][:1]
        if len(parts) == 2:
            (one, up), (other, down) = parts
            return (one, other), up / down
    raise InvalidParameter(f"unit {unit!r} does not fit; allowed is {above[0]}/({below[0]}) and the like")
