"""Effects that are confounded with nuisance parameters in prior-data conflict."""

import numpy as np
import pytest
from planted import run_of

import flexarm
from flexarm.diagnosis.acceptance import Criteria, conflict
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.moves.confounding import _matched, confounded_effects, confounded_fits
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.refinement import fitted_null
from flexarm.diagnosis.screening import probe
from flexarm.effects import LinkLength, LinkStiffness, PayloadMass, TimeDelay
from flexarm.measurement import predict
from flexarm.record import Clock

MODULUS, DELAY = "links.rod.material.youngs_modulus", "effects.time_delay.tracker.delay"
OWN_MASS = "payloads.load.mass"
TIP, MIDDLE = "points.tip.position", "points.middle.position"
SCALE, LATE = 1.5, 8e-3


def seen(truth, half_way=False, **also):
    """The record of one joint as another machine makes it, whose tracker has a clock known to 2 ms.

    It may see a second point, half way along the rod.
    """
    run = run_of("one joint")
    nominal = run.simulation.arm
    [tip] = nominal.points
    middle = tip.replace(name="middle", position=tuple(x / 2 for x in tip.position))
    nominal = nominal.replace(points=(tip, middle), uncertainty={MODULUS: 0.01, **also})
    clocks = {**run.record.clocks, "tracker": Clock(sigma=2e-3)}
    signals = list(run.record.signals.values())
    if half_way:
        signals.append(run.record.signals["tip"].replace(name="middle", point="middle"))
    signals = [s.replace(clock="tracker") if s.quantity == "position" else s for s in signals]
    record = run.record.replace(signals=signals, clocks=clocks)
    machine = nominal.with_effect(truth)
    simulation = flexarm.simulate(machine, record, step=1e-3)
    rng = np.random.default_rng(3)
    shown = [
        s if s.name in record.drive
        else s.replace(values=(exact := predict(simulation, s)) + s.noise_std * rng.normal(size=exact.shape))
        for s in record.signals.values()
    ]  # fmt: skip
    problem = Problem(nominal, {"run": record.replace(signals=shown)}, step=4e-3)
    estimator = Estimator.nominal(problem, nuisance_model(problem))
    null, about = fitted_null(estimator.fit(()), estimator)
    return about, probe(estimator, candidates(problem, estimator.nuisance.arm)), null


@pytest.fixture(scope="module")
def stiffer():
    """A rod half as stiff again as a modulus says that is known to 1 %."""
    return seen(LinkStiffness(at="rod", scale=SCALE))


def test_a_stiffness_is_confounded_with_a_modulus_in_conflict(stiffer):
    estimator, probed, null = stiffer
    assert conflict(null, SelectionPolicy()) > 30
    first = confounded_effects(estimator, probed, null)[0]
    assert (first.candidate.place, set(first.values)) == (("link_stiffness", "rod"), {MODULUS})
    # To first order about the strained fit: (1 + 50 sigma)/1 is not 1 + ln 1.5.
    assert first.member().effect.scale == pytest.approx(SCALE, rel=0.2)


def test_its_fit_leaves_the_noise_and_the_modulus_where_it_is_stated(stiffer):
    estimator, probed, null = stiffer
    [found] = [
        f for f in confounded_fits(estimator, probed, null) if f.places == (("link_stiffness", "rod"),)
    ]
    assert conflict(found, SelectionPolicy()) == 0.0
    assert Criteria(estimator.problem, null).resolves_conflict(found, null)
    assert found.members[0].effect.scale == pytest.approx(SCALE, rel=0.03)  # the modulus is known to 1 %
    assert found.cost < 1.1 * len(found.residual)


def test_a_mass_is_confounded_with_the_mass_of_the_model_in_conflict():
    """About the mass that the fit has: from the stated one, all that was fitted would be its move."""
    nominal = run_of("one joint").simulation.arm.payloads[0].mass
    lighter = 0.9 * nominal
    estimator, probed, null = seen(PayloadMass(at="load", mass=lighter), **{OWN_MASS: 0.002})
    assert abs(estimator.at[estimator.nuisance.keys.index(OWN_MASS)]) > 30 * 0.002 * nominal
    first = confounded_effects(estimator, probed, null)[0]
    assert (first.candidate.place, set(first.values)) == (("payload_mass", "load"), {OWN_MASS})
    assert first.member().effect.mass - nominal == pytest.approx(lighter - nominal, rel=0.02)


def test_a_longer_rod_is_confounded_with_two_points_off_along_it():
    """Each of them does what its reflector does, and what a longer rod does only together with the other."""
    error, known = 2e-3, 1e-4
    about, probed, null = seen(
        LinkLength(at="rod", error=error), half_way=True, **{f"{TIP}_m": known, f"{MIDDLE}_m": known}
    )
    first, *others = confounded_effects(about, probed, null)
    assert (first.candidate.place, set(first.values)) == (("link_length", "rod"), {f"{TIP}.z", f"{MIDDLE}.z"})
    assert first.member().effect.error == pytest.approx(error, rel=0.05)
    assert [each.candidate.place for each in others] == [
        ("reflector_offset", "tip"),
        ("reflector_offset", "middle"),
    ]


def test_a_clock_as_an_effect_replaces_the_nuisance_parameter():
    estimator, probed, null = seen(TimeDelay(at="tip", delay=LATE))
    made = estimator.problem.simulations.made
    first = confounded_effects(estimator, probed, null)[0]
    assert (first.candidate.place, set(first.values)) == (("time_delay", "tracker"), {DELAY})
    assert first.member().effect.delay == pytest.approx(LATE, rel=0.1)
    assert estimator.problem.simulations.made == made


def test_its_fit_starts_at_the_estimate_of_the_nuisance_parameter():
    """About a model with the clock where it is stated, too: from there the unknown is only to first order."""
    about, probed, _ = seen(TimeDelay(at="tip", delay=LATE))
    nominal = about.moved_to({DELAY: 0.0})
    start = nominal.fit(())
    first = confounded_effects(nominal, probed, start)[0]
    assert _matched(nominal, first, start).effect.delay == pytest.approx(LATE, rel=0.1)


def test_no_effect_is_proposed_where_a_larger_gap_causes_the_conflict():
    """A load half as heavy again: the modulus that is strained by it makes up for less than a third."""
    estimator, probed, null = seen(PayloadMass(at="load", mass=21.0))
    assert conflict(null, SelectionPolicy()) > 1.0
    made = estimator.problem.simulations.made
    assert confounded_effects(estimator, probed, null) == []
    assert estimator.problem.simulations.made == made


def test_no_effect_is_proposed_without_conflict():
    estimator, probed, null = seen(LinkStiffness(at="rod", scale=1.005))
    made = estimator.problem.simulations.made
    assert confounded_effects(estimator, probed, null) == []
    assert estimator.problem.simulations.made == made
