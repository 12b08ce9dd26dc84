"""Mechanisms of the multibody literature with closed loops, against published and closed solutions."""

from __future__ import annotations

import benchmark_mechanisms as mechanisms
import numpy as np
import pytest
from arms import G, arm, drive, rigid
from pytest import approx
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from scipy.special import ellipk

import flexarm


def released(
    model: flexarm.Arm, joint: str, angle: float, torque, end: float, step: float, alpha: float = 0.0, **more
) -> flexarm.Simulation:
    """The model held at an angle of a joint, which a torque drives from the time 0 on."""
    pushed = drive({joint: torque}, end, 2001, side="torque")
    told = flexarm.Drive(pushed.joints, {joint: angle}, 0.0, end)
    return flexarm.simulate(model, told, step=step, alpha=alpha, **more)


def squeezed(step: float, **more) -> flexarm.Simulation:
    """Andrews' squeezer under 0.033 N m."""
    start = mechanisms.SQUEEZER_START["beta"]
    constant = lambda t: np.full_like(t, 0.033)  # noqa: E731
    return released(mechanisms.andrews_squeezer(), "beta", start, constant, 0.03, step, **more)


def test_andrews_squeezer_ends_as_the_reference_solution():
    """All seven angles at 0.03 s: second order, and extrapolated to 1e-7 rad of 15.8."""
    expected = np.array(list(mechanisms.SQUEEZER_END.values()))
    coarse, fine = (squeezed(step).joint_angle[-1, :7] for step in (2e-5, 1e-5))
    assert np.abs(coarse - expected).max() == approx(4 * np.abs(fine - expected).max(), rel=0.01)
    assert np.abs(fine - expected).max() < 1.1e-4
    assert (4 * fine - coarse) / 3 == approx(expected, abs=2e-7)


def test_the_squeezer_keeps_its_energy():
    """Work of the torque is kinetic energy and that of the spring."""
    run = squeezed(1e-5, energies=True)
    balance = run.kinetic + run.elastic - run.work
    assert np.ptp(run.elastic) > 0.1
    assert np.abs(balance - balance[0]).max() < 1e-4 * np.ptp(run.kinetic)


def thrown(end: float, step: float, alpha: float = 0.0, **more) -> flexarm.Simulation:
    """Two four-bars that begin upright, crank 0 with 1 m/s at its end, as in the library of the IFToMM."""
    free = drive({"A0": np.zeros_like}, end, 11, side="torque")
    told = flexarm.Drive(free.joints, {"A0": np.pi / 2}, 0.0, end, rates={"A0": -1.0})
    return flexarm.simulate(mechanisms.four_bar_windows(2), told, step=step, alpha=alpha, **more)


def upright_crank(time: np.ndarray) -> np.ndarray:
    """Angle of the cranks by J q'' = -V'(q), J = 3/3 + 2 kg m2 and V = 3.5 g sin q J."""

    def change(t, y):
        return [y[1], -3.5 * G * np.cos(y[0]) / 3.0]

    found = solve_ivp(change, (0, time[-1]), [np.pi / 2, -1.0], "DOP853", time, rtol=1e-12, atol=1e-13)
    return found.y[0]


def test_two_four_bars_pass_two_poses_in_line():
    """There three freedoms open for an instant; the mechanism goes on with all cranks parallel."""
    error = []
    for step in (4e-3, 2e-3):
        run = thrown(1.6, step)
        assert run.joint_angle[:, 0].min() < -np.pi  # both have been passed
        assert np.abs(run.joint_angle[:, 1:3] - run.joint_angle[:, :1]).max() < 1e-9
        error.append(np.abs(run.joint_angle[:, 0] - upright_crank(run.time)).max())
    assert error[1] < 9e-5
    assert error[0] / error[1] == approx(4, rel=0.05)


def test_two_four_bars_keep_their_energy_over_many_turns():
    """Through nine poses in line within the 10 s of the benchmark, with the default damping."""
    run = thrown(10.0, 2e-3, -0.05, energies=True)
    assert run.joint_angle[-1, 0] < -9 * np.pi
    balance = run.kinetic + run.gravity
    assert np.abs(balance - balance[0]).max() < 2e-4 * np.ptp(run.kinetic)


def bricard(step: float) -> flexarm.Simulation:
    return released(mechanisms.bricard(), "h0", 0.0, np.zeros_like, 10.0, step, -0.05, energies=True)


def test_bricards_mechanism_has_one_freedom_where_gruebler_counts_none():
    """One of six hinges' 5 conditions repeats; opposite angles are equal, sin a + sin b = sin a sin b."""
    energy, place = [], []
    for step in (4e-3, 2e-3):
        run = bricard(step)
        assert run.solver["redundant_conditions"] == 1
        a, b = run.joint_angle[:, 0], run.joint_angle[:, 1]
        assert np.ptp(a) > 3
        assert run.joint_angle[:, [2, 4, 3]] == approx(np.stack([a, a, b], axis=1), abs=1e-8)
        assert np.abs(np.sin(a) + np.sin(b) - np.sin(a) * np.sin(b)).max() < 1e-8
        total = run.kinetic + run.gravity
        energy.append(np.abs(total - total[0]).max() / np.ptp(run.kinetic))
        place.append(run.position[:: round(4e-3 / step), 0])
    assert energy[1] < 4e-5
    assert energy[0] / energy[1] > 3
    assert np.abs(place[0][:2500] - place[1][:2500]).max() < 1e-2


ACROSS = np.array([0.0, 2.0, -1.0]) / np.sqrt(5)
"""Axis of the pin of a cross in a spatial slider-crank, normal to the rod and to the slider's way."""
LEANING = np.array([-0.4, 1.2, -1.0]) / np.sqrt(2.6)
"""That of the test model of EXUDYN (`sliderCrank3Dtest.py`), 14 degrees from normal to the way."""


def cranked(pin: np.ndarray, end: float, step: float, **more) -> flexarm.Simulation:
    """The spatial slider-crank of the library of the IFToMM, begun at 6 rad/s."""
    free = drive({"A": np.zeros_like}, end, 11, side="torque")
    told = flexarm.Drive(free.joints, {"A": 0.0}, 0.0, end, rates={"A": 6.0})
    return flexarm.simulate(mechanisms.spatial_slider_crank(pin), told, step=step, **more)


def sum_of_coordinates(angles: np.ndarray, slider: float) -> float:
    """Absolute places and Euler parameters of crank and rod, which the test model of EXUDYN adds up."""
    a, roll, pin = angles
    start = np.array([0.2, -0.1, -0.2]) / 0.3
    turned = Rotation.from_rotvec([roll, 0, 0]) * Rotation.from_rotvec(pin * LEANING)
    rod = turned * Rotation.from_matrix(np.stack([start, LEANING, np.cross(start, LEANING)], axis=1))
    middle = np.array([slider, 0, 0]) - 0.15 * turned.apply(start)
    crank = [*mechanisms.CRANK_PIN, np.cos(a / 2), np.sin(a / 2)]
    return float(sum(np.abs(part).sum() for part in (crank, middle, rod.as_quat())))


def test_a_spatial_slider_crank_starts_and_goes_on_as_published():
    """Start of EXUDYN's test model to its ten digits; at 0.2 s its result, extrapolated within 1e-7."""
    found = []
    for step in (2e-3, 1e-3):
        run = cranked(LEANING, 0.2, step)
        _, slider, roll, pin = run.joint_rate[0]
        turning = np.array([roll, 0, 0]) + pin * LEANING
        assert slider == approx(0.24, abs=1e-12)
        assert turning == approx([1.6941176470530785, -0.8470588235366621, 0.705882352947701], abs=1e-10)
        found.append(sum_of_coordinates(run.joint_angle[-1, [0, 2, 3]], run.joint_angle[-1, 1]))
    assert abs(found[1] - 3.36427617809219) < 2e-6
    assert (4 * found[1] - found[0]) / 3 == approx(3.36427617809219, abs=1e-7)


@pytest.mark.slow
def test_a_spatial_slider_crank_moves_by_its_one_equation():
    """Over the five seconds of the benchmark, nine turns; of second order."""
    expected = mechanisms.SliderCrankEquation(ACROSS).run(np.linspace(0, 5, 51))
    assert expected[-1] > 16 * np.pi
    error, lost = [], []
    for step in (1e-3, 5e-4):
        run = cranked(ACROSS, 5.0, step, energies=True)
        error.append(np.abs(run.joint_angle[:: round(0.1 / step), 0] - expected).max())
        assert np.abs(run.position[:, 0] - run.position[:, 1]).max() < 1e-9
        balance = run.kinetic + run.gravity
        lost.append(np.abs(balance - balance[0]).max() / np.ptp(run.kinetic))
    assert error[1] < 3e-3
    assert lost[1] < 4e-4
    assert error[0] / error[1] > 3.5
    assert lost[0] / lost[1] == approx(4, rel=0.1)


def test_a_loop_without_damping_that_fails_says_what_helps():
    mechanism = mechanisms.four_bar_windows(2)
    for alpha, hint in ((0.0, "take alpha = -0.05"), (-0.05, "times to")):
        with pytest.raises(flexarm.NotConverged, match=hint + ".*$") as found:
            released(mechanism, "A0", 1.0, lambda t: np.full_like(t, 1e9), 1.0, 0.1, alpha)
        assert ("alpha" in str(found.value)) == (alpha == 0)


@pytest.mark.parametrize("alpha", [0.0, -0.05])
def test_a_pendulum_let_go_from_the_horizontal_swings_with_its_elliptic_period(alpha):
    """T = 4 K(1/2) sqrt(l/g) for a point mass on a bar without mass; second order from the first step on."""
    hinge = {"name": "q", "type": "revolute", "parent": "base", "child": "bob", "axis": [0, -1, 0]}
    pendulum = arm(joints=[hinge], links=[rigid("bob", 1.0, (1.0, 0, 0))])
    period = 4 * ellipk(0.5) / np.sqrt(G)
    error = []
    for steps in (500, 1000):
        run = released(pendulum, "q", 0.0, np.zeros_like, 0.25 * period, 0.25 * period / steps, alpha)
        error.append(abs(run.joint_angle[steps, 0] + np.pi / 2))
    assert error[1] < 3e-6
    assert error[0] / error[1] == approx(4, rel=0.1)


def test_derivatives_of_a_start_that_torques_do_not_hold_are_those_of_differences():
    """Of a crank with a payload, let go: the accelerations at the start depend on the parameter, too."""
    hinge = {"name": "q", "type": "revolute", "parent": "base", "child": "bob", "axis": [0, -1, 0]}
    key = "payloads.load.mass"

    def run(mass: float, **more) -> flexarm.Simulation:
        load = {"name": "load", "link": "bob", "position": [0.8, 0, 0.1], "mass": mass}
        model = arm(joints=[hinge], links=[rigid("bob", 1.0, (0.4, 0, 0), (0.1, 0.1, 0.1))], payloads=[load])
        return released(model, "q", 0.3, lambda t: 2.0 + 3.0 * t, 0.5, 2e-3, **more)

    for dimension in ("plane", "space"):
        found = run(2.0, sensitivities=[key], dimension=dimension).sensitivities.by(key)
        plus, minus = run(2.001, dimension=dimension), run(1.999, dimension=dimension)
        for name, most in (("joint_angle", 1e-6), ("joint_rate", 1e-6), ("joint_torque", 1e-5)):
            expected = (getattr(plus, name) - getattr(minus, name)) / 2e-3
            scale = max(np.abs(expected).max(), 1.0)
            assert found[name] == approx(expected, abs=most * scale), (dimension, name)


def test_steps_and_controllers_let_go_as_runs_do():
    """A pendulum without torque: steps of one's own, and a controller without gains and without back-EMF."""
    hinge = {"name": "q", "type": "revolute", "parent": "base", "child": "bob", "axis": [0, -1, 0]}
    silent = {"type": "state_feedback", "joint": "q", "position_gain": 0.0, "sample_time": 4e-3}
    motor = {"joint": "q", "resistance": 1e12, "torque_constant": 1e-3}
    bob = rigid("bob", 1.0, (1.0, 0, 0))
    run = released(arm(joints=[hinge], links=[bob]), "q", 0.0, np.zeros_like, 0.4, 2e-3, -0.05)
    sim = flexarm.Stepper(arm(joints=[hinge], links=[bob]), {"q": "torque"}, step=2e-3)
    state = sim.start(joints={"q": 0.0})
    for _ in range(200):
        state = sim.step(state, {"q": 0.0})
    assert sim.joint(state, "q").angle == approx(run.joint_angle[-1, 0], abs=1e-9)
    controlled = arm(joints=[hinge], links=[bob], controllers=[silent], motors=[motor])
    time = np.linspace(0, 0.4, 101)
    told = flexarm.Drive.from_samples(time, {"q": np.zeros(101)}, side="command")
    loop = flexarm.simulate(controlled, told, step=2e-3)
    assert loop.joint_angle[-1, 0] == approx(run.joint_angle[-1, 0], abs=1e-9)
