"""Nominal values that the data leave open are put back; not where the gap would grow by it."""

import diagnoses
import pytest

import flexarm
from flexarm import effects
from flexarm.arm.parameter import with_value
from flexarm.diagnosis.sensor_zeros import without_idle_zeros
from flexarm.diagnosis.uncertainty import restore_unidentifiable
from flexarm.named_effects import Refined

ACROSS = Refined("points.tip.position.y", 2e-4, 4.9e-4, 0.0, "m")
"""Across the plane of the swing, where nothing is measured; 0.98 of its stated sigma of 0.5 mm is left."""


def gaps(model):
    return {"slow": flexarm.compare(model, diagnoses.record(1), step=0.01)}


def moved(model, *refined):
    for each in refined:
        model = with_value(model, each.parameter, each.value)
    return model


def test_what_does_not_show_goes_back_and_the_rest_stays():
    """A modulus that the data determine keeps its value, and so does the spring."""
    stiffer = Refined("links.rod.material.youngs_modulus", 2.101e11, 1e8, 2.1e11, "Pa")
    repaired = moved(diagnoses.with_spring(), ACROSS, stiffer)
    model, refined = restore_unidentifiable(diagnoses.nominal(), repaired, (ACROSS, stiffer), gaps)
    assert model == moved(diagnoses.with_spring(), stiffer)
    assert [(each.parameter, each.value) for each in refined] == [
        ("points.tip.position.y", 0.0),
        ("links.rod.material.youngs_modulus", 2.101e11),
    ]
    assert refined[0].std == ACROSS.std


def test_what_the_gap_needs_stays_however_uncertain_it_is_said_to_be():
    """The modulus of the machine is the nominal one: a model 3 % off is what going back would give."""
    arm = with_value(diagnoses.nominal(), "links.rod.material.youngs_modulus", 0.97 * 2.1e11)
    needed = Refined("links.rod.material.youngs_modulus", 2.1e11, 2.1e9, 0.97 * 2.1e11, "Pa")
    repaired = diagnoses.with_spring()
    assert restore_unidentifiable(arm, repaired, (needed,), gaps) == (repaired, (needed,))


@pytest.mark.parametrize("refined", [(), (Refined("points.tip.position.z", 3.001, 1e-5, 3.0, "m"),)])
def test_nothing_is_simulated_where_nothing_is_open(refined):
    def never(model):
        raise AssertionError("no gap is asked for")

    repaired = diagnoses.with_spring()
    assert restore_unidentifiable(diagnoses.nominal(), repaired, refined, never) == (repaired, refined)


def test_a_zero_that_the_data_do_not_tell_from_none_leaves_the_model():
    """1e-8 rad +- 4e-5 rad is no offset: the model has neither the effect nor its uncertainty."""
    offset = effects.EncoderOffset(at="hinge", offset=1e-8)
    stated = diagnoses.nominal()
    arm = stated.with_effect(offset.replace(offset=0.0)).replace(
        uncertainty={**stated.uncertainty, "effects.encoder_offset.hinge.offset_rad": 5e-3}
    )
    repaired = arm.with_effect(offset)
    key = "effects.encoder_offset.hinge.offset"
    zero = Refined(key, 1e-8, 4e-5, 0.0, "rad")
    back, refined = restore_unidentifiable(arm, repaired, (zero,), gaps)
    assert [(each.value, each.std) for each in refined] == [(0.0, 4e-5)]
    assert without_idle_zeros(back, stated) == stated
