"""Material of an elastic part."""

from __future__ import annotations

from flexarm.tables import Number, Table, value_in


class Material(Table):
    """An isotropic elastic material."""

    youngs_modulus: Number = value_in("Pa", "Young's modulus E", gt=0)
    poisson_ratio: Number = value_in("-", "Poisson's ratio", gt=-1, lt=0.5)
    density: Number = value_in("kg/m3", "density", ge=0)

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + nu)) [Pa]."""
        return self.youngs_modulus / (2 * (1 + self.poisson_ratio))
