"""A spring in the place of another one: as soft and as lossy, whatever springs the model has."""

from types import SimpleNamespace

import numpy as np
import pytest
from arms import crane

from flexarm.diagnosis.alternatives import _springs_elsewhere
from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.screening import Probed
from flexarm.effects import BaseCompliance, JointCompliance, JointHysteresis


def candidate(effect, without=None):
    return Candidate(effect, ("stiffness", "damping"), (effect,), {}, without)


def test_a_soft_base_turns_the_arm_as_the_soft_joint_did():
    """In series joint and base are as stiff, and lose as much, as the one soft joint, where w c << k."""
    nominal = JointCompliance(at="waist", stiffness=3e5, damping=600.0)
    soft = JointCompliance(at="waist", stiffness=7e3, damping=7.0)
    base = candidate(BaseCompliance(at="base", stiffness=1e6, damping=1e3))
    found = base.acting_as(candidate(soft, nominal)).effect
    w = 2 * np.pi * 1.5
    joint, both = (
        7e3 + 1j * w * 7.0,
        1 / (1 / (3e5 + 1j * w * 600.0) + 1 / (found.stiffness + 1j * w * found.damping)),
    )
    assert both == pytest.approx(joint, rel=1e-3)


def test_a_spring_that_is_there_becomes_softer_by_as_much():
    there = JointCompliance(at="elbow", stiffness=8e4, damping=160.0)
    soft = candidate(JointCompliance(at="waist", stiffness=1e5, damping=200.0))
    found = candidate(there, there).acting_as(soft).effect
    assert 1 / found.stiffness == pytest.approx(1 / 8e4 + 1 / 1e5)


def test_a_stiffer_joint_has_no_like_in_a_rigid_base():
    nominal = JointCompliance(at="hinge", stiffness=1e5, damping=200.0)
    stiffer = candidate(JointCompliance(at="hinge", stiffness=2e5, damping=200.0), nominal)
    base = candidate(BaseCompliance(at="base", stiffness=1e6, damping=1e3))
    assert base.acting_as(stiffer) == base


@pytest.mark.parametrize("left, tried", [(40.0, ["base"]), (60.0, [])], ids=["helped", "hardly helped"])
def test_where_one_spring_helps_the_others_are_rivals_as_soft_as_that(left, tried):
    """A gap of 100 that a vibration explains, a soft elbow more than half of; the waist is one already."""
    soft = candidate(JointCompliance(at="elbow", stiffness=1e4, damping=20.0))
    waist = candidate(JointCompliance(at="waist", stiffness=1e6, damping=1e3))
    base = candidate(BaseCompliance(at="base", stiffness=1e6, damping=1e3))
    fit = SimpleNamespace(cost=left, members=(soft,))
    shakes = SimpleNamespace(cost=10.0, members=(SimpleNamespace(place=("external_vibration", "base")),))
    probed = [Probed(each, np.empty((0, 0))) for each in (soft, waist, base)]
    found = _springs_elsewhere({soft.place: fit}, [waist], shakes, 100.0, probed, 0.5)
    assert [each.at for each in found] == tried
    assert all(each.effect == base.acting_as(soft).effect for each in found)
    assert _springs_elsewhere({}, [waist], shakes, 100.0, probed, 0.5) == []


def test_the_sum_bends_an_arm_alike():
    """Sag of a crane about the base's and the hinge's common axis, by either spring."""
    import flexarm

    arm = crane()
    soft = candidate(JointCompliance(at="hinge", stiffness=5e4, damping=100.0))
    base = candidate(BaseCompliance(at="base", stiffness=1e6, damping=1e3)).acting_as(soft)
    by_joint, by_base = (
        flexarm.static(arm.with_effect(each.effect), joints={"hinge": 0.4}).displacement
        for each in (soft, base)
    )
    assert by_base == pytest.approx(by_joint, abs=1e-6)


def test_hysteresis_that_sticks_is_a_stiffer_spring():
    """Dahl's law, far from slipping, is a spring T_h/w beside the joint's: the hub's ring is the same."""
    import flexarm

    arm = crane().with_effect(JointCompliance(at="hinge", stiffness=5e4, damping=100.0))
    nominal = arm.effect("joint_compliance", "hinge")
    stiffer = candidate(nominal.with_parameters({"stiffness": 8e4}), nominal)
    law = JointHysteresis(at="hinge", torque=20.0, width=0.5)
    sticking = Candidate(law, ("torque", "width"), (law,), {}).acting_as(stiffer).effect
    drive = flexarm.Drive.from_samples([0.0, 0.4, 0.8, 2.0], {"hinge": [0.4, 0.41, 0.4, 0.41]})
    tip, alike, before = (
        flexarm.simulate(arm.with_effect(each), drive, step=4e-3).position
        for each in (stiffer.effect, sticking, nominal)
    )
    moved = np.abs(tip - tip[0] - before + before[0]).max()
    assert np.abs(alike - alike[0] - tip + tip[0]).max() < 0.02 * moved


def test_hysteresis_is_nothing_like_a_softer_spring_or_one_where_none_was():
    law = JointHysteresis(at="hinge", torque=20.0, width=3e-4)
    hysteresis = Candidate(law, ("torque", "width"), (law,), {})
    nominal = JointCompliance(at="hinge", stiffness=1e5, damping=200.0)
    softer = nominal.with_parameters({"stiffness": 8e4})
    assert hysteresis.acting_as(candidate(softer, nominal)) is None
    assert hysteresis.acting_as(candidate(softer)) is None
