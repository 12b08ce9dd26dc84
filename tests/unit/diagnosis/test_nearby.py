"""Probes about a fit: what effects move beside a rod of twice its mass, with which an arm rings otherwise."""

from dataclasses import replace

import numpy as np
import pytest
from planted import run_of

import flexarm
from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.moves import search_state as module
from flexarm.diagnosis.moves.search_state import rescreened
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.policy import FIT
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.screening import LONGER, probe, screen
from flexarm.effects import LinkMass, PayloadInertia
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.measurement import predict
from flexarm.record import Clock

HEAVIER, INERTIA = LinkMass(at="rod", scale=2.0), PayloadInertia(at="load", inertia=0.5)
LOAD, CLOCK = ("payload_inertia", "load"), ("time_delay", "tracker")
NOISE = 3
"""Seed."""


@pytest.fixture(scope="module")
def heavier():
    """A rod of twice its mass as it is fitted, beside a machine whose load turns less easily too.

    The tracker has a clock, known to 2 ms.
    """
    run = run_of("one joint")
    nominal = run.simulation.arm
    clocks = {**run.record.clocks, "tracker": Clock(sigma=2e-3)}
    simulation = flexarm.simulate(nominal.with_effect(HEAVIER).with_effect(INERTIA), run.record, step=4e-3)
    rng = np.random.default_rng(NOISE)
    signals = [
        s if s.name in run.record.drive
        else s.replace(values=(exact := predict(simulation, s)) + s.noise_std * rng.normal(size=exact.shape))
        for s in run.record.signals.values()
    ]  # fmt: skip
    signals = [s.replace(clock="tracker") if s.quantity == "position" else s for s in signals]
    record = run.record.replace(signals=signals, clocks=clocks)
    problem = Problem(nominal, {"run": record}, step=4e-3)
    estimator = Estimator.nominal(problem, nuisance_model(problem))
    probed = probe(estimator, candidates(problem, estimator.nuisance.arm))
    rod = next(p.candidate for p in probed if p.candidate.place == ("link_mass", "rod"))
    fit = estimator.linearised((replace(rod, effect=HEAVIER),))
    about = estimator.about(fit)
    fit = about.linearised(fit.members)
    return about, probed, fit, rescreened(about, probed, fit)


def of(probed, *places):
    return [p for p in probed if p.candidate.place in places]


def test_what_is_missing_beside_a_fit_shows_about_it_and_not_about_the_nominal_model(heavier):
    """About that it would have to have the other sign."""
    estimator, probed, fit, near = heavier
    first = screen(estimator, near, fit)[0]
    assert first.places == (LOAD,)
    assert (1 - first.share) * fit.cost < 1.1 * len(estimator.problem)
    # The rod's mass moves along, to first order.
    assert first.members[0].effect.inertia == pytest.approx(INERTIA.inertia, rel=0.2)
    assert LOAD not in {s.places[0] for s in screen(estimator, probed, fit)}


def test_small_steps_are_derivatives_about_the_fit(heavier):
    """Those of another step: a tenth of a probe bends by less than a hundredth."""
    estimator, _, fit, near = heavier
    [load] = of(near, LOAD)
    problem = estimator.problem.with_step(LONGER * estimator.problem.step)
    there = estimator.with_effects(fit.members)
    step = 100 * FIT.small_probe
    further = there.with_effect(load.candidate.nudged(0, step))
    move = (problem.residual(further) - problem.residual(there)) / step
    assert np.linalg.norm(load.moves[:, 0] - move) < 0.01 * np.linalg.norm(move)


def test_laws_with_corners_are_probed_at_full_size(heavier):
    """About the fit all the same: there are other torques that turn around."""
    estimator, probed, fit, near = heavier
    place = ("backlash", "hinge")
    [gap], [before] = of(near, place), of(probed, place)
    problem = estimator.problem.with_step(LONGER * estimator.problem.step)
    there = estimator.with_effects(fit.members)
    move = problem.residual(there.with_effect(gap.candidate.probes[0])) - problem.residual(there)
    np.testing.assert_allclose(gap.moves[:, 0], move)
    assert np.linalg.norm(gap.moves - before.moves) > 0.1 * np.linalg.norm(move)


def test_a_clock_moves_as_it_is_eliminated_and_costs_no_run(heavier):
    estimator, probed, fit, _ = heavier
    made = estimator.problem.simulations.made
    [clock] = rescreened(estimator, of(probed, CLOCK), fit)
    k = fit.nuisance.keys.index("effects.time_delay.tracker.delay")
    slope = fit.projection.jacobian[:, k]
    size = float(clock.moves[:, 0] @ slope) / float(slope @ slope)
    np.testing.assert_allclose(clock.moves[:, 0], size * slope, atol=1e-9 * np.abs(slope * size).max())
    assert estimator.problem.simulations.made == made


def test_what_a_fit_has_stays_as_it_was(heavier):
    _, probed, fit, near = heavier
    [rod], [before] = of(near, *fit.places), of(probed, *fit.places)
    assert rod is before


def test_springs_take_one_small_step_and_softer_ones_are_as_soft_as_they_were_probed(heavier):
    estimator, probed, fit, _ = heavier
    [base] = of(probed, ("base_compliance", "base"))
    soft = base.candidate.probes[0].replace(stiffness=1e4)
    small, full = rescreened(
        estimator, [base, replace(base, candidate=replace(base.candidate, probes=(soft,)))], fit
    )
    problem = estimator.problem.with_step(LONGER * estimator.problem.step)
    there = estimator.with_effects(fit.members)
    np.testing.assert_allclose(
        full.moves[:, 0], problem.residual(there.with_effect(soft)) - problem.residual(there)
    )
    moved = there.with_effect(base.candidate.nudged(0, FIT.small_probe))
    np.testing.assert_allclose(
        small.moves[:, 0] * FIT.small_probe, problem.residual(moved) - problem.residual(there), atol=1e-9
    )


def test_a_law_stays_as_it_was_where_its_steps_cannot_be_made(heavier, monkeypatch):
    estimator, probed, fit, _ = heavier
    load = of(probed, LOAD)

    def refused(*_):
        raise InvalidParameter("mass must be positive")

    monkeypatch.setattr(Candidate, "nudged", refused)
    assert rescreened(estimator, load, fit) == load


def test_a_fit_that_cannot_be_simulated_in_longer_steps_leaves_all_as_it_was(heavier, monkeypatch):
    estimator, probed, fit, _ = heavier
    load = of(probed, LOAD)

    def fails(*_):
        raise NotConverged("no step")

    monkeypatch.setattr(module, "small_steps", fails)
    assert rescreened(estimator, load, fit) == load
