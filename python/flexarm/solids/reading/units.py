"""Units of mesh files, which say none: the user does.

Materials in a file follow from its unit of length, as analysts use it: `m` with kg, N, Pa; `mm` with t, N,
MPa,

    E [Pa] = 1e6 E [MPa] ,   rho [kg/m3] = 1e12 rho [t/mm3]                                         (1)

With any other unit of length the file's materials are not known and must be given.
"""

from __future__ import annotations

from collections.abc import Mapping

from flexarm.arm.link import Material
from flexarm.errors import InvalidFile, InvalidParameter
from flexarm.solids.reading.content import Elastic
from flexarm.units import FACTORS, factor_to

_TO_SI = {1.0: (1.0, 1.0), 1e-3: (1e6, 1e12)}


def check_unit(unit: str) -> None:
    """Raise `InvalidParameter` if `unit` is no unit of length."""
    if factor_to("m", unit) is None:
        raise InvalidParameter(
            f"must be a unit of length, one of {', '.join(FACTORS['m'])}, got {unit!r}", where="unit"
        )


def si_materials(materials: Mapping[str, Elastic], unit: str, file: str) -> dict[str, Material]:
    """Materials by group, in SI."""
    return {name: _si(material, unit, file, name) for name, material in materials.items()}


def _si(material: Elastic, unit: str, file: str, group: str) -> Material:
    modulus, ratio, density = material.youngs_modulus, material.poisson_ratio, material.density
    if modulus is None or ratio is None or density is None:
        values = {"Young's modulus": modulus, "Poisson's ratio": ratio, "density": density}
        missing = ", ".join(name for name, value in values.items() if value is None)
        raise InvalidFile(
            file, material.where, f"has no {missing}; add it, or give group {group!r} a material of its own"
        )
    factors = _TO_SI.get(factor_to("m", unit) or 0.0)
    if factors is None:
        raise InvalidFile(
            file,
            material.where,
            f"the unit {unit!r} does not tell those of E = {modulus:g} and density {density:g}; give "
            f"group {group!r} a material (SI), or use 'm' (Pa, kg/m3) or 'mm' (MPa, t/mm3)",
        )
    try:  # eq. (1)
        return Material(
            youngs_modulus=modulus * factors[0], poisson_ratio=ratio, density=density * factors[1]
        )
    except ValueError as error:
        raise InvalidFile(
            file,
            material.where,
            f"E = {modulus:g}, nu = {ratio:g}, density {density:g}: must be positive, "
            "Poisson's ratio between -1 and 0.5",
        ) from error
