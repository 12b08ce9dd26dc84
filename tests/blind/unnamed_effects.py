"""What no name of the vocabulary covers, and sensors that are at fault."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hidden_effects import Hide
from robot import Slosh
from sensing import Truth

import flexarm


def drag(truth, at, p, rng):
    """Air that brakes the tip with the square of its speed."""
    return replace(truth, robot=replace(truth.robot, drag=20.0 * p)), {"drag": 20.0 * p}


def hardening_link(truth, at, p, rng):
    """A last link whose stiffness grows with its curvature."""
    hardened = truth.robot.with_link(truth.arm.joints[-1].link_name, hardening=60.0 * p)
    return replace(truth, robot=hardened), {"hardening": 60.0 * p}


def swaying_tracker(truth, at, p, rng):
    """A tracker whose stand oscillates at 0.7 Hz."""
    way = (1e-3 * p, 0.0, 0.3e-3 * p)
    swayed = truth.sensors.with_tracker(sway=way, sway_hz=0.7)
    return replace(truth, sensors=swayed), {"sway": 1e-3 * p, "frequency": 0.7}


def warming_link(truth, at, p, rng):
    """A first tube that grows longer as it warms, with 9 s."""
    warmed = truth.robot.with_link(next(iter(truth.arm.tubes)), growth=2e-3 * p, bow_time=9.0)
    return replace(truth, robot=warmed), {"growth": 2e-3 * p, "time_constant": 9.0}


def sloshing_load(truth, at, p, rng):
    """A part of the load on a spring across the last link."""
    link = truth.arm.joints[-1].link_name
    load, part = truth.robot.carried_by(link).link.load, min(0.08 * p, 0.8)
    robot = truth.robot.with_load(link, mass=load.mass * (1 - part))
    slosh = Slosh(load.mass * part, 1.3, 0.02)
    return replace(truth, robot=replace(robot, slosh=slosh)), {"part": part, "frequency": 1.3}


def _at_soft_joint(truth, **changes):
    """A change of the last joint that the model knows to be soft, or of the last one, which is soft then."""
    soft = [turn for turn in truth.robot.turns if not turn.hub.rigid]
    joint = (soft or truth.robot.turns)[-1].name
    return replace(truth, robot=truth.robot.with_hub(joint, **changes))


def softening_joint(truth, at, p, rng):
    """A joint that loses a part of its stiffness in the middle of every record."""
    part = min(0.15 * p, 0.9)
    return _at_soft_joint(truth, softened=part, softens_at=12.0), {"part": part, "instant": 12.0}


def opening_crack(truth, at, p, rng):
    """A joint that is softer to one side, as a crack that opens makes it."""
    part = min(0.15 * p, 0.9)
    return _at_soft_joint(truth, cracked=part), {"part": part}


def slipping_clamp(truth, at, p, rng):
    """A clamp that lets a link slip on its joint once in every record."""
    hidden = truth.robot.with_hub(truth.arm.joints[-1].name, slip=4e-4 * p, slips_at=11.0)
    return replace(truth, robot=hidden), {"angle": 4e-4 * p, "instant": 11.0}


def rubbing_bearing(truth, at, p, rng):
    """A bearing that rubs near one angle."""
    joint, middle = truth.arm.joints[0].name, rng.uniform(-0.1, 0.1)
    hidden = truth.robot.with_hub(joint, rub=40.0 * p, rub_at=middle, rub_width=0.08)
    return replace(truth, robot=hidden), {"torque": 40.0 * p, "angle": middle}


def soft_stop(truth, at, p, rng):
    """A rubber stop that the first joint leans on beyond one angle."""
    joint, begin = truth.arm.joints[0].name, rng.uniform(0.0, 0.2)
    hidden = truth.robot.with_hub(joint, stop=150.0 * p, stop_at=begin)
    return replace(truth, robot=hidden), {"stiffness": 150.0 * p, "angle": begin}


def coupled_joints(truth, at, p, rng):
    """A last motor that the first one turns along, as cables through a common hub do."""
    part = 1e-3 * p
    return replace(truth, robot=replace(truth.robot, coupling=part)), {"part": part}


OUTSIDE: dict[str, Hide] = {
    hide.__name__: hide
    for hide in (
        drag,
        hardening_link,
        swaying_tracker,
        warming_link,
        sloshing_load,
        softening_joint,
        opening_crack,
        slipping_clamp,
        rubbing_bearing,
        soft_stop,
        coupled_joints,
    )
}
SEVERAL_JOINTS = ("coupled_joints",)
"""Of these, what an arm of one joint cannot have: there it is a gear ratio."""
FAULTS = ("dead_channel", "sign_error", "unit_error", "saturation", "outliers")


def with_fault(record: flexarm.Record, fault: str, signal: str, rng: np.random.Generator) -> flexarm.Record:
    """A record with one signal at fault; the same generator, the same fault."""
    read = record.signals[signal]
    values = np.array(read.values)
    if fault == "dead_channel":
        values[:, 0] = values[np.isfinite(values[:, 0]), 0][0]
    elif fault == "sign_error":
        values[:, 0] = -values[:, 0]
    elif fault == "unit_error":
        values = values * 1e3
    elif fault == "saturation":
        limit = np.nanquantile(np.abs(values[:, 0]), 0.8)
        values[:, 0] = np.clip(values[:, 0], -limit, limit)
    else:
        hit = rng.random(len(values)) < 0.03
        values[hit] += rng.choice([-1, 1], (hit.sum(), values.shape[1])) * rng.uniform(0.01, 0.05)
    return record.replace(signals={**record.signals, signal: read.replace(values=values)})


def fault_signal(fault: str, truth: Truth) -> str:
    """Where a fault sits: tip, or a motor's torque, whose range ends first."""
    if fault == "saturation":
        return f"{truth.arm.joints[-1].name}_torque"
    return "tip"
