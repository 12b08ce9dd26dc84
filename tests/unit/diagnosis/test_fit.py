"""Claims about fits: time steps do not bias them, nominal values may act otherwise than in proportion."""

from dataclasses import replace

import numpy as np
import pytest
from planted import run_of

import flexarm
from flexarm.arm.parameter import with_value
from flexarm.diagnosis import least_squares
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import Projection
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.policy import FIT
from flexarm.diagnosis.problem import Problem
from flexarm.effects import BaseCompliance, ExternalVibration, JointCompliance, PayloadMass
from flexarm.measurement import predict

SOFTER = 0.985


@pytest.fixture(scope="module")
def run():
    """An arm of one joint; its record is what the model says, in steps of 4 ms."""
    return run_of("one joint")


def problem(arm, record, step=8e-3):
    return Problem(arm, {"run": record}, step=step)


STIFF = "effects.joint_compliance.hinge.stiffness"


def seen(run, arm, step=1e-3):
    """What the record's sensors show of an arm, without noise."""
    simulation = flexarm.simulate(arm, run.record, step=step)
    shown = [
        signal if signal.name in run.record.drive else signal.replace(values=predict(simulation, signal))
        for signal in run.record.signals.values()
    ]
    return run.record.replace(signals=shown)


def test_a_correction_takes_away_what_time_steps_miss(run):
    """Order two leaves 1/16 of the error at h/4; extrapolated less than a tenth of that, of phase."""
    arm = run.simulation.arm
    coarse, fine = (problem(arm, run.record, step) for step in (16e-3, 5e-4))
    error = coarse.residual(arm) - fine.residual(arm)
    left = coarse.residual(arm) + coarse.correction(arm) - fine.residual(arm)
    assert np.linalg.norm(left) < 0.02 * np.linalg.norm(error)


def test_poses_need_no_correction(run):
    there = problem(run.simulation.arm, run.record)
    there.records = {"run": run.record.replace(kind="static")}
    assert not there.correction(run.simulation.arm).any()


def test_a_softer_beam_is_no_gap_though_its_vibration_falls_out_of_step(run):
    """In 30 s of 2.4 Hz, 0.75 % of frequency are half a turn: far from proportional to the modulus."""
    nominal = run.simulation.arm
    nominal = nominal.replace(uncertainty={"links.rod.material.youngs_modulus": 0.01})
    key = "links.rod.material.youngs_modulus"
    modulus = nominal.link("rod").material.youngs_modulus
    record = seen(run, with_value(nominal, key, SOFTER * modulus))
    there = problem(nominal, record)
    estimator = Estimator.nominal(there, nuisance_model(there))
    centred = estimator.centred()
    before, after = estimator.fit(()), centred.fit(())
    assert after.cost < 0.1 * before.cost
    where = centred.nuisance.keys.index(key)
    assert after.projection.solve(after.residual)[where] == pytest.approx((SOFTER - 1) * modulus, rel=0.02)


def test_broydens_update_finds_what_differences_find(run, monkeypatch):
    """The same optimum, with fewer simulations."""
    nominal = run.simulation.arm
    there = JointCompliance(at="hinge", stiffness=1.0e5, damping=400.0)
    record = seen(run, nominal.with_effect(there))
    found, simulations = [], []
    for part in (0.0, FIT.step_missed):
        monkeypatch.setattr(least_squares, "FIT", replace(FIT, step_missed=part, tolerance=1e-4))
        both = problem(nominal, record)
        estimator = Estimator.nominal(both, nuisance_model(both))
        first = [c for c in candidates(both, estimator.nuisance.arm) if c.name == "joint_compliance"]
        fit = estimator.fit(first)
        found.append([fit.members[0].effect.stiffness, fit.members[0].effect.damping])
        simulations.append(both.simulations.made)
    assert found[0] == pytest.approx([1.0e5, 400.0], rel=0.05)  # steps of 8 ms, corrected for another spring
    assert found[1] == pytest.approx(found[0], rel=1e-2)  # the damping is known to a few per cent
    assert simulations[1] < simulations[0]


@pytest.mark.parametrize("part, finished", [(0.1, False), (2.0, True)], ids=["far", "near"])
def test_a_fit_that_stays_above_its_limit_is_not_finished(run, part, finished):
    """A damped link in the place of a soft joint leaves most of the gap, whatever its damping."""
    nominal = run.simulation.arm
    record = seen(run, nominal.with_effect(JointCompliance(at="hinge", stiffness=1.0e5, damping=400.0)))
    both = problem(nominal, record)
    estimator = Estimator.nominal(both, nuisance_model(both))
    damped = [c for c in candidates(both, estimator.nuisance.arm) if c.name == "link_damping"]
    made = both.simulations.made
    whole = estimator.fit(damped)
    needed, made = both.simulations.made - made, both.simulations.made
    both._residuals.clear()
    both.simulations._runs.clear()
    limited = estimator.fit(damped, limit=part * whole.cost)
    if finished:
        assert limited.cost == whole.cost
    else:
        assert both.simulations.made - made < needed
        assert whole.cost < limited.cost
        assert limited.jacobian.shape == whole.jacobian.shape


def test_a_fit_that_comes_below_its_limit_in_the_end_is_finished(run):
    """A soft joint, from as far as it starts: the limit is ten times what the right model leaves."""
    nominal = run.simulation.arm
    record = seen(run, nominal.with_effect(JointCompliance(at="hinge", stiffness=1.0e5, damping=400.0)))
    both = problem(nominal, record)
    estimator = Estimator.nominal(both, nuisance_model(both))
    spring = [c for c in candidates(both, estimator.nuisance.arm) if c.name == "joint_compliance"][:1]
    whole = estimator.fit(spring)
    assert whole.cost < 1e-2 * estimator.fit(()).cost
    assert estimator.fit(spring, limit=10 * whole.cost).cost == whole.cost


def test_a_trial_that_starts_beside_a_model_spares_its_derivatives(run):
    """A mass beside a spring that is known: to the same optimum, with fewer simulations."""
    nominal = run.simulation.arm
    [load] = nominal.payloads
    soft = nominal.with_effect(JointCompliance(at="hinge", stiffness=1.0e5, damping=400.0))
    record = seen(run, soft.with_effect(PayloadMass(at=load.name, mass=0.97 * load.mass)))
    both = problem(nominal, record)
    estimator = Estimator.nominal(both, nuisance_model(both))
    every = candidates(both, estimator.nuisance.arm)
    spring = [c for c in every if c.name == "joint_compliance"][:1]
    mass = [c for c in every if c.place == ("payload_mass", load.name)][:1]
    known = estimator.fit(spring)
    made, found = [], []
    for tried in (lambda members: estimator.fit(members), lambda members: estimator.trial(members, known)):
        both._residuals.clear()
        both.simulations._runs.clear()
        before = both.simulations.made
        found.append(tried((*known.members, *mass)))
        made.append(both.simulations.made - before)
    assert made[1] < made[0] - len(known.z)  # nor differences at the end
    assert found[1].cost == pytest.approx(found[0].cost, rel=1e-2)
    assert found[1].jacobian.shape == found[0].jacobian.shape


def test_what_steps_miss_is_kept_where_a_model_hardly_moves(run):
    """It moves as the motion does, of which it is a part: kept below a tenth of a sigma."""
    key = "links.rod.material.youngs_modulus"
    nominal = run.simulation.arm.replace(uncertainty={key: 0.05})
    modulus = nominal.link("rod").material.youngs_modulus
    both = problem(nominal, run.record, step=4e-3)
    estimator = Estimator.nominal(both, nuisance_model(both))
    k = estimator.nuisance.keys.index(key)
    for part, kept in ((1e-7, True), (1e-3, False)):
        at = np.where(np.arange(len(estimator.at)) == k, part * modulus, 0.0)
        assert (estimator._moved(at, ()).correction is estimator.correction) == kept


def test_a_frequency_is_found_to_a_small_part_of_a_turn(run):
    """A search starts up to an eighth of a turn off; a hundredth of a sigma is half a turn in 30 s."""
    base = BaseCompliance(at="base", stiffness=3e6, damping=3e3)
    nominal = run.simulation.arm.with_effect(base)
    there = ExternalVibration(at="base", amplitude=60.0, frequency=1.7, phase=0.6)
    record = seen(run, nominal.with_effect(there))
    both = problem(nominal, record, step=4e-3)
    estimator = Estimator.nominal(both, nuisance_model(both))
    start = 1.7 + 0.12 / both.seconds
    tried = candidates(both, estimator.nuisance.arm, (start,))
    fit = estimator.fit([c for c in tried if c.name == "external_vibration"])
    found = fit.members[0].effect
    assert found.frequency == pytest.approx(1.7, abs=5e-3 / both.seconds)
    assert (found.amplitude, found.phase) == pytest.approx((60.0, 0.6), rel=0.02)


@pytest.mark.parametrize("part, kept", [(0.001, True), (0.05, False)], ids=["a little", "far"])
def test_derivatives_by_unknowns_are_kept_where_they_foretold_the_step(run, part, kept):
    """Of phases that a modulus turns: 1/1000 of it by 0.2 rad in half a minute, 1/20 by turns."""
    key = "links.rod.material.youngs_modulus"
    nominal = run.simulation.arm.replace(uncertainty={key: 0.05})
    modulus = nominal.link("rod").material.youngs_modulus
    both = problem(nominal, seen(run, with_value(nominal, key, (1 + part) * modulus)), step=4e-3)
    estimator = Estimator.nominal(both, nuisance_model(both))
    found = estimator.fit(())
    k = estimator.nuisance.keys.index(key)
    there = estimator.towards(found)
    assert (there.jacobian is estimator.jacobian) == kept
    assert there.at[k] == pytest.approx(found.projection.solve(found.residual)[k], rel=1e-3)
    assert not np.array_equal(there.correction, estimator.correction)


def test_derivatives_beside_other_effects_are_taken_anew(run):
    both = problem(run.simulation.arm, run.record, step=4e-3)
    estimator = Estimator.nominal(both, nuisance_model(both))
    spring = [c for c in candidates(both, estimator.nuisance.arm) if c.name == "joint_compliance"][:1]
    assert estimator.towards(estimator.linearised(spring)).members != estimator.members


def test_a_value_that_an_effect_overrules_stays_where_it_was(run):
    """A load's mass beside an effect that states it: moved along at no cost, it would replace the effect."""
    nominal = run.simulation.arm
    [load] = nominal.payloads
    nominal = nominal.replace(uncertainty={f"payloads.{load.name}.mass": 0.005})
    lighter = PayloadMass(at=load.name, mass=0.93 * load.mass)
    both = problem(nominal, seen(run, nominal.with_effect(lighter)), step=4e-3)
    estimator = Estimator.nominal(both, nuisance_model(both))
    fit = estimator.fit([c for c in candidates(both, estimator.nuisance.arm) if c.name == "payload_mass"])
    about = estimator.about(fit)
    assert about.arm.payload(load.name).mass == load.mass
    assert about.fit(()).cost > 100 * about.fit(fit.members).cost


def test_a_stiffer_joint_is_no_gap_though_only_an_absurd_modulus_seems_to_explain_it(run):
    """Linear steps would go to a modulus 26 sigmas off; held to two, the joint's spring goes where it is."""
    nominal = run.simulation.arm.replace(uncertainty={STIFF: 0.3, "links.rod.material.youngs_modulus": 0.02})
    stiffness = nominal.effect("joint_compliance", "hinge").stiffness
    there = problem(nominal, seen(run, with_value(nominal, STIFF, 1.25 * stiffness)))
    estimator = Estimator.nominal(there, nuisance_model(there))
    far = estimator.fit(())
    strained = np.abs(far.projection.solve(far.residual)) / far.nuisance.sigma
    assert strained[far.nuisance.keys.index("links.rod.material.youngs_modulus")] > 5
    fit = estimator.centred().fit(())
    assert fit.cost < 1e-3 * far.cost
    where = fit.nuisance.keys.index(STIFF)  # 2 % of the modulus bend the arm as 5 % of the spring do
    assert fit.projection.solve(fit.residual)[where] == pytest.approx(0.25 * stiffness, rel=0.2)


def test_best_within_bounds_is_that_of_bounded_least_squares():
    rng = np.random.default_rng(4)
    jacobian, sigma = rng.normal(size=(40, 3)), np.array([0.5, 2.0, 1.0])
    residual = -jacobian @ [3.0, -1.0, 0.5]
    projection = Projection(jacobian, sigma)
    assert projection.solve_within(residual, np.full(3, np.inf)) == pytest.approx(projection.solve(residual))
    found = projection.solve_within(residual, np.array([1.0, np.inf, np.inf]))
    assert found[0] == pytest.approx(1.0)
    free = Projection(jacobian[:, 1:], sigma[1:])
    assert found[1:] == pytest.approx(free.solve(residual + jacobian[:, 0]), rel=1e-6)


def test_the_model_as_stated_is_that_wherever_its_values_were_centred(run):
    nominal = run.simulation.arm.replace(uncertainty={STIFF: 0.3})
    stiffness = nominal.effect("joint_compliance", "hinge").stiffness
    there = problem(nominal, seen(run, with_value(nominal, STIFF, 1.25 * stiffness)))
    estimator = Estimator.nominal(there, nuisance_model(there))
    centred = estimator.centred()
    assert centred.at.any()
    raw = there.residual(estimator.nuisance.arm)
    assert centred.nominal_residual() - centred.correction == pytest.approx(raw, abs=1e-9)
