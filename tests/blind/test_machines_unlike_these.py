"""Machines unlike those of the blind cases: coarser encoders, hardly known springs, models without any.

Virtual records of the simulator itself, noise and all: what is claimed is that the search finds its way from
far off, where arms swing out of step and everything seems explained by absurd values, not that the mechanics
are right, which the independent simulators say.
"""

from functools import cache

import numpy as np
import pytest
from arms import arm, beam, hinge, point, smooth_step

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.effects import CoulombFriction, JointCompliance
from flexarm.measurement import ClockError, Registration
from flexarm.record import Clock, Frame

pytestmark = pytest.mark.slow

ENCODER, TRACKER = np.radians(5e-4), 8e-5
END = 20.0
SLOW, FAST = ((14.0, 0.35), (9.0, 0.5)), ((6.0, 0.2), (4.1, 0.3))
"""Periods [s] and amplitudes [rad] of shoulder and elbow."""


def crane():
    """Two tubes, 2.6 and 2.1 m, that hold 45 kg."""
    section = [{"shape": "tube", "outer_diameter": d, "thickness": t} for d, t in ((0.2, 8e-3), (0.14, 6e-3))]
    known = {f"links.{link}.material.youngs_modulus": 0.02 for link in ("upper", "fore")}
    return arm(
        name="crane",
        gravity=[0, 0, -9.81],
        joints=[
            hinge("shoulder", "upper", gear_ratio=160),
            hinge("elbow", "fore", "upper", at="end", gear_ratio=100),
        ],
        links=[
            beam("upper", [2.6, 0, 0], section[0], elements=2, damping_ratio=0.01),
            beam("fore", [2.1, 0, 0], section[1], elements=2, damping_ratio=0.01),
        ],
        payloads=[{"name": "load", "link": "fore", "position": [2.1, 0, 0], "mass": 45.0}],
        points=[point("tip", "fore", [2.1, 0, 0.1]), point("knee", "upper", [2.6, 0, 0.15])],
        uncertainty=known,
    )


def spring(joint, stiffness):
    return JointCompliance(at=joint, stiffness=stiffness, damping=1e-3 * stiffness)


def machine(*more):
    found = crane()
    for effect in (spring("shoulder", 6e5), spring("elbow", 1.3e5), *more):
        found = found.with_effect(effect)
    return found


@cache
def record(real, motion, seed):
    """What encoders of half a thousandth of a degree and a late, displaced tracker show."""
    t = np.arange(0, END, 0.01)
    rise = smooth_step(t / 3)
    (one, a), (other, b) = motion
    angles = {
        "shoulder": -0.3 + a * rise * np.sin(2 * np.pi * t / one),
        "elbow": 0.8 + b * rise * np.sin(2 * np.pi * t / other),
    }
    run = flexarm.simulate(real, flexarm.Drive.from_samples(t, angles), step=2e-3)
    encoders = [
        Sensor(name=joint, quantity="joint_angle", joint=joint, rate_hz=100, noise_std=ENCODER, clock="plc")
        for joint in angles
    ]
    seen = {
        "quantity": "position",
        "rate_hz": 20,
        "noise_std": TRACKER,
        "clock": "tracker",
        "frame": "tracker",
    }
    return flexarm.measure(
        run,
        [*encoders, *(Sensor(name=name, point=name, **seen) for name in ("tip", "knee"))],
        np.random.default_rng(seed),
        drive=tuple(angles),
        clocks={"plc": Clock(), "tracker": Clock(sigma=0.02)},
        frames={"tracker": Frame(translation=1e-3, rotation=3e-4)},
        clock_errors={"tracker": ClockError(delay=0.012)},
        registrations={"tracker": Registration(translation=np.array([6e-4, -4e-4, 5e-4]))},
    )


def test_springs_within_their_wide_tolerance_are_refined_and_nothing_is_missing():
    """Stated to 30 %, 0.7 and 0.3 sigmas off: the gap is 6 times the noise, which drives shake besides."""
    model = crane().with_effect(spring("shoulder", 5e5)).with_effect(spring("elbow", 1.2e5))
    stated = {f"effects.joint_compliance.{joint}.stiffness": 0.3 for joint in ("shoulder", "elbow")}
    model = model.replace(uncertainty={**model.uncertainty, **stated})
    records = {"slow": record(machine(), SLOW, 1), "fast": record(machine(), FAST, 2)}
    found = flexarm.diagnose(model, records, n_jobs=1)
    assert (found.verdict, found.effects) == ("adequate", ())
    refined = {each.parameter: each for each in found.refined}
    for joint, true in (("shoulder", 6e5), ("elbow", 1.3e5)):
        each = refined[f"effects.joint_compliance.{joint}.stiffness"]
        assert each.value == pytest.approx(true, abs=3 * each.std)
        assert each.value == pytest.approx(true, rel=0.03)


def test_two_springs_and_friction_are_found_in_one_record_of_a_model_that_has_neither():
    """A forearm of thirty times its mass explains as much as one, and a modulus 300 sigmas off more."""
    real = machine(CoulombFriction(at="shoulder", torque=250.0))
    found = flexarm.diagnose(crane(), {"slow": record(real, SLOW, 3)}, n_jobs=1)
    named = {(effect.name, effect.at): effect for effect in found.effects}
    true = {
        ("joint_compliance", "shoulder"): 6e5,
        ("joint_compliance", "elbow"): 1.3e5,
        ("coulomb_friction", "shoulder"): 250.0,
    }
    assert found.verdict == "effects"
    assert named.keys() == true.keys()
    for place, value in true.items():
        assert named[place].probability > 0.9
        assert named[place].parameters[0].value == pytest.approx(value, rel=0.02)
