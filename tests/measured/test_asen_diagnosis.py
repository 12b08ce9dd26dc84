"""What a diagnosis may say of the ASEN arm, whose motor follows commands: an offset, and friction.

The whole diagnosis of its page takes minutes. Here stand its repair on all readings, and on every tenth the
search among what is nearest, and how well models foretell what is left out.
"""

import numpy as np
import pytest
from tests.helpers.example_scripts import load_script

import flexarm
from flexarm import Arm, Record
from flexarm.arm.effect import read_effect
from flexarm.arm.motor_limits import stall_torque
from flexarm.arm.parameter import with_value
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.cross_validation import press_rms
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.moves.proposals import fit_singles
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.screening import probe
from flexarm.diagnosis.selection import best_of

SCRIPT = load_script("asen_flexible_arm", "make_records")
REPAIR = (
    {"name": "sensor_offset", "at": "tip", "offset": -0.02991},
    {"name": "motor_friction", "at": "hub", "coulomb": 8.03e-3, "viscous": 0.04465},
)
REFINED = {
    "joints.hub.rotor_inertia": 1.504e-6,
    "links.ruler.material.youngs_modulus": 1.687e11,
    "payloads.tip_mass.mass": 0.0517,
}
THINNED = 10
NEAREST = {
    ("sensor_offset", "tip"),
    ("motor_friction", "hub"),
    ("viscous_friction", "hub"),
    ("time_delay", "reference"),
    ("time_delay", "hub_rate"),
    ("clock_drift", "hub"),
}
"""What explains most beside nothing, and beside the offset."""


@pytest.fixture(scope="module")
def tests(shared_dir, tmp_path_factory):
    """Model and record of both tests, by name."""
    out = tmp_path_factory.mktemp("asen") / "records"
    folders = SCRIPT.make_records(shared_dir / "data/asen_flexible_arm", out)
    return {f.name: (Arm.from_toml(f / "arm.toml"), Record.load(f / "by_reference")) for f in folders}


@pytest.fixture(scope="module")
def bench(tests):
    """Every tenth reading of test 3, a estimator, and all that could be there, by name and place."""
    arm, record = tests["test_3"]
    few = record.replace(
        signals=[
            s if s.name in record.drive else s.replace(values=s.values[::THINNED], time=s.time[::THINNED])
            for s in record.signals.values()
        ]
    )
    problem = Problem(arm, {"test_3": few}, step=4e-3)
    estimator = Estimator.nominal(problem, nuisance_model(problem))
    return problem, estimator, {each.place: each for each in candidates(problem, estimator.nuisance.arm)}


@pytest.fixture(scope="module")
def fits(bench):
    """Models with the offset and one effect more."""
    problem, estimator, found = bench
    offset = found["sensor_offset", "tip"]

    def fitted(*members):
        fit = estimator.fit(members)
        return estimator.about(fit).fit(fit.members)

    names = ("motor_friction", "viscous_friction", "time_delay")
    return problem, estimator.fit(()), {name: fitted(offset, found[name, "hub"]) for name in names}


def rms(arm, record):
    """Of hub [mrad] and deflection [mm]; the deflection's clock is aligned."""
    signals = flexarm.compare(arm, record).signals
    return tuple(1e3 * signals[name].rms["total"] for name in ("hub", "tip"))


def test_offset_and_friction_of_the_motor_close_the_gap_of_both_tests(tests):
    """Fitted to test 3; the file of test 2, with other gains, was held out. Bounds stand in the page."""
    for name, before, after in (
        ("test_3", (16.8, 31.1), (8.8, 3.7)),
        ("test_2", (20.8, 31.1), (13.3, 3.6)),
    ):
        arm, record = tests[name]
        assert rms(arm, record) == pytest.approx(before, rel=5e-3)
        for table in REPAIR:
            arm = arm.with_effect(read_effect(table))
        for key, value in REFINED.items():
            arm = with_value(arm, key, value)
        hub, tip = rms(arm, record)
        assert hub < after[0]
        assert tip < after[1]


def test_the_search_takes_the_offset_and_then_friction_of_the_motor(bench):
    """By evidence at the values of the fits a bearing's friction came first: beside the offset they bend the
    nominal mass by twenty sigmas. A rate that is read late is worth most by noise and correlation, and closes
    no gap.
    """
    _, estimator, found = bench
    nearest = probe(estimator, [each for place, each in found.items() if place in NEAREST])
    assert len({each.candidate.place for each in nearest}) == len(NEAREST)
    null = estimator.fit(())
    criteria = Criteria(estimator.problem, null)
    one, about = best_of(estimator, fit_singles(estimator, nearest, null, criteria), null, criteria)
    assert one.places == (("sensor_offset", "tip"),)
    two, _ = best_of(about, fit_singles(about, nearest, one, criteria), one, criteria)
    assert set(two.places) == {("sensor_offset", "tip"), ("motor_friction", "hub")}


def test_friction_foretells_what_is_left_out_and_a_late_reading_does_not(fits):
    """The tempting one: an angle that is read late explains more of the squared gap to first order."""
    problem, null, found = fits
    left = {name: press_rms(fit, problem) for name, fit in found.items()}
    assert left["motor_friction"] < left["viscous_friction"] < 0.4 * press_rms(null, problem)
    assert left["viscous_friction"] < 0.9 * left["time_delay"]


def test_what_the_fit_finds_is_plausible_for_a_machine_of_this_size(tests, fits):
    offset, friction = (member.effect for member in fits[2]["motor_friction"].members)
    assert np.max(offset.offset) == pytest.approx(-0.030, abs=0.001)
    assert 0.003 < friction.coulomb < 0.02
    assert 0.035 < friction.viscous < 0.06
    assert stall_torque(tests["test_3"][0], "hub") == pytest.approx(1.574, abs=1e-3)
