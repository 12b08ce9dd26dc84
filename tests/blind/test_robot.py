"""Robots of rods against closed forms: what they are worth as a second formulation."""

from dataclasses import replace

import numpy as np
import pytest
from chain import Base, Link, Vibration
from hub import STICK_WIDTH, Hub
from joint_motions import Sines, Stops
from lab_arms import HINGED, LAB_ARMS, PLANAR, SPATIAL
from motion import Arm
from motion import move as move_chain
from robot import Load, Robot, Slosh, Turn
from robot_motion import move

TUBE = HINGED.tubes["rod"].rods
STANDING = {"hinge": Stops([0.0], [], [])}
LYING = {"hinge": Stops([np.pi / 2], [], [])}


def rod(hub: Hub | None = None, planar: bool = True, **link: object) -> Robot:
    """The hinged arm's tube without damping on a rigid hinge, unless stated."""
    return Robot(
        (Turn("hinge", "y", "rod", replace(TUBE, **{"damping_ratio": 0.0, **link}), hub or Hub()),), planar
    )


def both(middle: float = 0.3) -> Sines:
    """A motion that excites the first mode."""
    return Sines([0.5, 0.1, 0.01], [0.2, 0.7, 1.9], [0.3, 1.1, 2.0], middle, rise=1.0)


def test_a_lying_tube_sags_as_a_cantilever():
    """w = (P/3 + p L/8) g L^3/EI, slope (P/2 + p L/6) g L^2/EI, a tube a thousand times stiffer."""
    EI, L, p = 1e3 * TUBE.EI, TUBE.length, TUBE.rho_A
    run = move(rod(EI=EI, EA=1e6 * TUBE.EA), LYING, 0.1)
    end, beyond = run.place("rod", 1.0)[0], run.place("rod", 1.0, (0, 0, 1.0))[0]
    P = TUBE.load.mass
    assert -end[2] == pytest.approx((P / 3 + p * L / 8) * 9.81 * L**3 / EI, rel=2e-6)
    assert end[2] - beyond[2] == pytest.approx((P / 2 + p * L / 6) * 9.81 * L**2 / EI, rel=2e-6)


def test_a_hanging_tube_stretches_and_a_loaded_one_twists():
    """(P + p L/2) g L/EA along a hanging tube; P g a L/GJ from a load a = 5 cm beside a lying one."""
    P, L = TUBE.load.mass, TUBE.length
    hanging = move(rod(), {"hinge": Stops([np.pi], [], [])}, 0.1).place("rod", 1.0)[0]
    assert -hanging[2] - L == pytest.approx((P + TUBE.rho_A * L / 2) * 9.81 * L / TUBE.EA, rel=1e-6)
    run = move(rod(planar=False, load=Load(P, (0.0, 0.05, 0.0))), LYING, 0.1)
    beside = run.place("rod", 1.0, (0.0, 1.0, 0.0))[0] - run.place("rod", 1.0)[0]
    assert -beside[2] == pytest.approx(P * 9.81 * 0.05 * L / TUBE.GJ, rel=2e-2)  # bent by 5 cm meanwhile


@pytest.mark.parametrize("arm", LAB_ARMS.values(), ids=list(LAB_ARMS))
def test_energy_is_kept_without_losses(arm):
    """What the motors feed in is what the arm has: 1e-5 of it, by trapezoids of 1 ms."""
    robot = arm.robot
    for turn in robot.turns:
        robot = robot.with_hub(turn.name, damping=0.0, rotor_inertia=0.0)
        if turn.link_name in arm.tubes:
            robot = robot.with_link(turn.link_name, damping_ratio=0.0)
    run = move(robot, {turn.name: both() for turn in robot.turns}, 5.0, h=1e-3)
    springs = 0.0
    for j, turn in enumerate(robot.turns):
        deflection = run.motor_angle[:, j] - run.q[:, run.built.hubs.dof[j]]
        springs = springs + 0.5 * turn.hub.stiffness * deflection**2
    energy = run.energies().sum(axis=1) + springs
    power = (run.motor_torque * np.gradient(run.motor_angle, run.time, axis=0)).sum(axis=1)
    work = np.concatenate([[0], np.cumsum(np.diff(run.time) * (power[1:] + power[:-1]) / 2)])
    assert np.abs(energy - energy[0] - work).max() < 1e-5 * np.ptp(energy)


@pytest.mark.parametrize(
    ("hub", "base"),
    [
        (Hub(), Base()),
        (Hub(stiffness=1e5, damping=200.0), Base()),
        (Hub(stiffness=1e5, damping=200.0, cubic=3e9, gap=4e-4), Base()),
        (Hub(stiffness=1e5, damping=200.0, coulomb=20.0, viscous=30.0), Base()),
        (Hub(stiffness=1e5, damping=200.0, hysteresis=25.0, hysteresis_width=4e-4), Base()),
        (Hub(stiffness=1e5, damping=200.0, cable=40.0, cable_rest=0.2, ratio_scale=1.002), Base()),
        (Hub(error_amplitude=1e-4, error_multiple=0.5, error_phase=0.7, motor_coulomb=9.0), Base()),
        (Hub(), Base(4e5, 800.0, vibration=Vibration(15.0, 3.1, 0.4))),
        (Hub(stiffness=1e5, damping=200.0), Base(4e5, 800.0)),
    ],
    ids=["rigid", "soft", "gap", "dry", "hysteresis", "cable", "teeth", "shaken base", "soft base"],
)
def test_one_joint_moves_as_the_complex_chain_does(hub, base):
    """motion.py has other coordinates, equations and steps: the tip within 3e-6 m, torque within 0.1 N m rms.

    Without stretch. After the knocks of a gap, which a step of 2.5 ms blurs, within 2e-5 m and 0.3 N m.
    """
    robot = replace(rod(hub, EA=1e6 * TUBE.EA), base=base)
    link = Link(TUBE.length, TUBE.EI, TUBE.rho_A, segments=2, mass=TUBE.load.mass)
    angle = both()

    def drive(t: float) -> tuple[float, float, float]:
        return tuple(float(part) for part in angle(np.array(t)))

    run = move(robot, {"hinge": angle}, 2.0, h=2.5e-3)
    other = move_chain(Arm(link, hub, base), drive, run.time[::20])
    apart = np.abs(run.place("rod", 1.0)[::20, [0, 2]] - other.place(1.0)).max()
    assert apart < (2e-5 if hub.gap else 3e-6)
    torque = run.motor_torque[::20, 0] - other.motor_torque
    assert np.sqrt(np.mean(torque[1:] ** 2)) < (0.3 if hub.gap else 0.1)


def test_steps_are_of_order_five():
    """Tip of the planar arm at 2.4 s against steps of 2.5 ms: half the step, a thirtieth of the error."""
    run = {
        h: move(PLANAR.robot, {"shoulder": both(), "elbow": both(0.7)}, 2.4, h) for h in (0.06, 0.03, 2.5e-3)
    }
    tip = {h: motion.place("forearm", 1.0)[-1] for h, motion in run.items()}
    coarse, fine = (np.linalg.norm(tip[h] - tip[2.5e-3]) for h in (0.06, 0.03))
    assert np.log2(coarse / fine) == pytest.approx(5.0, abs=0.4)
    assert fine < 3e-6


def test_a_mass_on_a_spring_at_the_tip_swings_at_its_frequency():
    """On a stiff tube, the slosh alone: f of the oscillator, from its force on the hinge after a jerk."""
    robot = rod(EI=1e6 * TUBE.EI, load=Load(100.0))
    jerk = {"hinge": Stops([np.pi, np.pi + 0.01], [0.0], [0.2])}
    run = move(replace(robot, slosh=Slosh(0.01, 2.0, 0.0), gravity=0.0), jerk, 4.0, h=2e-3)
    late = run.time > 0.5
    turned = np.flatnonzero(np.diff(np.sign(run.q[late, -1])))
    assert np.diff(turned).mean() * 2e-3 == pytest.approx(0.25, rel=2e-3)


def test_drag_takes_the_power_of_the_third_power_of_speed():
    """A stiff tube in uniform turning: c (w L)^2 L at the hinge."""
    w, L, c = 0.5, TUBE.length, 12.0

    def uniform(t):
        return w * t, w + 0 * t, 0 * t

    robot = replace(rod(EI=1e6 * TUBE.EI, load=Load(0.0)), drag=c, gravity=0.0)
    run = move(robot, {"hinge": uniform}, 2.0)
    assert run.motor_torque[-1, 0] == pytest.approx(c * (w * L) ** 2 * L, rel=1e-4)


def test_growth_lengthens_and_bow_bends_a_free_tube():
    """Without weight the tip is at the growth and the bow, a part 1 - exp(-t/tau) of them."""
    free = rod(planar=False, load=Load(0.0), bow=(3e-3, -2e-3), growth=1e-3, bow_time=2.0, damping_ratio=0.1)
    run = move(replace(free, gravity=0.0), STANDING, 3.0)
    tip = run.place("rod", 1.0)[-1] - [0, 0, TUBE.length]
    assert tip == pytest.approx(np.array([3e-3, -2e-3, 1e-3]) * (1 - np.exp(-1.5)), abs=5e-6)


def test_a_tilted_base_turns_with_everything_on_it():
    """Gravity does not: an upright tube leans, by (P + ..) more than the tilt says."""
    run = move(
        replace(rod(EI=1e6 * TUBE.EI, EA=1e6 * TUBE.EA, planar=False), tilt=(2e-3, -3e-3)), STANDING, 0.1
    )
    L = TUBE.length
    assert run.place("rod", 1.0)[0] == pytest.approx([-3e-3 * L, -2e-3 * L, L], abs=2e-5)


def test_a_spinning_waist_feels_the_centrifugal_force():
    """Stiff tubes, the upper arm lying: torque of the shoulder is less the load's weight by nothing, and the
    waist's, at constant speed, is zero; the forearm hanging by q bears m w^2 r z more."""
    w = 1.2
    robot = SPATIAL.robot
    for name in SPATIAL.tubes:
        tube = robot.carried_by(name).link
        robot = robot.with_link(
            name, EI=1e6 * tube.EI, GJ=1e6 * tube.GJ, EA=1e6 * tube.EA, rho_A=1e-9, rho_I=1e-9
        )
    robot = robot.with_load("upper_arm", mass=0.0, inertia=0.0).with_load(
        "forearm", offset=(0, 0, 0), inertia=0.0
    )
    for turn in robot.turns:
        robot = robot.with_hub(turn.name, stiffness=np.inf)

    def spin(t):
        return w * t, w + 0 * t, 0 * t

    shoulder, elbow = 0.4, 0.9
    run = move(
        robot, {"waist": spin, "shoulder": Stops([shoulder], [], []), "elbow": Stops([elbow], [], [])}, 1.0
    )
    m, lower = 7.5, 1.4
    upper, lean = 1.7, shoulder + elbow
    x, z = lower * np.sin(lean), lower * np.cos(lean)
    radius = 0.12 + upper * np.sin(shoulder) + x
    assert run.motor_torque[-1, 0] == pytest.approx(0.0, abs=1e-3)
    assert run.motor_torque[-1, 2] == pytest.approx(-m * 9.81 * x - m * w**2 * radius * z, rel=1e-5)


def test_dry_friction_takes_its_torque_times_the_way_less_three_widths():
    """Dahl out and back over a: T (a - w) + T (a - 2 w)."""
    a, torque = 2e-4, 8.0
    out_and_back = {"hinge": Stops([0.0, a, 0.0], [0.1, 2.1], [1.8, 1.8])}
    run = move(
        replace(rod(Hub(coulomb=torque), EI=1e4 * TUBE.EI, damping_ratio=0.1), gravity=0.0),
        out_and_back,
        4.0,
        1e-3,
    )
    loss = np.trapezoid(run.motor_torque[:, 0] * np.gradient(run.motor_angle[:, 0], run.time), run.time)
    assert loss == pytest.approx(torque * (2 * a - 3 * STICK_WIDTH), rel=2e-3)
