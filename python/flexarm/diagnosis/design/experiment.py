"""Experiments that have not been run: motion, sensors, payloads, and how well clocks and frames are known.

The virtual record of an experiment holds the readings of its sensors for a model. Experiments are made from a
drive, or from a record that is to be repeated. A sensor that states no noise has that of `NOISE`, and a
tracker a clock and a registration of its own, known to `CLOCK` and `FRAME`; `Experiment.assumed` lists these.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arm.joint import motor_ratio
from flexarm.arm.sensor import Sensor
from flexarm.comparison.alignment_parameters import drive_clock, is_unknown_clock, stated_placement
from flexarm.diagnosis.policy import DESIGN
from flexarm.drive import Drive
from flexarm.errors import InvalidParameter
from flexarm.measurement.measure import measure
from flexarm.record import Clock, Frame, Record, Signal
from flexarm.simulation import Simulation, simulate
from flexarm.wording import scale

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record.table import BaseStand, CarriedPayload, DrawnLink

TABLES = ("payloads", "links", "controllers", "base")
"""Tables of a record that change the model."""


@dataclass(frozen=True, eq=False)
class Experiment:
    """A run that may be made."""

    name: str
    """For people."""
    drive: Drive
    """The motion."""
    drivers: Mapping[str, str]
    """Joints that move and the signals that show it."""
    sensors: tuple[Sensor, ...]
    """Sensors besides those of the drive."""
    clocks: Mapping[str, Clock]
    """The first is that of the drive."""
    frames: Mapping[str, Frame]
    """Frames of trackers."""
    payloads: Mapping[str, CarriedPayload] = field(default_factory=dict)
    links: Mapping[str, DrawnLink] = field(default_factory=dict)
    controllers: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Payloads, lengths of links and settings of controllers, as in a record."""
    base: BaseStand | None = None
    """Stand of the base, as in a record."""
    assumed: tuple[str, ...] = ()
    """Sentences about what nobody stated."""

    def run(self, arm: Arm, step: float, alpha: float) -> Simulation:
        """Return the motion of a model."""
        carried = Record(signals={}, **self._tables).applied_to(arm)
        forces = any(sensor.quantity == "strain" for sensor in self.sensors)
        return simulate(carried, self.drive, step=step, alpha=alpha, rotations=True, forces=forces)

    @property
    def _tables(self) -> dict[str, Any]:
        """Those of `TABLES`."""
        return {name: getattr(self, name) for name in TABLES}

    def record(self, arm: Arm, step: float, alpha: float) -> Record:
        """Return what the sensors would write of a model; with their noise, which no difference of models
        sees.
        """
        run = self.run(arm, step, alpha)
        seen = measure(
            run,
            self.sensors,
            np.random.default_rng(0),
            clocks=self.clocks,
            frames=self.frames,
            joints=dict(self.drive.rest),
            **self._tables,
        )
        drives = [self._shown(joint, name, arm) for joint, name in self.drivers.items()]
        signals = {**{signal.name: signal for signal in drives}, **seen.signals}
        initial = "moving" if self.drive.lead else "equilibrium"
        drivers = tuple(self.drivers.values())
        return seen.replace(signals=signals, drive=drivers, initial=initial, description=self.name)

    def _shown(self, joint: str, name: str, arm: Arm) -> Signal:
        """Return the signal of a drive, exact."""
        moved = self.drive.joints[joint]
        count = max(round((self.drive.end - self.drive.start) * DESIGN.drive_hz), 8)
        time = np.linspace(self.drive.start, self.drive.end, count + 1)
        command = moved.side == "command"
        return Signal(
            name=name,
            quantity="joint_command" if command else "joint_angle",
            values=moved(time),
            time=time,
            unit="m" if arm.joint(joint).type == "prismatic" else "rad",
            noise_std=0.0,
            clock=next(iter(self.clocks)),
            joint=joint,
            side=None if command else "output" if moved.side == "output" else "motor",
        )

    # ------------------------------------------------------------------ variants

    def faster(self, times: float) -> Experiment:
        """Return the same path in another time."""
        drive = self.drive
        joints = {
            name: replace(
                each,
                breaks=drive.start + (each.breaks - drive.start) / times,
                coefficients=each.coefficients * times ** np.arange(len(each.coefficients))[::-1, None],
            )
            for name, each in drive.joints.items()
        }
        end = drive.start + (drive.end - drive.start) / times
        drive = replace(drive, joints=joints, end=end, lead=drive.lead / times)
        sensors = tuple(sensor.replace(start=sensor.start / times) for sensor in self.sensors)
        return replace(self, drive=drive, sensors=sensors)

    def turned(self, joint: str, angle: float) -> Experiment:
        """Return the same motion with a joint elsewhere [rad, m]."""
        drive = self.drive
        if joint not in drive.joints:
            rest = {**drive.rest, joint: drive.rest.get(joint, 0.0) + angle}
            return replace(self, drive=replace(drive, rest=rest))
        moved = drive.joints[joint]
        coefficients = moved.coefficients.copy()
        coefficients[-1] += angle
        joints = {**drive.joints, joint: replace(moved, coefficients=coefficients)}
        return replace(self, drive=replace(drive, joints=joints))


NOISE = {
    "position": 5e-5,
    "deflection": 5e-5,
    "orientation": 1e-4,
    "inclination": 1e-4,
    "joint_angle": 5e-6,
    "joint_rate": 1e-4,
    "angular_rate": 1e-3,
    "acceleration": 0.02,
    "strain": 1e-6,
    "force": 1.0,
    "motor_torque": 2.0,
}
"""1 sigma of sensors that state none [SI]: a laser tracker, an encoder, MEMS, a strain gauge, a load cell, a
torque at the output."""
CONTROLLER, TRACKER = "controller", "tracker"
CLOCK = Clock(sigma=2e-3)
FRAME = Frame(translation=1e-3, rotation=5e-4)
"""1 sigma of a tracker's clock [s] and registration [m], [rad]."""


def from_drive(
    name: str,
    drive: Drive,
    arm: Arm,
    clocks: Mapping[str, Clock] | None = None,
    frames: Mapping[str, Frame] | None = None,
) -> Experiment:
    """Return a motion beside the model's sensors, or, where it has none, a tracker at its last point."""
    motors = [s for s in arm.sensors if s.quantity == "joint_angle" and s.side != "output"]
    encoders = {joint: next((s.name for s in motors if s.joint == joint), joint) for joint in drive.joints}
    own = next((s.clock for s in arm.sensors if s.name in encoders.values() and s.clock), CONTROLLER)
    said: list[str] = []
    sensors = [sensor for sensor in arm.sensors if sensor.name not in encoders.values()]
    if not sensors:
        sensors = [_tracker(arm, drive)]
        said.append(
            f"a tracker of '{sensors[0].point}', the last of the model's points, with "
            f"{_size(NOISE['position'], 'm')} of noise at {DESIGN.tracker_hz:g} Hz and nothing else, since "
            "the model has no sensors: state those you have as [[sensors]]"
        )
    placed = [_placed(sensor, arm, said) for sensor in sensors]
    known_clocks, known_frames = dict(clocks or {}), dict(frames or {})
    late = {s.clock for s in placed if s.clock not in (None, own)} - set(known_clocks)
    where = {s.frame for s in placed if s.frame != "base"} - set(known_frames)
    if late:
        said.append(f"clocks are known to {_size(CLOCK.sigma, 's')}: {', '.join(sorted(map(str, late)))}")
    if where:
        said.append(
            f"registrations are known to {_size(FRAME.translation, 'm')} and {_size(FRAME.rotation, 'rad')}: "
            f"{', '.join(sorted(where))}"
        )
    return Experiment(
        name,
        drive,
        encoders,
        tuple(placed),
        {own: Clock(), **{str(clock): CLOCK for clock in sorted(map(str, late))}, **known_clocks},
        {**{frame: FRAME for frame in sorted(where)}, **known_frames},
        assumed=tuple(said),
    )


def from_record(name: str, record: Record, arm: Arm, noise: Mapping[str, float] | None = None) -> Experiment:
    """Return a motion that repeats a record: its signals, rates, clocks, frames and tables.

    `noise` is 1 sigma of signals that state none [SI]. Signals on a clock of unknown offset begin with it.
    """
    drive = Drive.from_record(record, arm)
    # after its last break a drive is held, where its rate would jump
    last = max((float(each.breaks[-1]) for each in drive.joints.values()), default=drive.end)
    drive = replace(drive, end=min(drive.end, last))
    drivers = {str(record.signals[d].joint): d for d in record.drive}
    tables = {name: getattr(record, name) for name in TABLES}
    own, clocks = drive_clock(record), _counted_from_drive(record)
    said: list[str] = []
    sensors = [
        _as_sensor(signal, arm, _start(record, signal, drive), noise or {}, said)
        for signal in record.signals.values()
        if signal.name not in record.drive and signal.quantity in NOISE and len(signal.time) > 1
    ]
    if not sensors:
        alone = from_drive(name, drive, arm, clocks, record.frames)
        return replace(alone, drivers=drivers, **tables)
    return Experiment(
        name,
        drive,
        drivers,
        tuple(sensors),
        {own: clocks[own], **clocks},
        record.frames,
        assumed=tuple(said),
        **tables,
    )


def _counted_from_drive(record: Record) -> dict[str, Clock]:
    """Return the clocks of a record, by how late they are with respect to that of the drive."""
    placed = stated_placement(record).clocks
    return {name: clock.replace(offset=placed[name].delay) for name, clock in record.clocks.items()}


def _start(record: Record, signal: Signal, drive: Drive) -> float:
    """Return how long after the drive a signal begins [s]; 0 where its clock does not tell."""
    if is_unknown_clock(record, signal.clock):
        return 0.0
    first = stated_placement(record).clock(signal).instants(signal.time[:1])
    return max(0.0, float(first[0]) - drive.start)


def _tracker(arm: Arm, drive: Drive) -> Sensor:
    """Return what is assumed where a model has no sensors."""
    if not arm.points:
        raise InvalidParameter(
            "has neither sensors nor points, so there is nothing to look at; add [[points]] or [[sensors]]",
            where="sensors",
        )
    name = arm.points[-1].name
    free = name if name not in drive.joints else f"{name}_tracker"
    noise = NOISE["position"]
    return Sensor(name=free, quantity="position", point=name, rate_hz=DESIGN.tracker_hz, noise_std=noise)


def _placed(sensor: Sensor, arm: Arm, said: list[str]) -> Sensor:
    """Return a sensor with noise, and, of a tracker that names neither clock nor frame, these."""
    changes: dict[str, Any] = {}
    if not sensor.noise_std and not sensor.step:
        sigma = _usual_noise(sensor, arm)
        changes["noise_std"] = sigma / sensor.si[1]
        said.append(_noise_told("sensor", sensor.name, sigma, sensor.si[0]))
    if sensor.quantity in ("position", "orientation") and sensor.clock is None and sensor.frame == "base":
        changes |= {"clock": TRACKER, "frame": TRACKER}
    return sensor.replace(**changes) if changes else sensor


def _usual_noise(what: Sensor | Signal, arm: Arm) -> float:
    """Return 1 sigma of a sensor or signal that states none [SI]; torques at a motor's shaft have less."""
    at_shaft = what.quantity == "motor_torque" and what.side != "output"
    return NOISE.get(what.quantity, 1.0) / (abs(motor_ratio(arm, str(what.joint))) if at_shaft else 1.0)


def _noise_told(kind: str, name: str, sigma: float, unit: str) -> str:
    return f"noise of {kind} '{name}' is {_size(sigma, unit)} (1 sigma), as it states none"


def _size(value: float, unit: str) -> str:
    """Return a round value with its unit."""
    factor, shown = scale([value], unit)
    return f"{factor * value:g} {shown}".rstrip()


def _as_sensor(signal: Signal, arm: Arm, start: float, noise: Mapping[str, float], said: list[str]) -> Sensor:
    """Return a sensor that would give a signal again, from `start` [s] after the drive on."""
    span = float(signal.time[-1] - signal.time[0])
    sigma = signal.noise_std or noise.get(signal.name)
    if not sigma:
        sigma = _usual_noise(signal, arm)
        said.append(_noise_told("signal", signal.name, sigma, signal.unit))
    shared = ("joint", "point", "link", "payload", "side", "position", "fibre", "clock", "frame")
    given: dict[str, Any] = {key: value for key in shared if (value := getattr(signal, key)) is not None}
    if signal.axes:
        given["axes"] = signal.axes
    return Sensor(
        name=signal.name,
        quantity=signal.quantity,
        unit=signal.unit or None,
        noise_std=float(sigma),
        rate_hz=(len(signal.time) - 1) / span,
        start=start,
        **given,
    )
