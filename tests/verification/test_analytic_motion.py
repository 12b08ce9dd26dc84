"""Motions of equations (1) and (2): conserved quantities, limits, closed forms and the swing benchmark."""

import math

import numpy as np
import pytest
from pytest import approx
from scipy.interpolate import CubicSpline
from scipy.special import ellipk

from flexarm.analytic import (
    CoulombFriction,
    FlexibleLink,
    JointTorque,
    LinearModal,
    MotorAngle,
    NonlinearModal,
    RampedSine,
    pinned_free_basis,
    rigid_tip,
    simulate,
)
from flexarm.errors import InvalidParameter, NotConverged

EI, RHO_A, L, LOAD, G = 210e9 * 2.37e-7, 7850 * 5.82e-4, 3.0, 14.1, 9.81
LINK = FlexibleLink(L, EI, RHO_A, LOAD)
STIFF = FlexibleLink(L, 1e4 * EI, RHO_A, LOAD)
SPRING = 1e5
SWING = RampedSine(1.2, 0.05, 4.0)
INSTANTS = np.array([0.0, 2.0, 5.0, 10.0, 15.0])
CONVERGED = np.array([-21.45680, -47.96946, 0.85701, 46.34499]) * 1e-3
"""Tangential offsets [m] of the swing at 2, 5, 10 and 15 s, Euler-Bernoulli, converged in space and time."""


def held(angle):
    """A motor that stands still."""
    return lambda t, nu=0: angle if nu == 0 else 0.0


def arm(n_bending=4, link=LINK, **options):
    return NonlinearModal(pinned_free_basis(link, n_bending), **options)


def observed_order(h, error):
    return np.polyfit(np.log(h), np.log(np.abs(error)), 1)[0]


def test_equation_1_reaches_the_swing_benchmark():
    """Within 0.5 µm of converged geometrically exact beams, at 1.2 rad and 48 mm."""
    motion = simulate(arm(4, hanging=True), MotorAngle(SWING, SPRING), INSTANTS, step=5e-3)
    assert motion.tangential[1:] == approx(CONVERGED, abs=0.5e-6)


def test_equation_2_misses_the_swing_by_gravitys_stiffness():
    """It sags 0.7 % too far, a third of a millimetre: gravity stiffens the hanging arm, (L1) leaves that
    out.
    """
    linear = LinearModal(arm(4).basis, hanging=True)
    motion = simulate(linear, MotorAngle(SWING, SPRING), INSTANTS, step=5e-3)
    too_far = (motion.tangential[1:3] - CONVERGED[:2]) / CONVERGED[:2]
    assert too_far == approx([0.0164, 0.0068], abs=2e-4)


def test_modes_of_a_pinned_beam_alone_miss_the_swing_by_millimetres():
    """Without the shape that bends at the hub the error halves with twice the modes, from 4.8 mm at four."""
    basis = [pinned_free_basis(LINK, n, hub_moment_shape=False) for n in (4, 8, 16)]
    drive = MotorAngle(SWING, SPRING)
    error = [
        simulate(NonlinearModal(b, hanging=True), drive, INSTANTS[:3], step=0.02).tangential[2] - CONVERGED[1]
        for b in basis
    ]
    assert error[0] == approx(4.81e-3, abs=0.02e-3)
    assert observed_order([1 / 4, 1 / 8, 1 / 16], error) == approx(1.0, abs=0.1)


def test_two_shapes_are_enough_for_the_swing():
    """Steps of 10 ms; two shapes are within 4 µm of the benchmark, three within 2 µm."""
    for n_bending, step, tolerance in ((2, 0.01, 4e-6), (3, 0.01, 2e-6)):
        motion = simulate(arm(n_bending, hanging=True), MotorAngle(SWING, SPRING), INSTANTS, step=step)
        assert motion.tangential[1:] == approx(CONVERGED, abs=tolerance)


def test_a_stiff_arm_is_a_pendulum():
    """Period 4 sqrt(J_0/S g) K(sin(A/2)), also at 2.5 rad; at both turning points it stands still."""
    amplitude = 2.5
    link = FlexibleLink(L, 1e6 * EI, RHO_A, LOAD)
    period = (
        4 * math.sqrt(link.joint_inertia / (link.static_moment * G)) * ellipk(math.sin(amplitude / 2) ** 2)
    )
    time = np.array([0.0, period / 4, period / 2, period])
    motion = simulate(arm(1, link, hanging=True), JointTorque(), time, initial_angle=amplitude, step=2e-3)
    assert motion.joint_angle[[0, 2, 3]] == approx([amplitude, -amplitude, amplitude], abs=2e-5)
    assert motion.joint_angle[1] == approx(0.0, abs=2e-5)


def free_flight(printed):
    """Spinning without gravity and torque, bent at the start: energies and angular momentum over time."""
    spinning = NonlinearModal(pinned_free_basis(LINK, 2), gravity=0.0, printed=printed)
    q, v = np.zeros((2, 3))
    q[1], v[0] = 0.8, 3.0 / spinning.basis.rotation[0]
    motion = simulate(
        spinning, JointTorque(), np.linspace(0, 1, 41), initial_state=(q, v), method="DOP853", rtol=1e-10
    )
    kinetic, elastic, gravity = spinning.energies(motion.coordinates, motion.rates)
    coupling = np.einsum("ti,ij,tj->t", motion.coordinates, spinning.basis.Cw, motion.coordinates)
    momentum = (LINK.joint_inertia + coupling) * (motion.rates @ spinning.basis.rotation)
    assert not gravity.any()
    return kinetic + elastic, momentum


def test_free_rotation_keeps_energy_and_angular_momentum():
    """(J_0 + qᵀ Cw q) θ_dot and T + V stay as they are to the tolerance of the integration."""
    energy, momentum = free_flight(printed=False)
    assert energy == approx(np.full(41, energy[0]), rel=1e-8)
    assert momentum == approx(np.full(41, momentum[0]), rel=1e-8)


def test_the_printed_gyroscopic_term_loses_both():
    """Without the factor 2 of d/dt(qᵀ Cw q) energy and angular momentum wander, 10⁵ times the tolerance."""
    energy, momentum = free_flight(printed=True)
    assert np.ptp(energy) > 1e-3 * energy[0]
    assert np.ptp(momentum) > 1e-3 * momentum[0]


@pytest.mark.parametrize("stiffness", [SPRING, math.inf])
def test_the_drives_work_is_the_energy_of_the_arm(stiffness):
    """T + V + spring grows by ∫ τ φ_dot dt in an undamped swing under gravity."""
    swing, moving = RampedSine(1.2, 0.5, 0.4), arm(1)
    time = np.linspace(0, 0.6, 301)
    motion = simulate(moving, MotorAngle(swing, stiffness), time, method="DOP853")
    energy = sum(moving.energies(motion.coordinates, motion.rates))
    if math.isfinite(stiffness):
        energy = energy + stiffness * (motion.drive_angle - motion.joint_angle) ** 2 / 2
    power = motion.joint_torque * swing(time, 1)
    work = CubicSpline(time, power).antiderivative()(time)
    assert energy - energy[0] == approx(work, abs=1e-5 * np.ptp(energy))


def test_damping_takes_what_the_drive_brings_and_the_arm_does_not_keep():
    """With modal and joint damping the balance closes with ∫ (Σ 2 ζ ω v² + c twist_rate²) dt."""
    c, swing = 200.0, RampedSine(1.2, 0.5, 0.4)
    moving = arm(1, damping_ratio=0.05)
    time = np.linspace(0, 0.6, 301)
    motion = simulate(moving, MotorAngle(swing, SPRING, damping=c), time, method="DOP853")
    phi_rate = swing(time, 1)
    twist_rate = phi_rate - motion.rates @ moving.basis.hub_slope
    energy = sum(moving.energies(motion.coordinates, motion.rates))
    energy = energy + SPRING * (motion.drive_angle - motion.joint_angle) ** 2 / 2
    loss = motion.rates**2 @ moving.damping + c * twist_rate**2
    balance = CubicSpline(time, motion.joint_torque * phi_rate - loss).antiderivative()(time)
    assert energy - energy[0] == approx(balance, abs=1e-5 * np.ptp(energy))
    assert CubicSpline(time, loss).integrate(0, 0.6) > 0.01 * np.ptp(energy)


def test_equation_1_tends_to_equation_2_as_the_motion_gets_small():
    """Of a hanging arm under a torque, all that (2) leaves out is cubic in the motion."""
    nonlinear = arm(2, hanging=True, damping_ratio=0.01)
    linear = LinearModal(nonlinear.basis, hanging=True, damping_ratio=0.01)
    time, torque = np.linspace(0, 3, 31), np.array([2.0, 4.0, 8.0])

    def difference(size):
        drive = JointTorque(CubicSpline(np.linspace(0, 3, 7), size * np.array([0, 1, -1, 2, 1, -1, 0])))
        both = [simulate(equation, drive, time).coordinates for equation in (nonlinear, linear)]
        return np.abs(both[0] - both[1]).max() / np.abs(both[1]).max()

    relative = [difference(size) for size in torque]
    assert observed_order(torque, relative) == approx(2.0, abs=0.02)
    assert relative[0] < 2e-5


def test_equation_2_is_solved_exactly_at_any_step():
    """A torque step without gravity: q_0 = p_0 τ t²/2, q_i = p_i τ (1 - cos(ω_i t))/omega_i²."""
    basis, torque, time = pinned_free_basis(LINK, 5), 30.0, np.linspace(0, 1, 6)
    motion = simulate(LinearModal(basis, gravity=0.0), JointTorque(torque), time, step=1.0)
    t = time[:, None]
    bending = (1 - np.cos(basis.omega[1:] * t)) / basis.omega[1:] ** 2
    expected = torque * basis.hub_slope * np.hstack([t**2 / 2, bending])
    assert motion.coordinates == approx(expected, abs=1e-11)


def test_the_exponential_method_is_of_order_four_in_equation_1():
    """Against DOP853, in a swing of 1.2 rad in half a second that bends the arm by 0.2 m."""
    swing, moving = MotorAngle(RampedSine(1.2, 0.5, 0.4), SPRING), arm(1)
    time = np.array([0.0, 0.3, 0.6])
    reference = simulate(moving, swing, time, method="DOP853", rtol=1e-11, atol=1e-13).coordinates
    steps = np.array([1.25e-3, 2.5e-3, 5e-3])
    error = [np.abs(simulate(moving, swing, time, step=h).coordinates - reference).max() for h in steps]
    assert observed_order(steps, error) == approx(4.0, abs=0.2)
    assert error[0] < 1e-5


def test_a_stiff_spring_is_a_rigid_joint():
    """The tip follows as 1/k."""
    swing, time = RampedSine(0.3, 0.25, 1.0), np.array([0.0, 0.5, 1.0])
    rigid = simulate(arm(2), MotorAngle(swing), time, step=2e-3)
    springs = [simulate(arm(2), MotorAngle(swing, k), time, step=2e-3) for k in (1e7, 2e7)]
    gap = [np.abs(soft.tangential - rigid.tangential).max() for soft in springs]
    assert gap[0] / gap[1] == approx(2.0, rel=0.05)
    assert rigid.joint_angle == approx(rigid.drive_angle, abs=1e-12)


def test_a_stiff_arm_on_a_rigid_joint_is_the_rigid_arm():
    """The tip tends to L (sin φ, cos φ) as 1/EI, upright and hanging."""
    for hanging in (False, True):
        offsets = []
        for factor in (1e3, 1e4):
            link = FlexibleLink(L, factor * EI, RHO_A, LOAD)
            motion = simulate(arm(2, link, hanging=hanging), MotorAngle(SWING), INSTANTS[:3], step=0.02)
            offsets.append(np.abs(motion.tip - rigid_tip(L, motion.drive_angle, hanging)).max())
        assert offsets[0] / offsets[1] == approx(10.0, rel=0.01)


def test_nothing_moves_under_a_motor_that_stands():
    """The start is an equilibrium, of equation (1) as of equation (2)."""
    for equation in (arm(4), LinearModal(arm(4).basis)):
        motion = simulate(equation, MotorAngle(held(0.7), SPRING), np.linspace(0, 5, 6), step=0.01)
        assert np.ptp(motion.tip, axis=0) == approx(0, abs=1e-12)
        assert motion.joint_torque[0] == approx(SPRING * (0.7 - motion.joint_angle[0]), rel=1e-9)


def test_the_held_joint_carries_the_weights_moment():
    """Rigid joint, light gravity: torque = -S g sin(φ), the spring's and the multiplier's alike."""
    for stiffness in (math.inf, 1e6):
        light = arm(4, STIFF, gravity=0.01)
        motion = simulate(light, MotorAngle(held(0.7), stiffness), np.array([0.0, 0.1]), step=0.01)
        assert motion.joint_torque == approx(-STIFF.static_moment * 0.01 * math.sin(0.7), rel=2e-5)


def test_coulomb_friction_shortens_each_half_swing_by_twice_its_torque():
    """Small swings about the hanging position lose 2 T/(S g) of amplitude every half period."""
    torque, start = 2.0, 0.1
    stiffness = LINK.static_moment * G
    half = math.pi * math.sqrt(LINK.joint_inertia / stiffness)
    swinging = arm(1, hanging=True, damping_ratio=0.5)
    straight = np.array([start / swinging.basis.rotation[0], 0.0])
    motion = simulate(
        swinging, JointTorque(friction=CoulombFriction(torque, 1e-3)), half * np.arange(4),
        initial_state=(straight, np.zeros(2)), method="Radau", rtol=1e-6, atol=1e-8,
    )  # fmt: skip
    turning = np.abs(motion.joint_angle)
    assert -np.diff(turning) == approx(np.full(3, 2 * torque / stiffness), rel=0.03)


def test_a_motion_cannot_be_changed():
    motion = simulate(arm(1), MotorAngle(held(0.1)), [0.0, 0.1])
    with pytest.raises(ValueError, match="read-only"):
        motion.tip[0] = 0.0
    assert "2 times, 0 to 0.1 s" in repr(motion)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"time": [0.0, 0.0]}, "rising"),
        ({"time": [0.0]}, "rising"),
        ({"step": 0.0}, "step must be positive"),
        ({"drive": JointTorque(friction=CoulombFriction(1.0))}, "Radau"),
    ],
)
def test_a_simulation_names_what_it_cannot_use(change, message):
    values = {"arm": arm(1), "drive": MotorAngle(held(0.0)), "time": [0.0, 1.0], **change}
    with pytest.raises(InvalidParameter, match=message):
        simulate(**values)


@pytest.mark.parametrize(
    "make",
    [
        lambda: MotorAngle(held(0.0), -1.0),
        lambda: MotorAngle(held(0.0), 1.0, -1.0),
        lambda: CoulombFriction(-1.0),
        lambda: CoulombFriction(1.0, 0.0),
        lambda: rigid_tip(0.0, 0.0),
    ],
)
def test_drives_refuse_values_out_of_range(make):
    with pytest.raises(InvalidParameter, match="got"):
        make()


def test_an_arm_bent_beyond_the_theory_is_reported_with_its_time():
    """A torque of 1e6 N m bends it until the inertia I + c Ca loses its sign."""
    with pytest.raises(NotConverged, match=r"t = .* s: bent so far") as caught:
        simulate(arm(1), JointTorque(1e6), np.linspace(0, 1, 11))
    assert 0 < caught.value.time <= 1


def test_a_ramped_sine_starts_from_rest_and_has_its_derivatives():
    """φ, φ_dot and φ_ddot are zero at t = 0 and continuous at the end of the rise."""
    assert [float(SWING(0.0, nu)) for nu in range(3)] == [0.0, 0.0, 0.0]
    assert SWING(7.0) == approx(1.2 * math.sin(2 * math.pi * 0.05 * 7.0))
    time, h = np.linspace(0.13, 8.03, 80), 1e-5  # not at 4 s, where the jerk jumps
    for nu in (0, 1):
        difference = (SWING(time + h, nu) - SWING(time - h, nu)) / (2 * h)
        assert SWING(time, nu + 1) == approx(difference, abs=1e-8)
    with pytest.raises(InvalidParameter, match="rise"):
        RampedSine(1.2, 0.05, 0.0)
