"""The values of --material: E, nu and rho of a group of cells, or of all that have none.

Without a unit they are in the consistent system that --unit names: Pa and kg/m3, with mm MPa and t/mm3. No
solid is stiffer than diamond, 1.2e12 Pa, nor denser than osmium, 22600 kg/m3, so that values in SI beside
--unit mm show themselves; they are taken as such, and said.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from flexarm.errors import InvalidFile, Problem
from flexarm.material import Material
from flexarm.units import FACTORS, factor_to

_NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)")
_FORM = "[GROUP:]E=..,nu=..,rho=.. such as E=210GPa,nu=0.3,rho=7850kg/m3"


def read_materials(texts: Iterable[str], unit: str) -> tuple[dict[str, Material], list[Problem]]:
    """Return materials by group, "" for all cells without one, and what is to be said about them.

    Raise InvalidFile if one is not of the form, names a group twice, or no solid has its values.
    """
    materials: dict[str, Material] = {}
    notes: list[Problem] = []
    for text in texts:
        group, _, values = text.rpartition(":")
        if group in materials:
            raise _refused(f"{group or 'the material of all'} is given twice")
        given = _values(text, values)
        E, rho, note = _in_si(text, given, unit)
        notes += note
        try:
            materials[group] = Material(youngs_modulus=E, poisson_ratio=given["nu"][0], density=rho)
        except ValueError as error:
            raise _refused(f"{text!r}: {_first(error)}") from None
    return materials, notes


def _refused(what: str) -> InvalidFile:
    return InvalidFile("command line", "--material", what)


def _first(error: ValueError) -> str:
    """Return the first error of pydantic in one line."""
    errors = getattr(error, "errors", None)
    if errors is None:
        return " ".join(str(error).split())
    first = errors()[0]
    return f"{'.'.join(map(str, first['loc']))}: {first['msg']}, got {first['input']}"


def _values(text: str, values: str) -> dict[str, tuple[float, str]]:
    """E, nu and rho with their units."""
    found: dict[str, tuple[float, str]] = {}
    for entry in values.split(","):
        name, equals, value = (part.strip() for part in entry.partition("="))
        match = _NUMBER.fullmatch(value)
        if not equals or name not in ("E", "nu", "rho") or match is None or name in found:
            raise _refused(f"must be {_FORM}, got {text!r}")
        found[name] = float(match[1]), match[2].strip()
    if missing := [name for name in ("E", "nu", "rho") if name not in found]:
        raise _refused(f"{text!r} lacks {', '.join(missing)}; it must be {_FORM}")
    return found


def _in_si(text: str, given: dict[str, tuple[float, str]], unit: str) -> tuple[float, float, list[Problem]]:
    """E [Pa] and rho [kg/m3]."""
    stiffest = 2e12  # above every Young's modulus [Pa]
    densest = 3e4  # above every density [kg/m3]
    E, rho = _with_unit(text, *given["E"], "Pa"), _with_unit(text, *given["rho"], "kg/m3")
    if unit == "mm" and E is None and rho is None:
        (young, _), (density, _) = given["E"], given["rho"]
        if 1e12 * density > densest and 1e6 * young > stiffest:
            what = f"{text!r} is no solid in MPa and t/mm3, the units of --unit mm; taken as Pa and kg/m3"
            return young, density, [Problem("--material", what)]
        E, rho = 1e6 * young, 1e12 * density
    E = E if E is not None else given["E"][0] * (1e6 if unit == "mm" else 1.0)
    rho = rho if rho is not None else given["rho"][0] * (1e12 if unit == "mm" else 1.0)
    if stiffest < E or rho > densest:
        raise _refused(f"no solid has E = {E:g} Pa and rho = {rho:g} kg/m3, got {text!r} with --unit {unit}")
    return E, rho, []


def _with_unit(text: str, value: float, unit: str, si: str) -> float | None:
    """Return the value in SI, or None if it has no unit."""
    if not unit:
        return None
    factor = factor_to(si, unit)
    if factor is None:
        raise _refused(f"unit {unit!r} in {text!r} is not known; allowed are {', '.join(FACTORS[si])}")
    return value * factor
