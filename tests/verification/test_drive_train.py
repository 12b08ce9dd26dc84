"""Everything that a drive train can hold, at once, against solutions that know nothing of finite elements."""

import numpy as np
import pytest
from arms import arm, drive, hinge, rigid, smooth_step
from scipy.integrate import solve_ivp
from scipy.interpolate import PPoly
from scipy.optimize import brentq

import flexarm
from flexarm.effects import (
    Backlash,
    CableTorque,
    CoulombFriction,
    GearRatio,
    JointCompliance,
    JointHysteresis,
    JointStiffening,
    TransmissionError,
    ViscousFriction,
)

RATIO, K, K3, GAP = 100.0, 4e4, 2e9, 6e-4
SCALE, RIPPLE, MULTIPLE, PHASE = 1.0005, 2e-4, 2.0, 0.6
LOOSE = 1e-4  # part of the stiffness left in the gap


def teeth(phi: float) -> float:
    """psi of the motor's angle."""
    return phi / SCALE + RIPPLE * np.sin(MULTIPLE * RATIO * phi + PHASE)


def teeth_slope(phi: float) -> float:
    """dpsi/dphi."""
    return 1 / SCALE + RIPPLE * MULTIPLE * RATIO * np.cos(MULTIPLE * RATIO * phi + PHASE)


def spring(d: float) -> float:
    """Torque of the reducer's spring, with backlash."""
    play = min(max(d, -GAP / 2), GAP / 2)
    e = d - play
    return K * e + K3 * e**3 + LOOSE * K * play


class Dahl:
    """Rate-independent friction by its differential equation in the path, dz/dx = (1 - z sgn dx)/w."""

    def __init__(self, torque: float, width: float, x: float) -> None:
        self.torque, self.width, self.x, self.z = torque, width, x, 0.0

    def at(self, x: float) -> float:
        """z after moving to x."""
        sign = np.sign(x - self.x)
        return self.z if sign == 0 else sign - (sign - self.z) * np.exp(-abs(x - self.x) / self.width)

    def move(self, x: float) -> None:
        """Goes there."""
        self.z, self.x = self.at(x), x


def pendulum(mass: float, *effects: object, **joint: object) -> flexarm.Arm:
    """A weight that hangs 1 m below its hinge at q = 0."""
    return arm(
        joints=[hinge("hinge", "bob", gear_ratio=RATIO, **joint)],
        links=[rigid("bob", mass, com=[0, 0, -1.0])],
        points=[{"name": "bob", "link": "bob", "position": [0, 0, -1.0]}],
        effects=list(effects),
    )


def test_a_whole_train_moves_slowly_through_its_equilibria():
    """phi -> teeth -> spring, gap and hysteresis -> theta with bearing friction and cables.

    The reference solves m g l sin(theta) = T - T_c z_theta - k_c (theta - theta_r) for theta at each instant,
    with T = spring(psi - theta) + T_h z_d; the hanging arm is stable inside the gap too. The run takes 60 s a
    cycle: the damper of the reducer holds the link back by 2e-6 rad, inertia by less. It starts too fast for
    the reference, and crosses the gap, at 30 s, within 15 ms: there the two agree to within the gap.
    """
    mass, t_h, w_h, t_c, k_c, rest = 20.0, 12.0, 2e-4, 8.0, 15.0, 0.3
    model = pendulum(
        mass,
        JointCompliance(at="hinge", stiffness=K, damping=400.0),
        JointStiffening(at="hinge", cubic_stiffness=K3),
        Backlash(at="hinge", gap=GAP),
        JointHysteresis(at="hinge", torque=t_h, width=w_h),
        CoulombFriction(at="hinge", torque=t_c),
        CableTorque(at="hinge", stiffness=k_c, rest_angle=rest),
        TransmissionError(at="hinge", amplitude=RIPPLE, multiple=MULTIPLE, phase=PHASE),
        GearRatio(at="hinge", scale=SCALE),
    )
    period, step = 60.0, 5e-3

    def path(t: np.ndarray) -> np.ndarray:
        return 0.4 * np.sin(2 * np.pi * t / period) * smooth_step(t / 8)

    run = flexarm.simulate(model, drive({"hinge": path}, 50.0, 10001), step=step)
    phi = path(run.time)

    def balance(theta: float, psi: float, inner: Dahl | None, outer: Dahl | None) -> float:
        friction = 0.0 if inner is None else t_h * inner.at(psi - theta) - t_c * outer.at(theta)
        weight = mass * 9.81 * np.sin(theta)
        return spring(psi - theta) + friction - k_c * (theta - rest) - weight

    def rested(psi: float, *friction: Dahl | None) -> float:
        return brentq(balance, psi - 0.02, psi + 0.02, args=(psi, *(friction or (None, None))), xtol=1e-14)

    theta = [rested(teeth(phi[0]))]
    inner, outer = Dahl(t_h, w_h, teeth(phi[0]) - theta[0]), Dahl(t_c, 2e-5, theta[0])
    for angle in phi[1:]:
        psi = teeth(angle)
        theta.append(rested(psi, inner, outer))
        inner.move(psi - theta[-1])
        outer.move(theta[-1])
    assert run.solver["halvings"] == 0
    error = run.joint_angle[:, 0] - np.array(theta)
    assert np.ptp(run.joint_angle) > 0.7
    slow = (run.time > 10) & (np.abs(run.time - 30) > 4)
    assert np.abs(error[slow]).max() < 1e-5
    assert np.abs(error).max() < GAP


@pytest.mark.parametrize("side", ["torque", "motor"])
def test_two_inertias_with_a_gap_between_them_move_as_their_equations_say(side):
    """J_m phi'' = tau - psi' T, J theta'' = T - b theta', T = spring(d) + c g(d) d', integrated adaptively.

    The gap is crossed eight times; its fading of the damping is written anew here.
    """
    inertia, rotor, c, b = 4.0, 3e-4, 60.0, 2.0
    weightless = pendulum(0.0).replace(
        gravity=(0.0, 0.0, 0.0),
        links=arm(joints=[hinge("hinge", "bob")], links=[rigid("bob", 3.0, inertia=[inertia] * 3)]).links,
    )
    joint = weightless.joints[0].replace(rotor_inertia=rotor)
    model = weightless.replace(
        joints=(joint,),
        effects=(
            JointCompliance(at="hinge", stiffness=K, damping=c),
            JointStiffening(at="hinge", cubic_stiffness=K3),
            Backlash(at="hinge", gap=GAP),
            ViscousFriction(at="hinge", coefficient=b),
            TransmissionError(at="hinge", amplitude=RIPPLE, multiple=MULTIPLE, phase=PHASE),
            GearRatio(at="hinge", scale=SCALE),
        ),
    )

    def told(t: np.ndarray) -> np.ndarray:
        shape = np.sin(2 * np.pi * t / 0.8) * smooth_step(t / 0.4)
        return 40.0 * shape if side == "torque" else 0.05 * shape

    end, step = 3.2, 2.5e-4
    turn = drive({"hinge": told}, end, 6401, side=side)
    run = flexarm.simulate(model, turn, step=step)
    piece = PPoly(turn.joints["hinge"].coefficients, turn.joints["hinge"].breaks)
    rate = piece.derivative()
    motor = RATIO**2 * rotor

    def contact(d: float) -> float:
        u = np.clip((GAP / 2 - abs(d)) / 2e-5, 0.0, 1.0)
        return 0.01 + 0.99 * (1 - 3 * u**2 + 2 * u**3)

    def torque(phi: float, phi_dot: float, theta: float, theta_dot: float) -> float:
        d, d_dot = teeth(phi) - theta, teeth_slope(phi) * phi_dot - theta_dot
        return spring(d) + c * contact(d) * d_dot

    def rates(t: float, y: np.ndarray) -> list[float]:
        theta, theta_dot, phi, phi_dot = y
        if side == "motor":
            phi, phi_dot = float(piece(t)), float(rate(t))
        T = torque(phi, phi_dot, theta, theta_dot)
        tau = float(piece(t)) if side == "torque" else 0.0
        pull = (tau - teeth_slope(phi) * T) / motor if side == "torque" else 0.0
        return [theta_dot, (T - b * theta_dot) / inertia, phi_dot, pull]

    start = [float(run.joint_angle[0, 0]), 0.0, float(run.drive_angle[0, 0]), 0.0]
    found = solve_ivp(
        rates, (0, end), start, method="LSODA", rtol=1e-9, atol=1e-11, max_step=1e-3, t_eval=run.time
    )
    assert run.solver["halvings"] == 0
    d = np.array([teeth(p) for p in run.drive_angle[:, 0]]) - run.joint_angle[:, 0]
    assert np.count_nonzero(np.diff(np.sign(d))) >= 6
    scale = np.ptp(found.y[0])
    assert run.joint_angle[:, 0] == pytest.approx(found.y[0], abs=2e-3 * scale)
    if side == "motor":
        T = np.array(
            [torque(float(piece(t)), float(rate(t)), *y) for t, y in zip(found.t, found.y[:2].T, strict=True)]
        )
        slope = np.array([teeth_slope(float(piece(t))) for t in found.t])
        late = (run.time > 0.5) & (run.time < end - 0.05)
        turned = motor * piece.derivative(2)(run.time)
        expected = slope * T + turned
        assert run.motor_torque[late, 0] == pytest.approx(expected[late], abs=0.03 * np.abs(expected).max())
