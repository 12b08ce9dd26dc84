"""The virtual mock-up against statics, energy and what its sensors promise."""

from __future__ import annotations

import numpy as np
import pytest
from pytest import approx

from flexarm import Drive, InvalidParameter, Record, Simulation, modes, simulate, static
from flexarm.mockup import PARAMETER_SETS, Experiment, mock_up, model, virtual_measurement

SHORT = Experiment(amplitude=0.6, period=12.0, duration=12.0, rest=3.0)


@pytest.fixture(scope="module")
def short() -> tuple[Record, Simulation]:
    """One small period on the virtual mock-up, and the rest after it."""
    return virtual_measurement(SHORT, seed=7)


def test_both_parameter_sets_of_table_1_ship_and_only_the_printed_one_is_doubted() -> None:
    """Rod mass rho A L: 13.7 kg with the area that wall and second moment give, 1.4 kg as printed."""
    mass = {}
    for name in PARAMETER_SETS:
        tube = model(name).link("tube")
        mass[name] = 7850 * tube.section.area * 3.0  # type: ignore[union-attr]
    assert mass == approx({"consistent": 13.7, "printed": 1.39}, rel=5e-3)
    assert not model().warnings
    assert "contradict" in str(model("printed").warnings[0])
    with pytest.raises(InvalidParameter, match="consistent, printed"):
        model("table 2")


def test_tip_of_the_resting_mock_up_sags_as_in_statics() -> None:
    """Held still at 0.6 rad the controlled arm stays where `static` puts it: PI control, friction at zero."""
    bench = mock_up()
    still = Drive.from_samples([0.0, 0.5], {"hinge": [0.6, 0.6]}, side="command")
    run = simulate(bench, still, step=1e-3)
    wanted = static(bench, joints={"hinge": 0.6})
    # The encoder's step lets the controller move the motor by a few of them: 1.3e-5 rad on 3 m.
    assert run.position[-1, 1] == approx(wanted.position[1], abs=3 * 1.3e-5 * 3)
    beam_and_hinge = 14.1 * 9.81 * 27 / (3 * 210e9 * 2.37e-7) + 14.1 * 9.81 * 9 / 1e5
    rod = 13.7 * 9.81 * 27 / (8 * 210e9 * 2.37e-7) + 13.7 * 9.81 * 4.5 / 1e5
    sag = float(np.linalg.norm(wanted.displacement[1]))
    # Small deflection, normal part of gravity; the axial part adds about 4 % as geometric stiffness.
    assert sag == approx((beam_and_hinge + rod) * np.sin(0.6), rel=0.06)


def test_energy_of_the_mock_up_balances_and_friction_only_takes(short: tuple[Record, Simulation]) -> None:
    """Kinetic + elastic + gravity = work - damped + constant; what is damped never comes back."""
    run = short[1]
    total = run.kinetic + run.elastic + run.gravity + run.damped - run.work
    assert np.ptp(total) < 2e-3 * run.damped[-1]
    # Dahl's friction gives back what little it stores before slipping: T_c w = 8 N m 2e-5 rad.
    assert np.diff(run.damped).min() > -1e-3
    assert run.damped[-1] > 4 * 0.6 * (40 + 8)  # Coulomb torques over the path of the swing


def test_measurement_is_a_record_that_says_what_it_is(short: tuple[Record, Simulation]) -> None:
    record, truth = short
    assert "virtual" in record.description
    assert record.drive == ("encoder",)
    encoder, tip = record.signals["encoder"], record.signals["tip"]
    steps = encoder.values[:, 0] / 1.278317e-5
    assert steps == approx(np.round(steps), abs=1e-6)
    assert encoder.rate_hz == approx(500)
    assert tip.rate_hz == approx(10)
    late = record.clocks["tracker"].sigma
    within = tip.time <= truth.time[-1]  # the last stamp may be later than the run
    off = tip.values[within] - truth.at(tip.time[within], "tip")
    speed = np.abs(np.gradient(truth.position[:, 1, 0], truth.time)).max()
    # noise, and clock and frame errors of at most four of their stated sigmas
    assert within[:-1].all()
    assert np.abs(off).max() < 5 * 5e-5 + 4 * (late * speed + 1e-4 + 3e-5 * 3)


def test_measurement_depends_on_the_seed_alone() -> None:
    brief = Experiment(amplitude=0.1, period=2.0, duration=1.0, rest=0.0)
    first, second, third = (virtual_measurement(brief, seed=seed)[0] for seed in (1, 1, 2))
    assert first == second
    assert first != third


def test_controller_follows_the_sine_and_shakes_the_arm_in_its_first_mode(
    short: tuple[Record, Simulation],
) -> None:
    """The lag is that of the position loop, rate/K_p; the tip rings at the first mode after the stop."""
    run = short[1]
    j = 0
    lag = run.joint_command[:, j] - run.drive_angle[:, j]  # type: ignore[index]
    moving = (run.time > 6) & (run.time < 12)
    rate = 0.6 * 2 * np.pi / 12
    assert np.abs(lag[moving]).max() == approx(rate / 4.0, rel=0.1)
    after = run.time >= 12.5
    ringing = run.position[after, 1, 0]
    spectrum = np.abs(np.fft.rfft((ringing - ringing.mean()) * np.hanning(len(ringing))))
    found = np.fft.rfftfreq(len(ringing), 1e-3)[np.argmax(spectrum[1:]) + 1]
    first = modes(model(), count=1).frequency_hz[0]
    assert found == approx(first, abs=0.4)  # the window resolves 1/2.5 s
    assert np.ptp(ringing) > 1e-4


def test_hanging_mock_up_swings_about_its_lowest_point() -> None:
    brief = Experiment(amplitude=0.1, period=4.0, duration=1.0, rest=0.0, hanging=True)
    run = simulate(model(), brief.pure_sine(), end=brief.end)
    assert run.position[0, 1] == approx([0, 0, -3.0], abs=1e-3)


def test_experiment_refuses_what_cannot_be() -> None:
    with pytest.raises(InvalidParameter, match="period"):
        Experiment(period=0.0)
    with pytest.raises(InvalidParameter, match="rest"):
        Experiment(rest=-1.0)
