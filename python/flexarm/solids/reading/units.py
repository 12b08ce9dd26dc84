"""Units of mesh files, which say none: the user does.

Materials in a file follow from its unit of length, as analysts use it: `m` with kg, N, Pa; `mm` with t, N,
MPa,

    E [Pa] = 1e6 E [MPa] ,   rho [kg/m3] = 1e12 rho [t/mm3]                                         (1)

With any other unit of length the file's materials are not used.
"""

from __future__ import annotations

from collections.abc import Mapping

from flexarm.errors import InvalidParameter, Problem
from flexarm.material import Material
from flexarm.solids.reading.content import Elastic
from flexarm.units import FACTORS, factor_to

_TO_SI = {1.0: (1.0, 1.0), 1e-3: (1e6, 1e12)}


def check_unit(unit: str) -> None:
    """Raise `InvalidParameter` if `unit` is no unit of length."""
    if factor_to("m", unit) is None:
        what = f"must be a unit of length, one of {', '.join(FACTORS['m'])}, got {unit!r}"
        raise InvalidParameter(what, where="unit")


def si_materials(materials: Mapping[str, Elastic], unit: str) -> tuple[dict[str, Material], list[Problem]]:
    """Return the materials by group, in SI, and why others cannot be used."""
    known, notes = {}, []
    for group, material in materials.items():
        why = _doubt(material, unit)
        if why:
            notes.append(Problem(f"materials.{group}", f"{material.where}: {why}; it is not used"))
        else:
            known[group] = _si(material, unit)
    return known, notes


def _doubt(material: Elastic, unit: str) -> str:
    """Return the reason why a material of the file cannot be used; empty if it can."""
    modulus, ratio, density = material.youngs_modulus, material.poisson_ratio, material.density
    values = {"Young's modulus": modulus, "Poisson's ratio": ratio, "density": density}
    missing = [name for name, value in values.items() if value is None]
    if missing:
        return f"has no {' and no '.join(missing)}"
    if factor_to("m", unit) not in _TO_SI:
        return f"is in units that lengths in {unit!r} do not tell ('m': Pa, kg/m3; 'mm': MPa, t/mm3)"
    try:
        _si(material, unit)
    except ValueError:
        return (
            f"E = {modulus:g}, nu = {ratio:g}, density {density:g} are no material: E must be positive, nu "
            "between -1 and 0.5, density not negative"
        )
    return ""


def _si(material: Elastic, unit: str) -> Material:
    to_pascal, to_kg_per_m3 = _TO_SI[factor_to("m", unit) or 1.0]
    assert material.youngs_modulus is not None and material.density is not None  # _doubt has looked
    return Material(
        youngs_modulus=_shifted(material.youngs_modulus, to_pascal),  # eq. (1)
        poisson_ratio=material.poisson_ratio,
        density=_shifted(material.density, to_kg_per_m3),
    )


def _shifted(value: float, factor: float) -> float:
    """Return the product with a power of ten, rounded as the decimal number was written."""
    return float(f"{value * factor:.15g}")
