"""Claims about refined values: moved by how much, of what was stated."""

import diagnoses
import pytest
from arms import crane
from pytest import approx

from flexarm.arm.parameter import stated_sigma
from flexarm.diagnosis.result import Refinement
from flexarm.named_effects import Refined


@pytest.mark.parametrize(
    ("key", "sigma"),
    [
        ("links.rod.material.youngs_modulus", 0.01 * 2.1e11),  # relative
        ("points.tip.position.x", 5e-4),  # absolute, the model's key ends in _m
        ("points.tip.position.z", 5e-4),
        ("payloads.load.mass", None),
        ("links.rod.material.density", None),
    ],
)
def test_stated_sigma_is_found_whatever_its_key_says_of_units(key, sigma):
    found = stated_sigma(diagnoses.nominal(), key)
    assert found is None if sigma is None else found == approx(sigma)


def test_products_of_inertia_are_as_uncertain_as_they_are_large():
    """A tenth of each of six components, in the order xx, yy, zz, xy, xz, yz."""
    load = {"name": "load", "link": "rod", "position": [0, 0, 3.0], "mass": 14.1}
    inertia = {"x": 2.0, "y": 2.5, "z": 3.0, "xy": 0.01, "xz": -0.02, "yz": 0.03}
    known = {"payloads.load.inertia": 0.1}
    arm = crane(payloads=[{**load, "inertia": list(inertia.values())}], uncertainty=known)
    for component, value in inertia.items():
        assert stated_sigma(arm, f"payloads.load.inertia.{component}") == approx(0.1 * abs(value))


def test_a_modulus_moved_by_as_many_sigmas_as_it_differs():
    [each] = diagnoses.of_effects().refinements
    assert each.moved == approx(-2e9)
    assert each.pull == approx(-2e9 / 2.1e9)
    assert each.determined
    assert each.texts == ("-2.0", "1.0", "GPa")


def test_what_the_data_leave_as_uncertain_as_it_was_is_not_determined():
    kept = Refined("points.tip.position.y", 1e-13, 4.9e-4, 0.0, "m")
    assert not Refinement(kept, 5e-4).determined
    assert Refinement(kept, 1e-3).determined
    assert Refinement(kept, None).determined  # nothing was stated that it could be compared with


def test_a_value_that_is_known_far_better_shows_its_digits():
    sharp = Refined("points.tip.position.z", 3.0001412, 2.8e-6, 3.0, "m")
    assert Refinement(sharp, 5e-4).texts == ("+0.1412", "0.0028", "mm")


def test_summary_parts_what_is_determined_from_what_is_not():
    vague = Refined("points.tip.position.y", 1e-13, 5e-4, 0.0, "m")
    d = diagnoses.of_effects(refined=(*diagnoses.of_effects().refined, vague))
    text = d.summary()
    assert "links.rod.material.youngs_modulus: 210.0 GPa -2.0 +- 1.0 GPa, -1.0 stated sigma" in text
    assert "not determined: points.tip.position.y" in text
