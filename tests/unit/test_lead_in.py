"""Records that begin in motion: drives come from rest, and the arm arrives as if it had been seen before."""

from dataclasses import replace

import numpy as np
import pytest
from arms import crane

import flexarm
from flexarm.arm.parameter import neighbours, parameters
from flexarm.drive.joint_drive import JointDrive
from flexarm.drive.lead_in import LEAD, led_in, with_pulse
from flexarm.record import Record, Signal

CUT, END = 5.0, 11.9
"""When the record begins of a motion that began long before, and up to when it is looked at [s]."""


def angle(t):
    """A swing of 0.3 rad in 8 s about 0.4 rad that is smooth from the start."""
    s = np.clip(t / 4.0, 0.0, 1.0)
    return 0.4 + 0.3 * np.sin(2 * np.pi * t / 8.0) * s**3 * (10 - 15 * s + 6 * s**2)


@pytest.fixture(scope="module")
def whole():
    """The motion from rest."""
    t = np.arange(0.0, 12.0, 0.01)
    return flexarm.Drive.from_samples(t, {"hinge": angle(t)})


@pytest.fixture(scope="module")
def cut():
    """A record of it that begins in motion, as exact as its stamps."""
    t = np.arange(CUT, 12.0, 0.01)
    encoder = Signal(
        name="encoder",
        quantity="joint_angle",
        joint="hinge",
        side="motor",
        time=t,
        values=angle(t),
    )
    return Record(signals=[encoder], drive=("encoder",), initial="moving")


def derivatives(drive, t):
    """Value, rate and acceleration."""
    return np.array(drive.polynomial()(t))


@pytest.mark.parametrize("samples", [2, 3, 40])
def test_angle_rate_and_acceleration_are_continuous_and_begin_at_rest(samples):
    t = np.linspace(1.0, 3.0, samples)
    drive = flexarm.Drive.from_samples(t, {"hinge": np.sin(t)}).joints["hinge"]
    led = led_in(drive)
    assert led.breaks[0] == 1.0 - LEAD
    assert derivatives(led, 1.0 - LEAD)[1:] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert derivatives(led, 1.0 - 1e-9) == pytest.approx(derivatives(drive, 1.0), abs=1e-7)
    inside = np.linspace(1.0, 3.0, 101)
    assert led(inside) == pytest.approx(drive(inside), abs=1e-14)


def test_noise_of_samples_that_are_joined_as_they_are_is_no_motion():
    """An encoder of 1 mrad at 1 kHz that stands, though its first rate is 1 rad/s, stood before."""
    t = np.arange(0.0, 2.0, 1e-3)
    samples = 0.5 + 1e-3 * np.random.default_rng(5).standard_normal(len(t))
    led = led_in(flexarm.Drive.from_samples(t, {"hinge": samples}).joints["hinge"])
    before = np.linspace(-LEAD, -1e-3, 4001)
    assert np.abs(led(before) - 0.5).max() < 0.2
    assert np.abs(np.gradient(led(before), before)).max() < 0.15


@pytest.mark.parametrize("before", [0.0, 0.15])
def test_a_jerk_is_as_high_as_asked_and_gone_before_the_record(before):
    led = led_in(JointDrive(np.array([0.0, 1.0]), np.array([[0.3], [0.1]])))
    jerk = with_pulse(led, before, 0.4, 1e-3)
    t = np.linspace(-LEAD, 1.0, 20001)
    more = jerk(t) - led(t)
    assert more.max() == pytest.approx(1e-3, rel=1e-6)
    assert t[more.argmax()] == pytest.approx(-before - 0.2, abs=1e-3)
    outside = (t < -before - 0.4) | (t > -before)
    assert np.abs(more[outside]).max() < 1e-12


def test_the_arm_arrives_as_if_it_had_been_seen_before(whole, cut):
    """Within 0.1 mm where starting at rest rings by centimetres: 6 v L/(omega^3 T^2) are 0.05 mm."""
    arm = crane()
    seen = flexarm.simulate(arm, whole)
    found, at_rest = (flexarm.simulate(arm, each) for each in (cut, cut.replace(initial="equilibrium")))
    assert found.time[0] == pytest.approx(CUT, abs=1e-12)
    t = found.time[found.time < END]
    apart = [np.abs(run.at(t, "tip") - seen.at(t, "tip")).max() for run in (found, at_rest)]
    assert apart[0] < 1e-4
    assert apart[1] > 1e-2


def test_what_sums_up_counts_from_where_the_record_begins(cut):
    """Energy balances over the record alone."""
    arm = crane()
    run = flexarm.simulate(arm, cut, energies=True)
    again = flexarm.simulate(arm, cut)
    assert run.damped[0] == run.work[0] == 0.0
    held = (run.kinetic + run.elastic + run.gravity + run.damped - run.work)[run.time < END]
    assert np.abs(held - held[0]).max() < 1e-3 * np.abs(run.work).max()
    assert again.work == pytest.approx(run.work, abs=0)


def test_derivatives_are_of_the_same_instants(cut):
    """By the modulus, beside a difference of runs."""
    arm, key = crane(), "links.rod.material.youngs_modulus"
    run = flexarm.simulate(arm, cut, sensitivities=[key])
    (above, up), (below, down) = neighbours(arm, parameters(arm, [key])[0], 1e-4 * 2.1e11)
    tips = [flexarm.simulate(each, cut).position for each in (above, below)]
    slope = (tips[0] - tips[1]) / (up - down)
    exact = run.sensitivities["position"][..., 0]
    assert exact == pytest.approx(slope, abs=1e-4 * np.abs(slope).max())


def test_readings_before_the_first_step_go_on_with_the_motion(whole, cut):
    """A tracker that is 5 ms early saw the tip 5 ms earlier, not where the record begins."""
    arm = crane()
    seen, run = flexarm.simulate(arm, whole), flexarm.simulate(arm, cut)
    early = [CUT - 5e-3]
    assert run.at(early, "tip") == pytest.approx(seen.at(early, "tip"), abs=4e-4)
    assert np.abs(run.at(early, "tip") - run.position[0, run.points.index("tip")]).max() > 5e-4


def test_poses_and_commands_have_no_lead(cut):
    assert flexarm.Drive.from_record(cut, crane()).lead == LEAD
    still = cut.replace(initial="equilibrium")
    assert flexarm.Drive.from_record(still, crane()).lead == 0.0
    assert replace(flexarm.Drive.from_record(cut, crane()), lead=0.0).start == CUT
