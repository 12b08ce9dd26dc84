"""Derivatives of runs, equilibria, modes and signals against differences of whole computations.

A difference of runs is only as good as Newton's iteration leaves them, and as its own step allows: runs are
converged to 1e-14 here, and two steps are extrapolated to an error of the fourth power.
"""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.helpers.arms import TUBE, G, beam, hinge, point, smooth_step

import flexarm
from flexarm.arm.parameter import parameters, with_value
from flexarm.arm.prior import Prior
from flexarm.simulation.prepared import prepared
from flexarm.simulation.solve import solved

END = 0.8  # s: a third of a swing, three periods of the first mode
STEP = 4e-3  # s


def swing_arm(**more: object) -> flexarm.Arm:
    """The paper's tube on a soft, damped hinge, with a body at its tip that leans out of the plane."""
    return flexarm.Arm.from_dict(
        {
            "gravity": [0.3, 0.0, -G],
            "joints": [{**hinge("hinge", "rod"), "gear_ratio": 120, "rotor_inertia": 1e-4}],
            "links": [beam("rod", [0, 0, 3.0], TUBE, theory="timoshenko", damping_ratio=0.01)],
            "payloads": [
                {
                    "name": "load",
                    "link": "rod",
                    "position": [0, 0, 3.0],
                    "mass": 14.1,
                    "inertia": [0.4, 0.3, 0.2],
                }
            ],
            "points": [point("tip", "rod", [0.05, 0.02, 3.1]), point("mid", "rod", [0, 0, 1.4])],
            "effects": [
                {"name": "joint_compliance", "at": "hinge", "stiffness": 8e4, "damping": 160.0},
                {"name": "viscous_friction", "at": "hinge", "coefficient": 30.0},
                {"name": "link_stiffness", "at": "rod", "scale": 0.95},
                {"name": "link_mass", "at": "rod", "scale": 1.05},
                {"name": "link_length", "at": "rod", "error": 2e-3},
                {"name": "link_bow", "at": "rod", "tip_offset": [4e-3, 2e-3, 0.0], "time_constant": 0.5},
                {"name": "payload_offset", "at": "load", "offset": [0.03, 0.02, 0.01]},
                {"name": "base_tilt", "at": "base", "angle": [4e-3, 7e-3]},
                {"name": "base_compliance", "at": "base", "stiffness": 4e5, "damping": 300.0},
                {
                    "name": "external_vibration",
                    "at": "base",
                    "amplitude": 20.0,
                    "frequency": 3.0,
                    "phase": 0.3,
                },
                {"name": "reflector_offset", "at": "tip", "offset": [1e-3, 2e-3, 3e-3]},
            ],
            **more,
        }
    )


def smooth_drive() -> flexarm.Drive:
    """From rest, 0.3 rad in END, smooth enough for a spline."""
    t = np.linspace(0, END, 33)
    return flexarm.Drive.from_samples(t, {"hinge": 0.3 * smooth_step(t / END)})


def converged(arm: flexarm.Arm, drive: flexarm.Drive) -> flexarm.Simulation:
    """A run whose Newton iterations end at rounding."""
    run = prepared(arm, drive, STEP, -0.05, None, True, True)
    run.options.tolerance = 1e-14
    return solved(run, None)


def difference(of: Callable[[float], NDArray], value: float, step: float) -> tuple[NDArray, float]:
    """df/dp by central differences of two steps, extrapolated, and by how much the two differ."""
    coarse, fine = ((of(value + h) - of(value - h)) / (2 * h) for h in (step, step / 2))
    return np.asarray((4 * fine - coarse) / 3), float(np.abs(fine - coarse).max(initial=0.0))


def size_of(arm: flexarm.Arm, key: str, value: float) -> float:
    """A step of differences: a thousandth of the value, or of what is plausible."""
    if value:
        return 1e-3 * abs(value)
    words = key.split(".", 3)
    effect = arm.effect(words[1], words[2]) if words[0] == "effects" else None
    prior: Prior | None = effect.priors(arm).get(words[3]) if effect else None
    return 1e-3 * max(abs(prior.low), abs(prior.high)) if prior else 1e-3


MECHANICS = [
    "links.rod.material.youngs_modulus",
    "links.rod.material.density",
    "links.rod.material.poisson_ratio",
    "links.rod.section.outer_diameter",
    "links.rod.section.thickness",
    "links.rod.damping_ratio",
    "links.rod.end.x",
    "payloads.load.mass",
    "payloads.load.inertia.y",
    "payloads.load.position.x",
    "points.tip.position.z",
    "joints.hinge.origin.xyz",
    "joints.hinge.origin.rpy.x",
    "joints.hinge.axis.z",
    "joints.hinge.rotor_inertia",
    "joints.hinge.gear_ratio",
    "effects.joint_compliance.hinge.stiffness",
    "effects.joint_compliance.hinge.damping",
    "effects.viscous_friction.hinge.coefficient",
    "effects.link_stiffness.rod.scale",
    "effects.link_mass.rod.scale",
    "effects.link_length.rod.error",
    "effects.link_bow.rod.tip_offset",
    "effects.link_bow.rod.time_constant",
    "effects.payload_offset.load.offset",
    "effects.base_tilt.base.angle",
    "effects.base_compliance.base.stiffness",
    "effects.base_compliance.base.damping",
    "effects.external_vibration.base.amplitude",
    "effects.external_vibration.base.frequency",
    "effects.external_vibration.base.phase",
    "effects.reflector_offset.tip.offset",
]


# Rates are coordinates over the step, and forces along the tube strains of 1e-16 times EA/L = 6e8 N/m:
# rounding of either weighs as much more.
COARSER = {
    "velocity": 5e-6,
    "joint_rate": 5e-6,
    "angular_rate": 5e-6,
    "section_forces": 2e-3,
    "base_wrench": 2e-5,
}


@pytest.fixture(scope="module")
def differentiated() -> flexarm.Simulation:
    """One run with the derivatives by everything."""
    return flexarm.simulate(
        swing_arm(), smooth_drive(), step=STEP, forces=True, rotations=True, sensitivities=MECHANICS
    )


@pytest.mark.parametrize("key", [p.key for p in parameters(swing_arm(), MECHANICS)])
def test_a_run_has_the_derivatives_of_differences(differentiated: flexarm.Simulation, key: str) -> None:
    """Every parameter, every array, to 1e-6 of the largest derivative of the array."""
    arm, drive = swing_arm(), smooth_drive()
    found = differentiated.sensitivities
    assert found is not None
    value = found.parameters[found.keys.index(key)].value
    step = size_of(arm, key, value)
    runs: dict[float, flexarm.Simulation] = {}

    def of(name: str) -> Callable[[float], NDArray]:
        def at(p: float) -> NDArray:
            if p not in runs:
                runs[p] = converged(with_value(arm, key, p), drive)
            return np.asarray(getattr(runs[p], name))

        return at

    for name, derivative in found.by(key).items():
        if key == "links.rod.end.x" and name == "section_forces":
            continue  # without `up` the section's axes follow another rule for each end
        expected, doubt = difference(of(name), value, step)
        largest = np.abs(np.asarray(getattr(differentiated, name))).max()
        # Where a parameter hardly moves an array, differences see its rounding: there both steps differ.
        floor = COARSER.get(name, 1e-6) * np.abs(expected).max() + 1e-12 * largest / step
        if name == "section_forces":
            floor += 2e-7 / (0.03 * step)  # N over the step with which outputs are differentiated
        assert np.abs(derivative - expected).max() <= floor + (0 if name == "position" else 10 * doubt), name


def test_an_equilibrium_has_the_derivatives_of_differences() -> None:
    """Arrays of `static`, by the mechanics of the model, under gravity and a point force."""
    arm, pose, push = swing_arm(), {"hinge": 0.4}, {"tip": [30.0, 10.0, -5.0]}
    keys = [
        key for key in MECHANICS if "damping" not in key and "vibration" not in key and "viscous" not in key
    ]
    found = flexarm.static(arm, pose, push, sensitivities=keys).sensitivities
    assert found is not None
    for parameter in found.parameters:
        step = size_of(arm, parameter.key, parameter.value)
        for name in ("position", "link_angle", "joint_torque"):

            def at(p: float, name: str = name, key: str = parameter.key) -> NDArray:
                return np.asarray(getattr(flexarm.static(with_value(arm, key, p), pose, push), name))

            expected, _ = difference(at, parameter.value, step)
            error = np.abs(found.by(parameter.key)[name] - expected).max()
            assert error <= 1e-6 * np.abs(expected).max() + 1e-12 / step, (parameter.key, name)


@pytest.mark.parametrize("pose", [0.0, 0.7])
def test_frequencies_have_the_derivatives_of_differences(pose: float) -> None:
    """Gravity shifts them through the equilibrium, which moves with the parameter."""
    arm = swing_arm()
    keys = [
        "links.rod.material.youngs_modulus",
        "links.rod.section.outer_diameter",
        "payloads.load.mass",
        "payloads.load.inertia.y",
        "effects.joint_compliance.hinge.stiffness",
        "effects.base_compliance.base.stiffness",
        "effects.link_length.rod.error",
        "effects.payload_offset.load.offset.x",
    ]
    found = flexarm.modes(arm, {"hinge": pose}, count=5, sensitivities=keys).sensitivities
    assert found is not None
    for parameter in found.parameters:
        step = size_of(arm, parameter.key, parameter.value)

        def at(p: float, key: str = parameter.key) -> NDArray:
            return np.asarray(flexarm.modes(with_value(arm, key, p), {"hinge": pose}, count=5).frequency_hz)

        expected, doubt = difference(at, parameter.value, step)
        error = np.abs(found.by(parameter.key)["frequency"] - expected).max()
        assert error <= 1e-6 * np.abs(expected).max() + doubt, parameter.key


def test_the_first_frequency_falls_by_half_the_share_of_the_payload() -> None:
    """A massless cantilever: f ~ m^(-1/2), so df/dm = -f/(2 m), and df/dE = f/(2 E)."""
    arm = flexarm.Arm.from_dict(
        {
            "gravity": [0.0, 0.0, 0.0],
            "joints": [hinge("hinge", "rod")],
            "links": [
                beam("rod", [1.0, 0, 0], {"shape": "round", "diameter": 0.02})
                | {"material": {"youngs_modulus": 70e9, "poisson_ratio": 0.3, "density": 0.0}}
            ],
            "payloads": [{"name": "load", "link": "rod", "position": [1.0, 0, 0], "mass": 2.0}],
        }
    )
    keys = ["payloads.load.mass", "links.rod.material.youngs_modulus"]
    found = flexarm.modes(arm, count=2, sensitivities=keys)
    assert found.sensitivities is not None
    f = found.frequency_hz[:, None]  # two modes of one frequency, one in each plane
    expected = f * [[-1 / (2 * 2.0), 1 / (2 * 70e9)]]
    assert found.sensitivities["frequency"] == pytest.approx(expected, rel=1e-8)


def test_friction_with_a_memory_is_differentiated_between_reversals() -> None:
    """Dahl's law is smooth along one direction, and its memory carries derivatives to the next step."""
    arm = swing_arm(
        effects=[
            {"name": "joint_compliance", "at": "hinge", "stiffness": 8e4, "damping": 160.0},
            {"name": "coulomb_friction", "at": "hinge", "torque": 40.0},
            {"name": "motor_friction", "at": "hinge", "coulomb": 15.0, "viscous": 5.0},
        ]
    )
    keys = [
        "effects.coulomb_friction.hinge.torque",
        "effects.motor_friction.hinge.coulomb",
        "effects.motor_friction.hinge.viscous",
        "links.rod.material.youngs_modulus",
    ]
    t = np.linspace(0, 0.4, 41)
    drive = flexarm.Drive.from_samples(t, {"hinge": 0.5 * t**3 * (1 + t)})  # one direction only
    found = flexarm.simulate(arm, drive, step=STEP, sensitivities=keys)
    assert found.sensitivities is not None
    for parameter in found.sensitivities.parameters:
        for name in ("position", "joint_angle", "motor_torque"):

            def at(p: float, name: str = name, key: str = parameter.key) -> NDArray:
                return np.asarray(getattr(converged(with_value(arm, key, p), drive), name))

            expected, doubt = difference(at, parameter.value, 1e-3 * parameter.value)
            error = np.abs(found.sensitivities.by(parameter.key)[name] - expected).max()
            assert error <= 2e-5 * np.abs(expected).max() + doubt, (parameter.key, name)


def test_a_motor_let_go_has_the_derivatives_of_its_start() -> None:
    """Driven by torque: the equilibrium in which the motor stood moves with the parameters too."""
    arm = swing_arm()
    drive = flexarm.Drive.from_samples([0.0, 0.2, 0.4], {"hinge": [0.0, 15.0, 30.0]}, side="torque")
    key = "payloads.load.mass"
    found = flexarm.simulate(arm, drive, step=STEP, sensitivities=[key])
    assert found.sensitivities is not None

    def at(p: float) -> NDArray:
        return np.asarray(converged(with_value(arm, key, p), drive).position)

    expected, _ = difference(at, 14.1, 0.0141)
    derivative = found.sensitivities.by(key)["position"]
    # Nothing holds the motor: what Newton leaves at each step adds up.
    assert np.abs(derivative - expected).max() < 1e-5 * np.abs(expected).max()


DRIVE_TRAIN = [
    {"name": "joint_compliance", "at": "hinge", "stiffness": 8e4, "damping": 160.0},
    {"name": "joint_stiffening", "at": "hinge", "cubic_stiffness": 4e8},
    {"name": "joint_hysteresis", "at": "hinge", "torque": 30.0, "width": 1e-3},
    {"name": "coulomb_friction", "at": "hinge", "torque": 20.0},
    {"name": "transmission_error", "at": "hinge", "amplitude": 2e-4, "multiple": 2.0, "phase": 0.3},
    {"name": "gear_ratio", "at": "hinge", "scale": 1.003},
    {"name": "cable_torque", "at": "hinge", "stiffness": 40.0, "rest_angle": 0.2},
]


@pytest.mark.parametrize(
    "key",
    [
        "joint_stiffening.hinge.cubic_stiffness",
        "joint_hysteresis.hinge.torque",
        "joint_hysteresis.hinge.width",
        "coulomb_friction.hinge.torque",
        "transmission_error.hinge.amplitude",
        "transmission_error.hinge.phase",
        "gear_ratio.hinge.scale",
        "cable_torque.hinge.stiffness",
        "cable_torque.hinge.rest_angle",
    ],
)
def test_laws_of_a_drive_train_have_the_derivatives_of_differences(key: str) -> None:
    """Hysteresis and friction with their memories, ripple and ratio through the transmission's constraint."""
    arm, key = swing_arm(effects=DRIVE_TRAIN), f"effects.{key}"
    t = np.linspace(0, 0.4, 41)
    drive = flexarm.Drive.from_samples(t, {"hinge": 0.3 * t**3 * (1 + t)})  # one direction only
    found = flexarm.simulate(arm, drive, step=1e-3, sensitivities=[key]).sensitivities
    assert found is not None
    value = found.parameters[0].value

    def at(p: float, name: str) -> NDArray:
        run = prepared(with_value(arm, key, p), drive, 1e-3, -0.05, None, False, False)
        run.options.tolerance = 1e-14
        return np.asarray(getattr(solved(run, None), name))

    for name in ("position", "joint_angle", "motor_torque"):
        expected, doubt = difference(lambda p, name=name: at(p, name), value, 1e-3 * value)
        error = np.abs(found.by(key)[name] - expected).max()
        # Dahl's law bends within 2e-5 rad: a step of differences sees its curvature.
        assert error <= 3e-4 * np.abs(expected).max() + doubt, name


def test_the_width_of_a_gap_is_differentiated_while_its_teeth_touch() -> None:
    """T = k (d - gap/2): the tip sinks by half the gap times the length of the arm, one to one."""
    arm = swing_arm(
        effects=[
            {"name": "joint_compliance", "at": "hinge", "stiffness": 8e4, "damping": 160.0},
            {"name": "backlash", "at": "hinge", "gap": 4e-4},
        ]
    )
    found = flexarm.static(arm, {"hinge": 0.8}, sensitivities=["effects.backlash.hinge.gap"])
    assert found.sensitivities is not None
    slope = np.linalg.norm(found.sensitivities["position"][0, :, 0])
    assert found.sensitivities["link_angle"][0, 0] == pytest.approx(0.5, rel=2e-2)  # gravity adds a little
    assert slope == pytest.approx(0.5 * 3.1, rel=3e-2)


def test_derivatives_in_the_plane_are_those_in_space() -> None:
    """A planar arm in three coordinates a node: the same derivatives, friction and hysteresis included."""
    arm = swing_arm(
        gravity=[0.0, 0.0, -G],
        payloads=[{"name": "load", "link": "rod", "position": [0, 0, 3.0], "mass": 14.1}],
        points=[point("tip", "rod", [0.05, 0.02, 3.1])],
        effects=DRIVE_TRAIN,
    )
    keys = [
        "links.rod.material.youngs_modulus",
        "links.rod.damping_ratio",
        "payloads.load.mass",
        "points.tip.position",
        "effects.joint_hysteresis.hinge.torque",
        "effects.coulomb_friction.hinge.torque",
        "effects.transmission_error.hinge.amplitude",
    ]
    runs = [
        flexarm.simulate(arm, smooth_drive(), step=STEP, dimension=where, sensitivities=keys)
        for where in ("plane", "space")
    ]
    assert [run.solver["dimension"] for run in runs] == [2, 3]
    plane, space = (run.sensitivities for run in runs)
    assert plane is not None and space is not None
    for name, expected in space.arrays.items():
        # Both are exact for their own iterates, which agree to Newton's tolerance.
        largest = np.abs(expected).max(axis=tuple(range(expected.ndim - 1)))
        assert np.all(np.abs(plane[name] - expected) <= 1e-7 * largest + 1e-12), name


def test_a_parameter_that_leads_out_of_the_plane_takes_the_run_into_space() -> None:
    arm = swing_arm(
        gravity=[0.0, 0.0, -G],
        payloads=[{"name": "load", "link": "rod", "position": [0, 0, 3.0], "mass": 14.1}],
        effects=[{"name": "payload_offset", "at": "load", "offset": [0.0, 0.0, 0.0]}],
    )
    key = "effects.payload_offset.load.offset.y"
    assert flexarm.simulate(arm, smooth_drive(), step=STEP).solver["dimension"] == 2
    assert flexarm.simulate(arm, smooth_drive(), step=STEP, sensitivities=[key]).solver["dimension"] == 3
    with pytest.raises(flexarm.InvalidParameter, match="does not move in a plane"):
        flexarm.simulate(arm, smooth_drive(), step=STEP, dimension="plane", sensitivities=[key])
