"""Tabulated laws of joints: closed forms at rest and in motion, derivatives with respect to their values."""

from itertools import pairwise

import numpy as np
import pytest
from arms import G, drive, hinge, paper_arm, point, rigid, smooth_step
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from tests.verification.test_sensitivities import difference

import flexarm
from flexarm.arm.parameter import with_value
from flexarm.effects import (
    Backlash,
    CableTorque,
    CoulombFriction,
    Effect,
    JointCompliance,
    TabulatedLaw,
    TransmissionError,
    ViscousFriction,
)
from flexarm.simulation.prepared import prepared
from flexarm.simulation.solve import solved

K, C = 8e4, 160.0
LEVEL = np.pi / 2
SPRING = JointCompliance(at="hinge", stiffness=K, damping=C)
TORQUES = (-450.0, -150.0, 0.0, 200.0, 450.0)
SOFTENING = TabulatedLaw(
    at="hinge", quantity="windup", of="torque", x=TORQUES, value=(3e-3, 5e-4, 0.0, -6e-4, -2e-3)
)
"""A windup that falls faster than the torque grows."""
OTHERS = (
    ("windup", "angle", (-0.2, 0.3, 0.9, 1.7), (1e-3, 2e-3, -5e-4, -1.5e-3)),
    ("windup", "motor_angle", (-0.2, 0.3, 0.9, 1.7), (1e-3, 2e-3, -5e-4, -1.5e-3)),
    ("windup", "rate", (-2.0, -0.1, 0.2, 2.0), (-2e-3, -5e-4, 4e-4, 1.5e-3)),
    ("torque", "angle", (-0.2, 0.3, 0.9, 1.7), (5.0, 20.0, -5.0, -15.0)),
    ("torque", "motor_angle", (-0.2, 0.3, 0.9, 1.7), (5.0, 20.0, -5.0, -15.0)),
    ("torque", "rate", (-2.0, -0.1, 0.2, 2.0), (-40.0, -5.0, 6.0, 30.0)),
)
LAWS = (
    SOFTENING,
    *(TabulatedLaw(at="hinge", quantity=q, of=of, x=x, value=y) for q, of, x, y in OTHERS),
)
NAMES = [f"{law.quantity} of {law.of}" for law in LAWS]


def line(quantity: str, of: str, slope: float, start: float = 0.0) -> TabulatedLaw:
    """The table of a straight line on uneven knots, beyond which nothing moves."""
    x = np.array([-2e5, -3.0, -0.2, 0.5, 1.0, 2e5])
    return TabulatedLaw(at="hinge", quantity=quantity, of=of, x=tuple(x), value=tuple(start + slope * x))


def arm(*effects: Effect, ratio: float = 5.0, rotor_inertia: float = 1e-3) -> flexarm.Arm:
    """The paper's arm with a rotor and these effects."""
    model = paper_arm(2, damping_ratio=0.01)
    joint = model.joints[0].replace(gear_ratio=ratio, rotor_inertia=rotor_inertia)
    return model.replace(joints=(joint,), effects=effects)


def turn(end: float = 1.0) -> flexarm.Drive:
    """From rest near the vertical to near the level, and half way back."""

    def angle(t: NDArray) -> NDArray:
        s = t / end
        return 0.1 + 1.3 * smooth_step(2 * s) - 0.6 * smooth_step(2 * s - 1)

    return drive({"hinge": angle}, end, 201)


def moved(model: flexarm.Arm, end: float = 1.0) -> flexarm.Simulation:
    return flexarm.simulate(model, turn(end), step=2e-3)


def close(one: flexarm.Simulation, two: flexarm.Simulation, part: float = 1e-9) -> None:
    """The tips lie within a part of their travel; torques within a part of the greatest."""
    for name in ("position", "joint_torque", "motor_torque"):
        a, b = np.asarray(getattr(one, name)), np.asarray(getattr(two, name))
        assert np.abs(a - b).max() <= part * np.abs(b).max(), name


# ------------------------------------------------------------------------------- closed forms


@pytest.mark.parametrize("slope", [4e-6, -4e-6], ids=["softer", "stiffer"])
def test_a_windup_that_falls_with_the_torque_is_a_softer_spring(slope):
    """1/k' = 1/k + c, with the same damper; Newton's iterations leave 1e-9."""
    wound = arm(SPRING, line("windup", "torque", -slope))
    soft = arm(SPRING.replace(stiffness=1 / (1 / K + slope)))
    rest, expected = (flexarm.static(model, {"hinge": 1.1}) for model in (wound, soft))
    assert rest.position == pytest.approx(expected.position, rel=1e-10)
    one, two = (flexarm.modes(model, {"hinge": 1.1}, count=2) for model in (wound, soft))
    assert one.frequency_hz == pytest.approx(two.frequency_hz, rel=1e-9)
    close(moved(wound), moved(soft), 1e-8)


def test_a_windup_that_falls_steeply_about_a_step_has_the_torque_of_its_deflection():
    """A link of 20 kg rides through the step: T/k - w(T) is the deflection, T the link's weight."""
    law = TabulatedLaw(
        at="hinge", quantity="windup", of="torque", x=(-100, -10, 10, 100), value=(0.1, 0.05, -0.05, -0.1)
    )
    model = flexarm.Arm.from_dict(
        {
            "format": "flexarm-arm/1",
            "gravity": [0, 0, -G],
            "joints": [hinge("hinge", "rod")],
            "links": [rigid("rod", 20.0, [1.0, 0, 0], [1.0, 1.0, 1.0])],
        }
    ).replace(effects=(JointCompliance(at="hinge", stiffness=2e4, damping=20.0), law))
    ride = drive({"hinge": lambda t: 1.0 + 0.2 * smooth_step(t / 8)}, 8.0, 401)
    run = flexarm.simulate(model, ride, step=2e-3, energies=True)
    weight = 20.0 * G * np.cos(run.joint_angle[:, 0])
    assert np.abs(np.abs(run.joint_torque[:, 0]) - weight).max() < 2.0
    balance = run.kinetic + run.elastic + run.gravity + run.damped - run.work
    assert np.ptp(balance) < 0.01 * np.ptp(run.work)


def test_a_torque_that_grows_with_the_angle_is_that_of_cables():
    cables = arm(SPRING, CableTorque(at="hinge", stiffness=30.0, rest_angle=0.2))
    close(moved(arm(SPRING, line("torque", "angle", 30.0, -6.0))), moved(cables))


def test_a_torque_that_grows_with_the_rate_is_viscous_friction():
    close(
        moved(arm(SPRING, line("torque", "rate", 25.0))),
        moved(arm(SPRING, ViscousFriction(at="hinge", coefficient=25.0))),
    )


@pytest.mark.parametrize("spring", [(SPRING,), ()], ids=["compliant", "rigid"])
def test_a_windup_by_a_sine_of_the_motor_is_a_transmission_error(spring):
    """400 knots over 0.8 periods: the cubics err by 1e-5 of the amplitude, their slopes by 1e-3."""
    amplitude = 2e-3
    phi = np.linspace(-0.2, 1.6, 400)
    table = TabulatedLaw(
        at="hinge",
        quantity="windup",
        of="motor_angle",
        x=tuple(phi),
        value=tuple(amplitude * np.sin(5 * phi + 0.4)),
    )
    wave = TransmissionError(at="hinge", amplitude=amplitude, multiple=1.0, phase=0.4)
    one, two, plain = (moved(arm(*spring, *effect)) for effect in ([table], [wave], []))
    error = np.abs(one.joint_angle - two.joint_angle).max()
    assert error <= 1e-3 * np.abs(two.joint_angle - plain.joint_angle).max()


def wound_by(law: TabulatedLaw, run: flexarm.Simulation) -> NDArray:
    """The law's windup at the instants of a run without bearing torques [rad]."""
    spring = run.joint_torque - C * (run.drive_rate - run.joint_rate)
    states = {"angle": run.joint_angle, "rate": run.joint_rate, "torque": spring}
    return law(states[law.of])


@pytest.mark.parametrize("law", [LAWS[0], LAWS[1], LAWS[3]], ids=lambda law: law.of)
def test_the_reducer_winds_up_by_its_spring_and_its_table_at_every_instant(law):
    """phi + w - theta = (T - c (phi' - theta'))/k."""
    run = moved(arm(SPRING, law, rotor_inertia=0.0))
    spring = run.joint_torque - C * (run.drive_rate - run.joint_rate)
    expected = spring / K - wound_by(law, run)
    assert run.drive_angle - run.joint_angle == pytest.approx(expected, abs=1e-8)
    assert np.ptp(wound_by(law, run)) > 5e-4


@pytest.mark.parametrize("law", LAWS[4:], ids=lambda law: law.of)
def test_the_link_loses_the_torque_of_the_table_at_every_instant(law):
    """T = k (phi - theta) + c (phi' - theta') - f."""
    run = moved(arm(SPRING, law, rotor_inertia=0.0))
    states = {"angle": run.joint_angle, "rate": run.joint_rate, "motor_angle": run.drive_angle}
    spring = K * (run.drive_angle - run.joint_angle) + C * (run.drive_rate - run.joint_rate)
    assert run.joint_torque == pytest.approx(spring - law(states[law.of]), abs=1e-3)


@pytest.mark.parametrize("law", LAWS[:4], ids=lambda law: law.of)
def test_a_windup_of_a_rigid_joint_moves_its_drive(law):
    """Of the motor's angle exactly, else within T/1e9."""
    model = arm(law, rotor_inertia=0.0)
    run = moved(model)
    if law.of == "motor_angle":
        assert run.drive_angle - run.joint_angle == pytest.approx(-law(run.drive_angle), abs=1e-10)
        return
    states = {"angle": run.joint_angle, "rate": run.joint_rate, "torque": run.joint_torque}
    expected = run.joint_torque / 1e9 - law(states[law.of])
    assert run.drive_angle - run.joint_angle == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("law", LAWS, ids=NAMES)
def test_at_rest_the_arm_obeys_its_table(law):
    found = flexarm.static(arm(SPRING, law), {"hinge": 1.2})
    theta, torque = float(found.link_angle[0]), float(found.joint_torque[0])
    y = {"angle": theta, "motor_angle": 1.2, "rate": 0.0, "torque": torque}[law.of]
    lost = float(law(y)) if law.quantity == "torque" else 0.0
    wound = 0.0 if law.quantity == "torque" else float(law(y))
    assert 1.2 - theta == pytest.approx((torque + lost) / K - wound, abs=1e-11)


@pytest.mark.parametrize("law", LAWS, ids=NAMES)
def test_energy_is_accounted_for(law):
    """Kinetic + elastic + gravity + damped - work stays: sums over steps of 0.5 ms leave 1e-4 of it."""
    run = flexarm.simulate(arm(SPRING, law), turn(), step=5e-4)
    total = run.kinetic + run.elastic + run.gravity + run.damped - run.work
    assert np.ptp(total) <= 1e-4 * np.ptp(run.gravity)


def test_backlash_and_windup_of_the_torque_add_up():
    """At rest: gap/2 on the side of the torque, the spring's torque over k, and the table."""
    gap = 4e-4
    found = flexarm.static(arm(SPRING, Backlash(at="hinge", gap=gap), SOFTENING), {"hinge": LEVEL})
    torque = float(found.joint_torque[0])
    d = torque / K - float(SOFTENING(torque)) + np.sign(torque) * gap / 2
    assert LEVEL - float(found.link_angle[0]) == pytest.approx(d, abs=1e-4 * gap)


def test_friction_is_lost_behind_the_spring_that_winds_up():
    """The table's torque is the spring's: the link's and the friction's together."""
    model = arm(SPRING.replace(damping=0.0), SOFTENING, CoulombFriction(at="hinge", torque=30.0))
    run = moved(model)
    d = run.drive_angle - run.joint_angle
    w = np.interp(d, *spring_curve())
    spring = K * (d + w)
    lost = np.abs(spring - run.joint_torque)
    assert lost.max() == pytest.approx(30.0, abs=0.1)


def spring_curve() -> tuple[NDArray, NDArray]:
    """Deflection and windup of SOFTENING on the spring without a damper."""
    T = np.linspace(-600, 600, 20001)
    return T / K - SOFTENING(T), SOFTENING(T)


# --------------------------------------------------------------------------------- the table


def test_the_table_is_scipys_monotone_cubic_and_held_beyond_its_ends():
    rng = np.random.default_rng(5)
    for _ in range(20):
        x, y = np.cumsum(rng.uniform(0.1, 2.0, 7)), np.round(rng.normal(size=7), 1)
        law = TabulatedLaw(at="hinge", quantity="torque", of="angle", x=tuple(x), value=tuple(y))
        inside = np.linspace(x[0], x[-1], 500)
        assert law(inside) == pytest.approx(PchipInterpolator(x, y)(inside), abs=1e-13)
        assert law([x[0] - 1, x[-1] + 1]) == pytest.approx([y[0], y[-1]], abs=0)
        for (a, b), (ya, yb) in zip(pairwise(x), pairwise(y), strict=True):
            steps = np.diff(law(np.linspace(a, b, 50))) * np.sign(yb - ya)
            assert np.all(steps >= -1e-15)


def test_beyond_the_ends_the_torque_no_longer_grows():
    """The level arm puts -620 N m on the hinge, beyond the first knot of -100 N m."""
    law = TabulatedLaw(at="hinge", quantity="windup", of="torque", x=(-100.0, 100.0), value=(1e-3, -1e-3))
    found = flexarm.static(arm(SPRING, law), {"hinge": LEVEL})
    torque = float(found.joint_torque[0])
    assert torque < -400
    assert LEVEL - float(found.link_angle[0]) == pytest.approx(torque / K - 1e-3, abs=1e-11)


# ------------------------------------------------------------------------------- derivatives


@pytest.mark.parametrize("law", LAWS, ids=NAMES)
@pytest.mark.parametrize("k", [1, 2])
def test_derivatives_with_respect_to_values_are_those_of_differences(law, k):
    """Within 1e-6 of the greatest, and what two steps of differences differ by where knots are crossed."""
    key = f"effects.tabulated_law.hinge.value.{k}"
    model = arm(SPRING, law)
    motion = turn(2.0)
    found = flexarm.simulate(model, motion, step=2e-3, sensitivities=[key]).sensitivities
    assert found is not None
    size = 1e-3 * np.linalg.norm(law.value)

    def run(value: float, name: str) -> NDArray:
        one = prepared(with_value(model, key, value), motion, 2e-3, -0.05, None, False, False)
        one.options.tolerance = 1e-14
        return np.asarray(getattr(solved(one, None), name))

    for name in ("position", "joint_angle", "joint_torque", "motor_torque"):
        expected, doubt = difference(lambda p, name=name: run(p, name), law.value[k], size)
        error = np.abs(found.by(key)[name] - expected).max()
        assert error <= 1e-6 * np.abs(expected).max() + 10 * doubt, name


@pytest.mark.parametrize("law", LAWS, ids=NAMES)
def test_derivatives_of_an_equilibrium_are_those_of_differences(law):
    key = "effects.tabulated_law.hinge.value"
    model = arm(SPRING, law)
    found = flexarm.static(model, {"hinge": 0.6}, sensitivities=[key]).sensitivities
    assert found is not None and len(found.parameters) == len(law.value)
    for k, value in enumerate(law.value):
        expected, doubt = difference(
            lambda p, k=k: flexarm.static(with_value(model, f"{key}.{k}", p), {"hinge": 0.6}).position,
            value,
            1e-3 * np.linalg.norm(law.value),
        )
        error = np.abs(found.by(f"{key}.{k}")["position"] - expected).max()
        assert error <= 1e-6 * np.abs(expected).max() + doubt + 1e-12


def complex_pchip(x: NDArray, y: NDArray, at: NDArray) -> NDArray:
    """Monotone cubic of complex values, written again from Fritsch and Butland's formula."""
    h, s = np.diff(x), np.diff(y) / np.diff(x)
    m = np.zeros(len(x), complex)
    for i in range(1, len(x) - 1):
        if (s[i - 1] * s[i]).real > 0:
            w1, w2 = 2 * h[i] + h[i - 1], h[i] + 2 * h[i - 1]
            m[i] = (w1 + w2) / (w1 / s[i - 1] + w2 / s[i])
    for i, j, step in ((0, 0, 1), (len(x) - 1, len(x) - 2, -1)):
        end = ((2 * h[j] + h[j + step]) * s[j] - h[j] * s[j + step]) / (h[j] + h[j + step])
        if (end * s[j]).real > 0:
            m[i] = end if (s[j] * s[j + step]).real > 0 or abs(end) <= 3 * abs(s[j]) else 3 * s[j]
    i = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    u = at - x[i]
    c, d = (3 * s[i] - 2 * m[i] - m[i + 1]) / h[i], (m[i] + m[i + 1] - 2 * s[i]) / h[i] ** 2
    return y[i] + u * (m[i] + u * (c + u * d))


@pytest.mark.parametrize("k", range(5))
def test_a_rigid_joint_has_the_derivatives_of_a_complex_step(k):
    """theta = phi + w(phi), so dtheta/dvalue = dw/dvalue, exact by a complex step."""
    x, y = np.array([0.0, 0.3, 0.5, 0.9, 1.5]), np.array([2e-3, 1e-3, -4e-4, -1e-3, -3e-3])
    law = TabulatedLaw(at="hinge", quantity="windup", of="motor_angle", x=tuple(x), value=tuple(y))
    key = f"effects.tabulated_law.hinge.value.{k}"
    run = flexarm.simulate(arm(law), turn(), step=2e-3, sensitivities=[key])
    assert run.sensitivities is not None
    step = 1e-30j * (np.arange(5) == k)
    exact = complex_pchip(x, y + step, run.drive_angle[:, 0]).imag / 1e-30
    assert run.sensitivities.by(key)["joint_angle"][:, 0] == pytest.approx(exact, abs=1e-8)


def test_the_derivative_of_a_windup_of_the_torque_solves_its_equation():
    """At rest T is given: d(theta - phi)/dvalue = dw/dvalue + ... with gravity's small turn left in T."""
    key = "effects.tabulated_law.hinge.value.3"
    model = arm(SPRING, SOFTENING)
    found = flexarm.static(model, {"hinge": LEVEL}, sensitivities=[key])
    assert found.sensitivities is not None
    torque = float(found.joint_torque[0])
    x, y = np.array(TORQUES), np.array(SOFTENING.value)
    w = complex_pchip(x, y + 1e-30j * (np.arange(5) == 3), np.array([torque])).imag[0] / 1e-30
    d_torque = float(found.sensitivities.by(key)["joint_torque"][0])
    slope = 1 / K - (float(SOFTENING(torque + 0.01)) - float(SOFTENING(torque - 0.01))) / 0.02
    d_theta = float(found.sensitivities.by(key)["link_angle"][0])
    assert d_theta == pytest.approx(w - slope * d_torque, rel=1e-6)


# ------------------------------------------------------------------------- several joints


def test_two_joints_with_tables_move_in_space_as_their_springs_do():
    """A windup of the torque beside one of the angle that is zero; the planar core is left."""

    def model(*effects: Effect) -> flexarm.Arm:
        return flexarm.Arm.from_dict(
            {
                "gravity": [0.0, 0.0, -G],
                "joints": [
                    hinge("turn", "post", axis=[0, 0, 1]),
                    hinge("lift", "bar", "post", origin={"xyz": [0, 0, 0.5]}),
                ],
                "links": [
                    rigid("post", 5.0, [0, 0, 0.2], [0.1, 0.1, 0.1]),
                    rigid("bar", 4.0, [0.5, 0, 0], [0.05, 0.4, 0.4]),
                ],
                "points": [point("tip", "bar", [1.0, 0, 0])],
                "effects": [],
            }
        ).replace(effects=effects)

    springs = [JointCompliance(at=at, stiffness=2e4, damping=30.0) for at in ("turn", "lift")]
    table = line("windup", "torque", -2e-5)
    tables = [table.replace(at=at) for at in ("turn", "lift")]
    soft = [JointCompliance(at=at, stiffness=1 / (1 / 2e4 + 2e-5), damping=30.0) for at in ("turn", "lift")]
    motion = drive(
        {"turn": lambda t: 0.5 * smooth_step(t), "lift": lambda t: -0.4 * smooth_step(t)}, 1.0, 101
    )
    one, two = (flexarm.simulate(model(*effects), motion, step=2e-3) for effects in (springs + tables, soft))
    assert one.position == pytest.approx(two.position, abs=1e-8)
