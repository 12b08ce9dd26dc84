"""A day in the laboratory: three runs of one arm with the same sensors, as records of flexarm.

Rich data: all reflectors, motor torques, a lively motion, stops with a light load that was weighed, another
lively motion held back. Poor data: the tip alone, one load, slow sines. Clock and frame of the tracker, and
how far nominal values are off, are the same in all three.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from joint_motions import Sines, Stops
from lab_arms import LabArm
from robot import Angle, Robot
from robot_motion import Motion, move
from sensing import Truth, motor_torques, tracked
from serial_chain import Floats
from virtual_lab import Lab

import flexarm
from flexarm import Record, Signal
from flexarm.record.table import CarriedPayload, Clock, Frame

RUNS = ("train_a", "train_b", "held_out")
STEP, FINE_STEP = 5e-3, 2.5e-3  # s; where there is a gap
ENCODER_RATE, TORQUE_RATE, TRACKER_RATE, FIRST = 250, 50, 10, 0.03  # Hz; s, the tracker's first instant
REACH = {"hinge": (0.2, 0.75), "waist": (0.0, 0.9), "shoulder": (0.15, 0.55), "elbow": (0.6, 0.65)}
"""Middle and amplitude of a joint's motion [rad]."""


@dataclass(frozen=True)
class Levels:
    """1 sigma of noise [rad, m, N m at the motor's shaft], and the share of rows that a tracker loses."""

    encoder: float = 2e-6
    tracker: float = 3e-5
    torque: float = 0.04
    lost: float = 0.02


@dataclass(frozen=True)
class Bench:
    """What is done on that day."""

    angles: Mapping[str, Mapping[str, Angle]]
    end: float
    rich: bool
    levels: Levels
    points: tuple[str, ...]
    light_load: float

    @classmethod
    def drawn(cls, arm: LabArm, rich: bool, rng: np.random.Generator) -> Bench:
        """Motions and noise by chance."""
        levels = Levels(tracker=rng.uniform(2.5e-5, 4.5e-5))
        names = [joint.name for joint in arm.joints]
        kinds = (_multisine, _stops, _multisine) if rich else (_sine, _sine, _sine)
        end = 32.0 if rich else 44.0
        angles = {
            run: {name: kind(name, end, rng) for name in names} for run, kind in zip(RUNS, kinds, strict=True)
        }
        return cls(angles, end, rich, levels, tuple(arm.reflectors) if rich else ("tip",), arm.light_load)

    def carried(self, run: str) -> float | None:
        """The load of a run, where it was weighed [kg]."""
        return self.light_load if self.rich and run == "train_b" else None


def _multisine(name: str, end: float, rng: np.random.Generator) -> Sines:
    middle, reach = REACH[name]
    frequencies = np.array([0.06, 0.13, 0.29, 0.55, 1.0]) * rng.uniform(0.8, 1.25, 5)
    shares = frequencies**-1.3 / np.sum(frequencies**-1.3)
    return Sines(
        reach * shares * rng.uniform(0.8, 1.2, 5), frequencies, rng.uniform(-np.pi, np.pi, 5), middle
    )


def _sine(name: str, end: float, rng: np.random.Generator) -> Sines:
    middle, reach = REACH[name]
    return Sines(
        [reach * rng.uniform(0.7, 1.2)], [rng.uniform(0.035, 0.06)], [rng.choice([0, np.pi])], middle
    )


def _stops(name: str, end: float, rng: np.random.Generator) -> Stops:
    middle, reach = REACH[name]
    starts = np.arange(1.0, end - 3.0, 3.0) + rng.uniform(0, 0.4)
    there = middle + reach * rng.uniform(-1, 1, len(starts))
    return Stops([middle, *there], list(starts), list(rng.uniform(1.1, 1.9, len(starts))))


def carrying(robot: Robot, mass: float | None) -> Robot:
    """With another load at the end; what sloshes is the same part of it."""
    if mass is None:
        return robot
    last = robot.turns[-1]
    load, slosh = last.link.load, robot.slosh
    part = slosh.mass / (slosh.mass + load.mass) if slosh else 0.0
    robot = robot.with_load(last.link_name, mass=mass * (1 - part))
    return replace(robot, slosh=replace(slosh, mass=mass * part)) if slosh else robot


def ran(truth: Truth, bench: Bench, run: str, step: float | None = None) -> Motion:
    """What the arm really did."""
    gaps = any(turn.hub.gap for turn in truth.robot.turns)
    step = step or (FINE_STEP if gaps else STEP)
    return move(carrying(truth.robot, bench.carried(run)), bench.angles[run], bench.end, step)


def rows_at(motion: Motion, rate: float, first: float = 0.0) -> Floats:
    """Rows of a motion at a rate [Hz] from a first instant [s]."""
    step = motion.time[1]
    return np.arange(round(first / step), len(motion.time), round(1 / (rate * step)))


def record_of(truth: Truth, bench: Bench, run: str, rng: np.random.Generator) -> tuple[Record, float]:
    """A run as it was recorded, and the noise in its tip [m], the root of the summed squares of all axes."""
    motion, levels, lab = ran(truth, bench, run), bench.levels, Lab()
    signals = [_encoder(truth, bench, run, joint.name, rng) for joint in truth.arm.joints]
    if bench.rich:
        signals += _torques(truth, motion, levels, rng)
    seen, noise = rows_at(motion, TRACKER_RATE, FIRST), 0.0
    for point in bench.points:
        clean = tracked(truth, motion, seen, point)
        errors = levels.tracker * rng.standard_normal(clean.shape)
        errors[rng.random(len(errors)) < levels.lost] = np.nan
        signals.append(_position(truth, point, motion.time[seen], clean + errors, levels))
        noise = float(np.sqrt(np.nanmean(errors**2) * errors.shape[1])) if point == "tip" else noise
    carried = bench.carried(run)
    record = Record(
        signals=signals,
        drive=tuple(joint.name for joint in truth.arm.joints),
        description=run.replace("_", " "),
        payloads={"load": CarriedPayload(mass=carried)} if carried else {},
        clocks={"controller": Clock(), "tracker": Clock(sigma=lab.clock)},
        frames={"tracker": Frame(translation=lab.translation, rotation=lab.rotation)},
    )
    return record, noise


def _encoder(truth: Truth, bench: Bench, run: str, joint: str, rng: np.random.Generator) -> Signal:
    time = np.arange(0, bench.end + 0.5 / ENCODER_RATE, 1 / ENCODER_RATE)  # to the last of all samples
    angle, sigma = bench.angles[run][joint](time)[0], bench.levels.encoder
    encoder = truth.sensors.encoder(joint)
    if encoder.step:
        read = encoder.read(angle + sigma * rng.standard_normal(len(time)))
    else:
        read = encoder.read(angle) + sigma * rng.standard_normal(len(time))
    about = dict(joint=joint, side="motor", clock="controller")
    return Signal(name=joint, quantity="joint_angle", time=time, values=read, noise_std=sigma, **about)


def _torques(truth: Truth, motion: Motion, levels: Levels, rng: np.random.Generator) -> list[Signal]:
    rows, signals = rows_at(motion, TORQUE_RATE), []
    for joint, clean in motor_torques(truth, motion, rows).items():
        read = clean + levels.torque * rng.standard_normal(len(rows))
        about = dict(joint=joint, side="motor", clock="controller", noise_std=levels.torque)
        time = motion.time[rows]
        signals.append(
            Signal(name=f"{joint}_torque", quantity="motor_torque", time=time, values=read, **about)
        )
    return signals


def _position(truth: Truth, point: str, time: Floats, values: Floats, levels: Levels) -> Signal:
    stamps = truth.sensors.tracker.stamps(time)
    about = dict(point=point, axes=truth.arm.axes, clock="tracker", frame="tracker", noise_std=levels.tracker)
    return Signal(name=point, quantity="position", time=stamps, values=values, **about)


def model_of(truth: Truth, bench: Bench) -> flexarm.Arm:
    """The model that an engineer has."""
    return truth.arm.model(truth.rigid, bench.points, truth.known)
