"""Effects of the vocabulary hidden in a laboratory's truth: `hide` takes one, its place and how large it is.

Each function returns the changed truth and the parameters by their names; p scales it, about proportional to
the gap it leaves, and what else there is to choose comes from the generator, the same for every p.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf

import numpy as np
from chain import Base, Vibration
from lab_arms import LabArm
from robot import Vector
from sensing import Truth

Parameters = dict[str, float]
Hide = Callable[[Truth, str, float, np.random.Generator], tuple[Truth, Parameters]]
BASE = {"stiffness": 9e5, "damping": 900.0}
"""Of the base, where a model knows that it gives way [N m/rad, N m s/rad]."""


def _sign(rng: np.random.Generator) -> float:
    return 1.0 if rng.random() < 0.5 else -1.0


def _direction(truth: Truth, rng: np.random.Generator) -> np.ndarray:
    """A unit vector, in the plane if the arm is."""
    v = rng.standard_normal(3)
    if truth.arm.planar:
        v[1] = 0.0
    return v / np.linalg.norm(v)


def _vector(name: str, v: np.ndarray) -> Parameters:
    return {f"{name}.{axis}": float(x) for axis, x in zip("xyz", v, strict=False) if x != 0}


def _triple(v: np.ndarray) -> Vector:
    return (float(v[0]), float(v[1]), float(v[2]))


def _in_hub(truth: Truth, at: str, **changes: float) -> Truth:
    return replace(truth, robot=truth.robot.with_hub(at, **changes))


def _stiffness(truth: Truth, at: str) -> float:
    return next(joint.stiffness for joint in truth.arm.joints if joint.name == at)


def _load_link(truth: Truth) -> str:
    return truth.arm.joints[-1].link_name


def joint_compliance(truth, at, p, rng):
    """Hidden in a joint that the model takes to be rigid."""
    k = 3 * _stiffness(truth, at) * rng.uniform(0.8, 1.2) / p
    return _in_hub(truth, at, stiffness=k, damping=2e-3 * k), {"stiffness": k, "damping": 2e-3 * k}


def joint_stiffening(truth, at, p, rng):
    k3 = p * 0.3 * _stiffness(truth, at) / 1.5e-3**2
    return _in_hub(truth, at, cubic=k3), {"cubic_stiffness": k3}


def joint_hysteresis(truth, at, p, rng):
    width, torque = rng.uniform(2e-4, 4e-4), 15.0 * p
    return _in_hub(truth, at, hysteresis=torque, hysteresis_width=width), {"torque": torque, "width": width}


def backlash(truth, at, p, rng):
    return _in_hub(truth, at, gap=4e-4 * p), {"gap": 4e-4 * p}


def coulomb_friction(truth, at, p, rng):
    return _in_hub(truth, at, coulomb=15.0 * p), {"torque": 15.0 * p}


def viscous_friction(truth, at, p, rng):
    return _in_hub(truth, at, viscous=50.0 * p), {"coefficient": 50.0 * p}


def motor_friction(truth, at, p, rng):
    coulomb, viscous = 8.0 * p, 12.0 * p
    hidden = _in_hub(truth, at, motor_coulomb=coulomb, motor_viscous=viscous)
    return hidden, {"coulomb": coulomb, "viscous": viscous}


def transmission_error(truth, at, p, rng):
    multiple, phase, amplitude = float(rng.choice([1, 2])), rng.uniform(-np.pi, np.pi), 2e-4 * p
    hidden = _in_hub(truth, at, error_amplitude=amplitude, error_multiple=multiple, error_phase=phase)
    return hidden, {"amplitude": amplitude, "multiple": multiple, "phase": phase}


def gear_ratio(truth, at, p, rng):
    scale = 1 + _sign(rng) * 1e-3 * p
    return _in_hub(truth, at, ratio_scale=scale), {"scale": scale}


def cable_torque(truth, at, p, rng):
    rest = rng.uniform(-0.3, 0.3)
    return _in_hub(truth, at, cable=25.0 * p, cable_rest=rest), {"stiffness": 25.0 * p, "rest_angle": rest}


def payload_mass(truth, at, p, rng):
    link = _load_link(truth)
    mass = truth.arm.tubes[link].load.mass * max(1 + _sign(rng) * 0.05 * p, 0.05)
    return replace(truth, robot=truth.robot.with_load(link, mass=mass)), {"mass": mass}


def payload_offset(truth, at, p, rng):
    link, v = _load_link(truth), 0.04 * p * _direction(truth, rng)
    offset = _triple(np.add(truth.arm.tubes[link].load.offset, v))
    return replace(truth, robot=truth.robot.with_load(link, offset=offset)), _vector("offset", v)


def payload_inertia(truth, at, p, rng):
    link = _load_link(truth)
    inertia = truth.arm.tubes[link].load.inertia + 0.6 * p
    return replace(truth, robot=truth.robot.with_load(link, inertia=inertia)), {"inertia": inertia}


def link_stiffness(truth, at, p, rng):
    scale = max(1 + _sign(rng) * 0.05 * p, 0.2)
    EI = scale * truth.arm.tubes[at].rods.EI
    return replace(truth, robot=truth.robot.with_link(at, EI=EI)), {"scale": scale}


def link_mass(truth, at, p, rng):
    scale, rods = max(1 + _sign(rng) * 0.1 * p, 0.2), truth.arm.tubes[at].rods
    heavier = truth.robot.with_link(at, rho_A=scale * rods.rho_A, rho_I=scale * rods.rho_I)
    return replace(truth, robot=heavier), {"scale": scale}


def link_length(truth, at, p, rng):
    error = _sign(rng) * 3e-3 * p
    longer = truth.robot.with_link(at, length=truth.arm.tubes[at].length + error)
    return replace(truth, robot=longer), {"error": error}


def link_damping(truth, at, p, rng):
    zeta = 0.02 + 0.03 * p
    return replace(truth, robot=truth.robot.with_link(at, damping_ratio=zeta)), {"damping_ratio": zeta}


def link_bow(truth, at, p, rng):
    v, time = 3e-3 * p * _direction(truth, rng), float(rng.choice([0.0, 8.0]))
    v[2] = 0.0
    bowed = truth.robot.with_link(at, bow=(float(v[0]), float(v[1])), bow_time=time)
    return replace(truth, robot=bowed), _vector("tip_offset", v) | ({"time_constant": time} if time else {})


def base_tilt(truth, at, p, rng):
    angle = rng.uniform(-np.pi, np.pi)
    x, y = (0.0, _sign(rng)) if truth.arm.planar else (np.cos(angle), np.sin(angle))
    tilt = (5e-3 * p * x, 5e-3 * p * y)
    return replace(truth, robot=replace(truth.robot, tilt=tilt)), _vector("angle", np.array(tilt))


def base_compliance(truth, at, p, rng):
    k = BASE["stiffness"] * rng.uniform(0.8, 1.2) / p
    base = Base(k, 1e-3 * k)
    return replace(truth, robot=replace(truth.robot, base=base)), {"stiffness": k, "damping": 1e-3 * k}


def external_vibration(truth, at, p, rng):
    amplitude, frequency, phase = 40.0 * p, rng.uniform(1.1, 3.6), rng.uniform(-np.pi, np.pi)
    base = replace(truth.robot.base, vibration=Vibration(amplitude, frequency, phase))
    found = {"amplitude": amplitude, "frequency": frequency, "phase": phase}
    return replace(truth, robot=replace(truth.robot, base=base)), found


def encoder_offset(truth, at, p, rng):
    offset = _sign(rng) * 3e-3 * p
    return replace(truth, sensors=truth.sensors.with_encoder(at, offset=offset)), {"offset": offset}


def encoder_scale(truth, at, p, rng):
    scale = 1 + _sign(rng) * 1e-3 * p
    return replace(truth, sensors=truth.sensors.with_encoder(at, scale=scale)), {"scale": scale}


def encoder_eccentricity(truth, at, p, rng):
    amplitude, phase = 1e-3 * p, rng.uniform(-np.pi, np.pi)
    hidden = truth.sensors.with_encoder(at, amplitude=amplitude, phase=phase)
    return replace(truth, sensors=hidden), {"amplitude": amplitude, "phase": phase}


def encoder_quantisation(truth, at, p, rng):
    return replace(truth, sensors=truth.sensors.with_encoder(at, step=5e-4 * p)), {"step": 5e-4 * p}


def time_delay(truth, at, p, rng):
    delay = _sign(rng) * 5e-3 * p
    return replace(truth, sensors=truth.sensors.with_tracker(delay=delay)), {"delay": delay}


def clock_drift(truth, at, p, rng):
    rate = _sign(rng) * 3e-4 * p
    return replace(truth, sensors=truth.sensors.with_tracker(rate=rate)), {"rate": rate}


def frame_registration(truth, at, p, rng):
    v = 5e-3 * p * _direction(truth, rng)
    return replace(truth, sensors=truth.sensors.with_tracker(translation=_triple(v))), _vector(
        "translation", v
    )


def frame_drift(truth, at, p, rng):
    v = 5e-5 * p * _direction(truth, rng)
    return replace(truth, sensors=truth.sensors.with_tracker(velocity=_triple(v))), _vector("velocity", v)


def reflector_offset(truth, at, p, rng):
    v = 4e-3 * p * _direction(truth, rng)
    return replace(truth, sensors=truth.sensors.with_moved(at, _triple(v))), _vector("offset", v)


def sensor_offset(truth, at, p, rng):
    joint, offset = at.removesuffix("_torque"), _sign(rng) * 0.3 * p
    offsets = {**truth.sensors.torque_offsets, joint: offset}
    return replace(truth, sensors=replace(truth.sensors, torque_offsets=offsets)), {"offset": offset}


@dataclass(frozen=True)
class Hidden:
    """An effect that can be hidden: how, at what kind of place, and whether poor data can show it.

    From the `least` p on it is beyond four sigma of the nominal value or nuisance that would excuse it; above
    the `most` it is no machine's.
    """

    hide: Hide
    place: str
    poor: bool = True
    least: float = 0.0
    most: float = inf


_KINDS = {
    "rigid joint": [joint_compliance],
    "soft joint": [joint_stiffening, joint_hysteresis, backlash],
    "joint": [coulomb_friction, viscous_friction, transmission_error, gear_ratio, cable_torque],
    "load": [payload_mass, payload_offset, payload_inertia],
    "link": [link_stiffness, link_mass, link_length, link_damping, link_bow],
    "base": [base_tilt, base_compliance],
    "soft base": [external_vibration],
    "encoder": [encoder_offset, encoder_scale, encoder_eccentricity, encoder_quantisation],
    "tracker": [time_delay, clock_drift, frame_registration, frame_drift],
    "point": [reflector_offset],
}
_LEAST = {"link_stiffness": 1.0, "link_length": 0.8, "payload_mass": 0.5, "reflector_offset": 0.8}
_LEAST |= {"time_delay": 1.2, "frame_registration": 1.0}
_MOST = {"joint_hysteresis": 40.0, "link_damping": 10.0, "payload_offset": 3.0, "payload_inertia": 2.0}
HIDDEN = {
    hide.__name__: Hidden(
        hide, place, least=_LEAST.get(hide.__name__, 0.0), most=_MOST.get(hide.__name__, inf)
    )
    for place, hides in _KINDS.items()
    for hide in hides
}
HIDDEN |= {"motor_friction": Hidden(motor_friction, "joint", poor=False)}
HIDDEN |= {"sensor_offset": Hidden(sensor_offset, "torque", poor=False)}


def places(effect: str, arm: LabArm) -> tuple[str, ...]:
    """Where an effect can sit on an arm, as `at` says it."""
    joints = tuple(joint.name for joint in arm.joints)
    kind = HIDDEN[effect].place
    if kind.endswith("joint") or kind == "encoder":
        return joints
    if kind == "point":
        return ("tip",)
    if kind == "torque":
        return tuple(f"{name}_torque" for name in joints)
    return {"link": tuple(arm.tubes), "load": ("load",), "tracker": ("tracker",)}.get(kind, ("base",))


def other_places(effect: str, at: str, points: tuple[str, ...]) -> list[str]:
    """All that says the same: the tracker's clock and frame stand for its signals."""
    return [at, *points] if HIDDEN[effect].place == "tracker" else [at]


def before(effect: str, at: str, truth: Truth) -> Truth:
    """The truth that an effect is hidden in: a rigid joint, a base that the model knows to give way."""
    kind = HIDDEN[effect].place
    if kind == "rigid joint":
        return replace(_in_hub(truth, at, stiffness=np.inf, damping=0.0), rigid=(*truth.rigid, at))
    if kind == "soft base":
        base = {"name": "base_compliance", "at": "base", **BASE}
        soft = replace(truth.robot, base=Base(**BASE))
        return replace(truth, robot=soft, known=(*truth.known, base))
    return truth
