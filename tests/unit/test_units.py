"""Units are read for what is measured."""

from math import pi

import pytest
from pytest import approx

from flexarm.errors import InvalidParameter
from flexarm.quantities import QUANTITIES
from flexarm.units import FACTORS, contradicted_unit, factor_to, si_factor


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


@pytest.mark.parametrize(
    ("column", "unit", "ending"),
    [
        ("a_g", "m/s2", "g"),
        ("rate_deg_s", "rad/s", "deg/s"),
        ("stamp_ns", "s", "ns"),
        ("d_mm", "rad", "mm"),
        ("joint_A", "rad", ""),
        ("T_N_m", "N m", ""),
        ("strain_1", "um/m", ""),
        ("v_m_s", "m/s", ""),
    ],
)
def test_a_name_contradicts_a_unit_where_it_ends_in_another(column: str, unit: str, ending: str) -> None:
    """A letter is a unit only among those of its own kind: the A of a joint is no ampere."""
    said = contradicted_unit(column, unit)
    assert said == (f"column {column!r} ends in {ending!r}, but its unit is {unit!r}" if ending else "")
