"""Tables of a joint's state that bend a link, push a payload or turn the base."""

from pathlib import Path

import numpy as np
import pytest
from arms import (
    AREA,
    EI,
    LENGTH,
    STEEL,
    G,
    arm,
    beam,
    drive,
    general,
    hinge,
    paper_arm,
    point,
    rigid,
    smooth_step,
)
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from tests.verification.test_sensitivities import difference

import flexarm
from flexarm.arm.parameter import parameters, with_value
from flexarm.effects import BaseTilt, Effect, JointCompliance, LinkBow, TabulatedLaw
from flexarm.simulation.prepared import prepared
from flexarm.simulation.side_by_side import side_by_side
from flexarm.simulation.solve import solved

EXAMPLES = Path(__file__).parents[2] / "examples"
SPRING = JointCompliance(at="hinge", stiffness=8e4, damping=160.0)
ANGLES = (-0.2, 0.3, 0.9, 1.7)
SIZES = {"curvature": 2e-3, "force": 40.0, "windup": 2e-3}
PLACES = {"curvature": "rod", "force": "load", "windup": "base"}
RANGES = {"angle": ANGLES, "motor_angle": ANGLES, "rate": (-2.0, -0.1, 0.2, 2.0)}


def law(quantity: str, of: str = "angle", direction: str = "x", **more: object) -> TabulatedLaw:
    """A table that rises and falls."""
    value = tuple(SIZES[quantity] * each for each in (-1.0, 0.5, 1.0, -0.5))
    keys = {"x": RANGES[of], "value": value, **more}
    return TabulatedLaw(at=PLACES[quantity], quantity=quantity, of=of, direction=direction, **keys)


def constant(quantity: str, value: float, direction: str, of: str = "angle") -> TabulatedLaw:
    return law(quantity, of, direction, x=(-9.0, 9.0), value=(value, value))


def model(*effects: Effect, spring: bool = True) -> flexarm.Arm:
    """The paper's arm with a damped tube."""
    found = paper_arm(2, damping_ratio=0.01)
    return found.replace(effects=((SPRING, *effects) if spring else effects))


def angle(s: NDArray) -> NDArray:
    """From near the vertical to near the level, and half way back, at parts of the time."""
    return 0.1 + 1.3 * smooth_step(2 * s) - 0.6 * smooth_step(2 * s - 1)


def turn(end: float = 1.0) -> flexarm.Drive:
    return drive({"hinge": lambda t: angle(t / end)}, end, 201)


def run(arm: flexarm.Arm, step: float = 2e-3, end: float = 1.0) -> flexarm.Simulation:
    return flexarm.simulate(arm, turn(end), step=step)


def tip(arm: flexarm.Arm, angle: float = 0.0) -> NDArray:
    return np.asarray(flexarm.static(arm, {"hinge": angle}).position[0])


# ----------------------------------------------------------------------------------- at rest


@pytest.mark.parametrize("angle", [-1.0, -0.2, 0.3, 0.6, 0.9, 2.0])
def test_a_curvature_moves_the_tip_by_half_of_it_times_the_length_squared(angle):
    """Without gravity, towards the link's x; held beyond the knots."""
    bent = law("curvature")
    found = tip(model(bent, spring=False).replace(gravity=(0.0, 0.0, 0.0)), angle)
    across = np.array([np.cos(angle), 0.0, -np.sin(angle)])
    straight = LENGTH * np.array([np.sin(angle), 0.0, np.cos(angle)])
    kappa = float(bent(angle))
    expected = kappa * LENGTH**2 / 2
    assert (found - straight) @ across == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("direction", ["x", "y", "z"])
def test_a_force_deflects_the_tip_of_a_cantilever(direction):
    """F L^3/(3 E I) across the upright tube, which F L/(E A) stretches."""
    force = 0.5
    found = tip(model(constant("force", force, direction), spring=False).replace(gravity=(0.0, 0.0, 0.0)))
    across = force * LENGTH**3 / (3 * EI)
    expected = {
        "x": [across, 0, LENGTH],
        "y": [0, across, LENGTH],
        "z": [0, 0, LENGTH + force * LENGTH / (STEEL["youngs_modulus"] * AREA)],
    }[direction]
    assert found == pytest.approx(np.array(expected), abs=1e-4 * across)


def test_a_force_holds_a_rigid_pendulum_where_virtual_work_vanishes():
    """T = -(F cos(theta) + m g sin(theta)) L, with F along x at the payload's centre."""
    tables = {
        "gravity": [0, 0, -G],
        "joints": [hinge("hinge", "rod")],
        "links": [rigid("rod", 0.0)],
        "payloads": [{"name": "load", "link": "rod", "position": [0, 0, 2.0], "mass": 3.0}],
        "points": [point("tip", "rod", [0, 0, 2.0])],
    }
    pushed = law("force")
    for angle in (-0.4, 0.2, 0.7, 1.2):
        found = flexarm.static(arm(**tables).with_effect(pushed), {"hinge": angle}).joint_torque[0]
        work = 2.0 * np.cos(angle) * float(pushed(angle)) + 3.0 * G * 2.0 * np.sin(angle)
        assert found == pytest.approx(-work, rel=1e-9)


@pytest.mark.parametrize("direction", ["x", "y", "z"])
@pytest.mark.parametrize("angle", [0.1, 0.8])
def test_a_windup_of_the_base_turns_all_that_stands_on_it(direction, angle):
    turned = law("windup", direction=direction)
    still = model(spring=False).replace(gravity=(0.0, 0.0, 0.0))
    about = float(turned(angle)) * np.eye(3)["xyz".index(direction)]
    expected = Rotation.from_rotvec(about).apply(tip(still, angle).copy())
    assert tip(still.with_effect(turned), angle) == pytest.approx(expected, abs=1e-9)


# ---------------------------------------------------------------- against known effects


def close(one: flexarm.Simulation, two: flexarm.Simulation, part: float = 1e-8) -> None:
    for name in ("position", "joint_torque", "motor_torque", "joint_angle"):
        a, b = np.asarray(getattr(one, name)), np.asarray(getattr(two, name))
        assert np.abs(a - b).max() <= part * np.abs(b).max(), name


@pytest.mark.parametrize("direction", ["x", "y"])
def test_a_constant_curvature_is_a_bow(direction):
    kappa = 1.5e-3
    bow = LinkBow(at="rod", tip_offset=tuple(kappa * LENGTH**2 / 2 * np.eye(3)["xyz".index(direction)]))
    one, two = run(model(constant("curvature", kappa, direction))), run(model(bow))
    close(one, two)
    assert np.asarray(one.elastic) == pytest.approx(np.asarray(two.elastic), rel=1e-6, abs=1e-8)


def test_a_constant_curvature_of_a_beam_in_a_closed_loop_is_a_bow():
    loop = flexarm.Arm.from_toml(EXAMPLES / "parallelogram.toml")
    (bent,) = (link for link in loop.links if link.name == "lower")
    table = constant("curvature", 1e-3, "z").replace(at="lower")
    bow = LinkBow(at="lower", tip_offset=(0.0, 0.0, 1e-3 * bent.length**2 / 2))
    moved = drive({"shoulder": lambda t: 0.2 * smooth_step(t / 2)}, 2.0, 201)
    close(*(flexarm.simulate(loop.with_effect(effect), moved) for effect in (table, bow)))


@pytest.mark.parametrize("direction", ["x", "y", "z"])
def test_a_constant_force_is_a_force_of_the_stepper(direction):
    """A stated load at the same place."""
    force = 25.0 * np.eye(3)["xyz".index(direction)]
    tabulated = stepped(model(constant("force", 25.0, direction)), np.zeros(3))
    assert tabulated == pytest.approx(stepped(model(), force), abs=2e-9)
    assert np.abs(tabulated - stepped(model(), np.zeros(3))).max() > 1e-6


def stepped(arm: flexarm.Arm, force: NDArray) -> NDArray:
    """Places of the tip in a second, with a force there."""
    step = 2e-3
    sim = flexarm.Stepper(arm, {"hinge": "motor"}, forces=["tip"], step=step)
    first, *rest = angle(np.arange(0, 1, step))
    state = sim.start(joints={"hinge": first}, forces={"tip": force})
    tips = [sim.point(state, "tip").position]
    for each in rest:
        state = sim.step(state, {"hinge": each}, forces={"tip": force})
        tips.append(sim.point(state, "tip").position)
    return np.array(tips)


@pytest.mark.parametrize("direction", ["x", "y"])
def test_a_constant_windup_of_the_base_is_its_tilt(direction):
    """But for 1e9 N m/rad, a microradian per kN m, which lowers the frequency of a vibration by 4e-5."""
    tilt = 2e-3 * np.eye(3)["xyz".index(direction)]
    one = run(model(constant("windup", 2e-3, direction)), end=4.0)
    two = run(model(BaseTilt(at="base", angle=tuple(tilt[:2]))), end=4.0)
    close(one, two, 2e-4)


def test_a_force_against_the_angle_is_a_spring_at_the_tip():
    """A rigid pendulum: F = -c theta along x turns it as the torque -c theta L cos(theta) does."""
    L, c = 2.0, 30.0
    grid = np.linspace(-0.4, 1.6, 300)
    tables = {
        "gravity": [0, 0, -G],
        "joints": [hinge("hinge", "rod")],
        "links": [rigid("rod", 0.0)],
        "payloads": [{"name": "load", "link": "rod", "position": [0, 0, L], "mass": 3.0}],
        "points": [point("tip", "rod", [0, 0, L])],
        "effects": [SPRING],
    }
    pushed = law("force", x=tuple(grid), value=tuple(-c * grid))
    torque = TabulatedLaw(
        at="hinge", quantity="torque", of="angle", x=tuple(grid), value=tuple(c * grid * L * np.cos(grid))
    )
    one, two = (run(arm(**tables).with_effect(each)) for each in (pushed, torque))
    assert np.asarray(one.joint_angle) == pytest.approx(np.asarray(two.joint_angle), abs=2e-8)


def test_a_link_is_bent_by_the_joint_that_carries_it():
    tables = {
        "gravity": [0, 0, 0],
        "joints": [hinge("a", "upper"), hinge("b", "fore", "upper", at="end")],
        "links": [beam(name, [0, 0, 1.0], general(6e-4, 2e-7)) for name in ("upper", "fore")],
        "points": [point("tip", "fore", [0, 0, 1.0])],
    }
    bent = law("curvature").replace(at="fore")
    moved = flexarm.static(arm(**tables).with_effect(bent), {"a": 0.5, "b": -0.1}).position[0]
    straight = flexarm.static(arm(**tables), {"a": 0.5, "b": -0.1}).position[0]
    along = np.array([np.cos(0.4), 0.0, -np.sin(0.4)])
    assert (np.asarray(moved) - straight) @ along == pytest.approx(float(bent(-0.1)) / 2, rel=1e-4)


# ------------------------------------------------------------------------------ in motion

CASES = [(quantity, of) for quantity in SIZES for of in RANGES if (quantity, of) != ("windup", "rate")]


@pytest.mark.parametrize(("quantity", "of"), CASES)
def test_an_error_of_the_step_is_of_the_second_order(quantity, of):
    """A smooth table: the parts of the error that ring are small beside it."""
    x = np.linspace(RANGES[of][0], RANGES[of][-1], 60)
    value = SIZES[quantity] * np.sin(2 * x)
    moved = model(law(quantity, of, "y" if quantity == "windup" else "x", x=tuple(x), value=tuple(value)))
    fine = np.asarray(run(moved, 2.5e-4).position)[::32]
    errors = [
        np.abs(np.asarray(run(moved, step).position)[:: round(8e-3 / step)] - fine).max()
        for step in (4e-3, 2e-3)
    ]
    assert 3.0 < errors[0] / errors[1] < 6.0


@pytest.mark.parametrize(("quantity", "of"), CASES)
def test_energy_is_accounted_for(quantity, of):
    """Kinetic + elastic + gravity + damped - work stays: sums over steps of 0.5 ms leave 1e-4 of it."""
    found = run(model(law(quantity, of, "y")), 5e-4)
    total = found.kinetic + found.elastic + found.gravity + found.damped - found.work
    assert np.ptp(total) <= 1e-4 * np.ptp(found.gravity)


@pytest.mark.parametrize(("quantity", "of"), CASES)
def test_energy_is_accounted_for_while_a_law_changes_in_a_damped_tube(quantity, of):
    """Neither the power of the change nor the damper of the beam may be missing: they are 2e-4 and more."""
    after = tuple(SIZES[quantity] * each for each in (0.8, -1.0, 0.2, 1.0))
    changing = law(quantity, of, "y", value_after=after, instant=0.5, duration=0.2)
    found = run(paper_arm(2, damping_ratio=0.3).replace(effects=(SPRING, changing)), 5e-4)
    total = found.kinetic + found.elastic + found.gravity + found.damped - found.work
    assert np.ptp(total) <= 1e-4 * np.ptp(found.gravity)


@pytest.mark.parametrize("quantity", list(SIZES))
def test_an_arm_that_stays_in_its_plane_is_simulated_there(quantity):
    within, across = ("y", "x") if quantity == "windup" else ("x", "y")
    assert run(model(law(quantity, direction=within))).solver["dimension"] == 2
    assert run(model(law(quantity, direction=across))).solver["dimension"] == 3


@pytest.mark.parametrize("quantity", list(SIZES))
def test_runs_side_by_side_are_those_one_by_one(quantity):
    """Curvatures and forces are left to runs of their own; a turning base is not."""
    arms = [model(law(quantity, direction="y").with_values(np.full(4, size))) for size in (0.0, 1e-3)]
    together = side_by_side([(each, turn()) for each in arms], step=2e-3)
    assert all((each is None) == (quantity != "windup") for each in together)
    for one, each in zip(together, arms, strict=True):
        if one is not None:
            close(one, run(each), 1e-7)


@pytest.mark.parametrize("spring", [True, False], ids=["compliant", "rigid"])
@pytest.mark.parametrize(("quantity", "of"), CASES)
def test_derivatives_are_those_of_whole_runs(quantity, of, spring):
    """With respect to a value, and to load and modulus beside it; rates do not reach the knots."""
    x = (-40.0, -6.0, 6.0, 40.0) if of == "rate" else ANGLES
    arm = model(law(quantity, of, "y" if quantity == "windup" else "x", x=x), spring=spring)
    place = f"effects.tabulated_law.{PLACES[quantity]}.value.1"
    keys = [place, "payloads.load.mass", "links.rod.material.youngs_modulus"]

    def converged(each: flexarm.Arm) -> NDArray:
        case = prepared(each, turn(2.0), 4e-3, -0.05, None, True, True)
        case.options.tolerance = 1e-14
        return np.asarray(solved(case, None).position)

    found = flexarm.simulate(arm, turn(2.0), step=4e-3, sensitivities=keys).sensitivities
    assert found is not None
    for key, size in zip(keys, (1e-3 * SIZES[quantity], 0.1, 2e8), strict=True):
        value = parameters(arm, [key])[0].value
        expected, doubt = difference(lambda v, key=key: converged(with_value(arm, key, v)), value, size)
        error = np.abs(found.by(key)["position"] - expected).max()
        assert error <= 1e-6 * np.abs(expected).max() + 10 * doubt, key


@pytest.mark.parametrize("quantity", list(SIZES))
def test_derivatives_of_an_equilibrium_are_those_of_differences(quantity):
    arm, key = model(law(quantity, direction="y")), f"effects.tabulated_law.{PLACES[quantity]}.value.1"
    found = flexarm.static(arm, {"hinge": 0.6}, sensitivities=[key]).sensitivities
    assert found is not None
    expected, doubt = difference(
        lambda v: flexarm.static(with_value(arm, key, v), {"hinge": 0.6}).position,
        parameters(arm, [key])[0].value,
        1e-3 * SIZES[quantity],
    )
    assert np.abs(found.by(key)["position"] - expected).max() <= 1e-6 * np.abs(expected).max() + doubt + 1e-12


@pytest.mark.parametrize("quantity", list(SIZES))
def test_a_change_at_an_instant_goes_from_one_table_to_the_other(quantity):
    changing = law(quantity, value_after=(0.0,) * 4, instant=0.5).replace(direction="y")
    one, before = run(model(changing)), run(model(law(quantity, direction="y")))
    t = np.asarray(one.time)
    early = t < 0.48
    assert np.asarray(one.position)[early] == pytest.approx(np.asarray(before.position)[early], abs=1e-9)
    assert np.abs(np.asarray(one.position) - before.position)[~early].max() > 1e-4


def test_modes_hold_the_values_of_tables():
    """Those of the bent arm, and of the pushed one."""
    bow = LinkBow(at="rod", tip_offset=(float(law("curvature")(0.6)) * LENGTH**2 / 2, 0.0, 0.0))
    one, two = (
        flexarm.modes(model(each, spring=False), {"hinge": 0.6}, count=3) for each in (law("curvature"), bow)
    )
    assert one.frequency_hz == pytest.approx(two.frequency_hz, rel=1e-9)
    base = flexarm.modes(model(law("windup", direction="y")), {"hinge": 0.6}, count=3)
    assert base.frequency_hz == pytest.approx(
        flexarm.modes(model(), {"hinge": 0.6}, count=3).frequency_hz, rel=1e-3
    )
