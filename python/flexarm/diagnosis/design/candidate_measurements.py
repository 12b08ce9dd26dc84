"""Candidate measurements that can be added to an experiment: a reflector, the motor's torque, another
payload, speed or pose.

Costs are minutes of somebody's time, roughly: a sensor is mounted once, a run is made again. They only order
what parts two effects equally well.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.attachment import Point
from flexarm.arm.link import Beam
from flexarm.arm.sensor import Sensor
from flexarm.assembly import following_joints, rigid_values
from flexarm.diagnosis.design.experiment import CONTROLLER, NOISE, Experiment
from flexarm.diagnosis.policy import DESIGN
from flexarm.errors import InvalidParameter
from flexarm.record.table import CarriedPayload
from flexarm.simulation import Simulation

MINUTES = {"torque": 15.0, "run": 30.0, "payload": 45.0, "reflector": 60.0}
"""To log a signal, to make one more run, with another payload that is weighed, to glue a reflector."""


@dataclass(frozen=True, eq=False)
class Addition:
    """Something that may be added."""

    words: str
    """Description, such as "with the motor torque of hinge logged"."""
    minutes: float
    """Its cost."""
    points: tuple[Point, ...] = ()
    """Reflectors that it needs."""
    sensors: tuple[Sensor, ...] = ()
    """Sensors that are added to every run."""
    runs: tuple[Experiment, ...] = ()
    """Runs that are made besides."""


def menu(arm: Arm, runs: Sequence[Experiment], first: Simulation) -> list[Addition]:
    """All that can be added to some runs, by cost; `first` is a simulation of the first."""
    found = [*_torques(runs[0], first), *_reflectors(arm, runs), *_motions(arm, runs[0])]
    return sorted(found, key=lambda addition: addition.minutes)


def with_points(arm: Arm, additions: Sequence[Addition]) -> Arm:
    """Return the model with the reflectors of additions, which stand where they should to `DESIGN.glued`."""
    points = [point for addition in additions for point in addition.points]
    uncertain = {f"points.{point.name}.position_m": DESIGN.glued for point in points}
    return arm.replace(points=(*arm.points, *points), uncertainty={**arm.uncertainty, **uncertain})


def _torques(run: Experiment, simulation: Simulation) -> Iterator[Addition]:
    seen = {s.joint for s in run.sensors if s.quantity == "motor_torque"}
    clock = next(iter(run.clocks), CONTROLLER)
    for joint in run.drive.joints:
        if joint in seen or joint not in simulation.joints:
            continue
        torque = simulation.motor_torque[:, simulation.joints.index(joint)]
        noise = DESIGN.torque_noise * float(np.abs(torque).max())
        if not noise > 0:
            continue
        sensor = Sensor(
            name=_free(f"{joint}_torque", run),
            quantity="motor_torque",
            joint=joint,
            side="output",
            rate_hz=_rate(run),
            noise_std=noise,
            clock=clock,
            start=DESIGN.settled * (run.drive.end - run.drive.start),
        )
        yield Addition(f"with the motor torque of {joint} logged", MINUTES["torque"], sensors=(sensor,))


def _reflectors(arm: Arm, runs: Sequence[Experiment]) -> Iterator[Addition]:
    """At mid-span and hub of every beam that has none there."""
    run = runs[0]
    seen = {s.point for s in run.sensors if s.quantity == "position"}
    for link in arm.links:
        if not isinstance(link, Beam):
            continue
        length = float(np.linalg.norm(link.end))
        along = np.asarray(link.end) / length
        there = [
            float(along @ np.asarray(p.position)) / length
            for p in arm.points
            if p.name in seen and p.link == link.name
        ]
        for place, where, share in (
            ("mid", 0.5 * np.asarray(link.end), 0.5),
            ("hub", DESIGN.lever * _across(arm, link), 0.0),
        ):
            if any(abs(share - each) < DESIGN.near for each in there):
                continue
            name = _free(f"{link.name}_{place}", run, [p.name for p in arm.points])
            point = Point(name=name, link=link.name, position=tuple(float(x) for x in where))
            like = next((s for s in run.sensors if s.quantity == "position"), None)
            sensor = Sensor(
                name=name,
                quantity="position",
                point=name,
                axes=like.axes if like else ("x", "y", "z"),
                rate_hz=_rate(run),
                noise_std=like.noise_std * like.si[1] if like and like.noise_std else NOISE["position"],
                clock=like.clock if like else next(iter(run.clocks)),
                frame=like.frame if like else "base",
            )
            words = "at mid-span" if place == "mid" else f"{DESIGN.lever:g} m off the hub"
            yield Addition(
                f"with a reflector {words} of {link.name}",
                MINUTES["reflector"],
                (point,),
                (sensor,),
            )


def _motions(arm: Arm, run: Experiment) -> Iterator[Addition]:
    """Return the first run again, with another payload, speed or pose."""
    for load in arm.payloads:
        carried = run.payloads.get(load.name)
        mass = carried.mass if carried is not None and carried.mass is not None else load.mass
        if mass:
            other = CarriedPayload(mass=DESIGN.lighter * mass)
            again = replace(run, payloads={**run.payloads, load.name: other})
            words = f"with {other.mass:.3g} kg for {load.name}, weighed"
            yield Addition(words, MINUTES["payload"], runs=(again,))
    for times, words in ((0.5, "at half the speed"), (2.0, "at twice the speed")):
        yield Addition(words, MINUTES["run"], runs=(run.faster(times),))
    following = following_joints(arm, (), run.drive.joints)
    still = [j for j in arm.joints if j.moves and j.name not in {*run.drive.joints, *following}]
    driven = [j for j in arm.joints if j.name in run.drive.joints]
    shafts = {gear.input for gear in arm.gears}
    for joint in (*still[:1], *driven[:1]):
        if joint.name in shafts:
            continue
        turn, unit = (DESIGN.turn, "rad") if joint.type == "revolute" else (DESIGN.turn / 10, "m")
        words = f"with {joint.name} moved by {turn:g} {unit} throughout"
        elsewhere = run.turned(joint.name, turn)
        if _closes(arm, elsewhere):
            yield Addition(words, MINUTES["run"], runs=(elsewhere,))


def _closes(arm: Arm, run: Experiment) -> bool:
    """Return True if the loops of the arm close along the drives of a run."""
    if not arm.closures:
        return True
    time = np.linspace(run.drive.start, run.drive.end, 16)
    driven = {name: joint(time) for name, joint in run.drive.joints.items()}
    try:
        for k in range(len(time)):
            rigid_values(arm, {**run.drive.rest, **{name: float(at[k]) for name, at in driven.items()}})
    except InvalidParameter:
        return False
    return True


def _across(arm: Arm, link: Beam) -> np.ndarray:
    """Across a link, in the plane in which its joint turns it."""
    joint = next((j for j in arm.joints if j.child == link.name and j.type == "revolute"), None)
    along = np.asarray(link.end) / np.linalg.norm(link.end)
    axis = np.array([0.0, 1.0, 0.0]) if joint is None else np.asarray(joint.axis, dtype=float)
    across = np.cross(axis, along)
    if np.linalg.norm(across) < 1e-6:  # the joint turns the link about its own axis
        across = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
    found: np.ndarray = across / np.linalg.norm(across)
    return found


def _rate(run: Experiment) -> float:
    """Return the rate of an added sensor [Hz]: that of the trackers."""
    return next((s.rate_hz for s in run.sensors if s.quantity == "position"), DESIGN.tracker_hz)


def _free(name: str, run: Experiment, more: Sequence[str] = ()) -> str:
    """Return a name that nothing has yet."""
    taken = {*more, *(s.name for s in run.sensors), *run.drivers.values()}
    while name in taken:
        name += "_2"
    return name
