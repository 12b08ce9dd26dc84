"""Units are read for what is measured."""

from math import pi

import pytest
from pytest import approx

from flexarm.errors import InvalidParameter
from flexarm.quantities import QUANTITIES
from flexarm.units import FACTORS, factor_to, si_factor


@pytest.mark.parametrize(
    ("si", "unit", "factor"),
    [
        ("m", "mm", 1e-3),
        ("rad", "deg", pi / 180),
        ("rad", "arcsec", pi / 648000),
        ("rad/s", "rpm", 2 * pi / 60),
        ("s", "ms", 1e-3),
        ("kg", "g", 1e-3),
        ("m/s2", "g", 9.80665),
        ("N m", "Nm", 1),
        ("N m", "mN*m", 1e-3),
        ("m/s2", "m/s^2", 1),
        ("1", "um/m", 1e-6),
        ("rad", "mrad", 1e-3),
    ],
)
def test_a_unit_is_a_factor_to_si(si: str, unit: str, factor: float) -> None:
    assert factor_to(si, unit) == approx(factor, rel=1e-15)


def test_a_unit_of_another_kind_lists_those_that_fit() -> None:
    assert factor_to("m", "kg") is None
    with pytest.raises(InvalidParameter, match="unit 'kg' does not fit; allowed are m, mm"):
        si_factor("kg", ("m",))


def test_every_quantity_is_measured_in_a_known_si_unit() -> None:
    for quantity in QUANTITIES.values():
        for unit in quantity.units:
            assert FACTORS[unit][unit] == 1
