"""Energies of a run are the same, whether recorded with it or asked for later."""

import numpy as np
import pytest
from arms import compliance, drive, paper_arm, smooth_step

import flexarm
from flexarm import _core

NAMES = ("kinetic", "elastic", "gravity", "damped", "work")
STEP = 5e-3


@pytest.fixture
def arm() -> flexarm.Arm:
    friction = {"name": "coulomb_friction", "at": "hinge", "torque": 6.0}
    effects = [compliance("hinge", 1e5), friction]
    return flexarm.Arm.from_dict(paper_arm(2, damping_ratio=0.01).to_dict() | {"effects": effects})


@pytest.fixture
def swing() -> flexarm.Drive:
    return drive({"hinge": lambda t: 0.6 * smooth_step(t)}, 1.2, 601)


def assert_same(one: flexarm.Simulation, other: flexarm.Simulation) -> None:
    for name in NAMES:
        assert np.array_equal(getattr(one, name), getattr(other, name)), name


@pytest.mark.parametrize("options", [{}, {"dimension": "space"}, {"alpha": -0.2, "forces": True}])
def test_asked_for_later_they_are_those_of_the_run(arm, swing, options):
    """A second run makes the same steps: not a bit differs."""
    recorded = flexarm.simulate(arm, swing, step=STEP, energies=True, **options)
    plain = flexarm.simulate(arm, swing, step=STEP, **options)
    assert recorded.damped[-1] > 0.1
    assert_same(plain, recorded)


def test_they_are_computed_once(arm, swing):
    run = flexarm.simulate(arm, swing, step=STEP)
    assert run.energies is run.energies
    assert run.work is run.energies.work


def test_a_run_with_derivatives_has_them(arm, swing):
    smooth = arm.without_effect("coulomb_friction", at="hinge")
    key = "links.rod.material.youngs_modulus"
    plain = flexarm.simulate(smooth, swing, step=STEP, sensitivities=[key])
    recorded = flexarm.simulate(smooth, swing, step=STEP, sensitivities=[key], energies=True)
    assert_same(plain, recorded)


def test_a_stopped_run_has_them_up_to_its_end(arm, swing):
    """The second run ends where the first was stopped."""
    whole = flexarm.simulate(arm, swing, step=1e-5, end=1.0, energies=True)
    stopped = flexarm.simulate(arm, swing, step=1e-5, end=1.0, progress=lambda done: done < 0.1)
    n = len(stopped.time)
    assert n < len(whole.time)
    assert np.array_equal(stopped.kinetic, whole.kinetic[:n])


def test_plain_runs_record_none(arm, swing, monkeypatch):
    """What is not asked for costs nothing: the core gets no order to sum energies."""
    orders = []
    core = _core.simulate
    monkeypatch.setattr(_core, "simulate", lambda *a: orders.append(a[3].record_energies) or core(*a))
    run = flexarm.simulate(arm, swing, step=STEP)
    assert orders == [False]
    assert run.kinetic.shape == run.time.shape
    assert orders == [False, True]


def test_a_stored_run_keeps_them(arm, swing, tmp_path):
    run = flexarm.simulate(arm, swing, step=STEP)
    run.save(tmp_path / "run.nc")
    assert_same(flexarm.Simulation.load(tmp_path / "run.nc"), run)
