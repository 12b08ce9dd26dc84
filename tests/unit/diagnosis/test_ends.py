"""An effect whose size rests where fits end explains nothing, however well it fits."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from planted import two_joints
from posed import posed, poses

import flexarm
from flexarm.arm.prior import Prior
from flexarm.diagnosis.candidate import TransformedParameter
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.uncertainty import bound_sentence, estimates_at_bounds, has_implausible_size
from flexarm.effects import LinkStiffness, PayloadMass

SCALE = TransformedParameter(0, "scale", Prior(0.6, 1.25, 1.0, "log", "", "a test"))
DAMPING = replace(SCALE, name="damping")


def fit(*z, parameters=(SCALE, DAMPING)):
    """A stiffer forearm of so many sigmas of its prior, and a second parameter."""
    member = SimpleNamespace(
        place=("link_stiffness", "forearm"),
        free=("scale", "damping"),
        effect=LinkStiffness,
        is_size=lambda name: name == "scale",
    )
    nothing = np.zeros(0)
    chosen = parameters[: len(z)]
    return Fit((member,), chosen, np.array(z), nothing, nothing, nothing, None, None)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_size_at_either_end_is_told_with_what_machines_have(sign):
    [said] = estimates_at_bounds(fit(0.99 * sign * SCALE.bound))
    assert said.startswith("scale of link stiffness at forearm rests where fits end, at ")
    assert said.endswith("(95 % of machines have 0.600 to 1.25)")
    assert bound_sentence(fit(0.99 * sign * SCALE.bound)).startswith(
        "What fits best has a value that no machine has"
    )


def test_a_size_that_is_far_off_but_not_at_the_end_is_a_size():
    assert estimates_at_bounds(fit(0.7 * SCALE.bound)) == []
    assert bound_sentence(fit(0.7 * SCALE.bound)) == ""


def test_what_only_shapes_a_law_may_vanish():
    """A spring's damping that tends to nothing is none, and a spring all the same."""
    assert estimates_at_bounds(fit(1.0, -DAMPING.bound)) == []


def test_a_size_of_one_machine_in_ten_thousand_is_far_out_and_a_load_that_is_none_is_not():
    """Four sigmas; a linear prior, of an offset say, is of what is usual and excludes nothing."""
    assert has_implausible_size(fit(4.1)) and has_implausible_size(fit(-4.1))
    assert not has_implausible_size(fit(3.9))
    assert not has_implausible_size(fit(1.0, -8.0))  # damping only shapes the law
    linear = TransformedParameter(0, "scale", Prior(-1.0, 1.0, 0.0, "linear", "m", "a test"))
    assert not has_implausible_size(fit(9.0, parameters=(linear,)))


def test_phases_have_no_end():
    phase = TransformedParameter(0, "scale", Prior(-np.pi, np.pi, 0.0, "uniform", "rad", "a test"))
    assert estimates_at_bounds(fit(phase.bound, parameters=(phase,))) == []


def test_a_gripper_may_carry_nothing():
    """Eight kilograms were written down, and poses show no load."""
    empty = two_joints().with_effect(PayloadMass(at="load", mass=1e-6))
    record = posed(empty, poses(2, 16, 1), 1)
    d = flexarm.diagnose(two_joints(), {"yard": record}, posed(empty, poses(2, 10, 2), 2), n_jobs=1)
    [load] = d.effects
    assert (d.verdict, load.name, load.at) == ("effects", "payload_mass", "load")
    assert load.parameters[0].value < 0.3


@pytest.mark.parametrize(("sign", "count"), [(1.0, 1), (-1.0, 0)])
def test_thirty_times_a_load_is_no_size_and_none_is(sign, count):
    load = SimpleNamespace(
        place=("payload_mass", "load"),
        free=("scale",),
        effect=PayloadMass,
        is_size=lambda name: name == "scale",
    )
    assert len(estimates_at_bounds(replace(fit(sign * SCALE.bound), members=(load,)))) == count
