"""How large a hidden effect is: the gap that it leaves over the noise, with nuisances fitted along.

    size = max over channels of rms(g - S eta)/sigma,   |eta_i| <= 2 sigma_i                              (1)

g is the gap of a run that the effect makes in reflectors and torques, eta the delay and registration of the
tracker, the places of reflectors, moduli and the load, with what the record and the model say of them.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
from bench import FIRST, TORQUE_RATE, TRACKER_RATE, Bench, ran, rows_at
from hidden_effects import Hide
from robot_motion import Motion
from scipy.optimize import lsq_linear
from sensing import Sensors, Truth, motor_torques, tracked
from serial_chain import Floats
from virtual_lab import Lab

STEP, GAP_STEP = 1e-2, 2.5e-3  # s; enough for a size, without and with a gap
RUN = "train_a"
MODULUS, MASS, PLACE = 1e-2, 5e-3, 5e-4  # 1 sigma of nominal values: relative, relative, m


Channels = list[Floats]
"""One array a channel, in units of its noise: all axes of all reflectors, then torques."""


class Ruler:
    """Sizes of effects in one truth on one bench; what all sizes share is computed once."""

    def __init__(self, truth: Truth, bench: Bench) -> None:
        self.truth, self.bench = truth, bench
        self.motion = ran(truth, bench, RUN, STEP)
        self.zero = self._channels(truth, self.motion)
        self.velocity = self._velocity()
        self.slopes = np.column_stack([np.concatenate(column) for column in self._nuisances()])
        self.by_encoder: dict[str, Channels] = {}

    def size(self, changed: Truth) -> float:
        """(1) of what is changed."""
        gap = self._gap(changed)
        Q, R = np.linalg.qr(self.slopes)
        spread = lsq_linear(R, Q.T @ np.concatenate(gap), (-2.0, 2.0)).x
        left = np.concatenate(gap) - self.slopes @ spread
        ends = np.cumsum([len(channel) for channel in gap])[:-1]
        return float(max(np.sqrt(np.mean(channel**2)) for channel in np.split(left, ends)))

    def _channels(self, truth: Truth, motion: Motion) -> Channels:
        levels, seen = self.bench.levels, rows_at(motion, TRACKER_RATE, FIRST)
        read = [column for point in self.bench.points for column in tracked(truth, motion, seen, point).T]
        channels = [column / levels.tracker for column in read]
        if self.bench.rich:
            torques = motor_torques(truth, motion, rows_at(motion, TORQUE_RATE))
            channels += [torque / levels.torque for torque in torques.values()]
        return channels

    def _velocity(self) -> Channels:
        """Of reflectors; torques have the reference clock."""
        dense = [
            np.gradient(column, self.motion.time)[rows_at(self.motion, TRACKER_RATE, FIRST)] / self._noise
            for point in self.bench.points
            for column in tracked(self.truth, self.motion, np.arange(len(self.motion.time)), point).T
        ]
        return dense + [0 * channel for channel in self.zero[len(dense) :]]

    @property
    def _noise(self) -> float:
        return self.bench.levels.tracker

    def _difference(self, changed: Truth, motion: Motion | None = None, factor: float = 1.0) -> Channels:
        changes = self._channels(changed, motion or self.motion)
        return [factor * (new - old) for new, old in zip(changes, self.zero, strict=True)]

    def _nuisances(self) -> list[Channels]:
        """Changes by one sigma each."""
        lab, arm = Lab(), self.truth.arm
        ways = np.eye(3)[[0, 2]] if arm.planar else np.eye(3)
        turns = np.eye(3)[[1]] if arm.planar else np.eye(3)
        sensors = [Sensors().with_tracker(translation=tuple(lab.translation * way)) for way in ways]
        sensors += [Sensors().with_tracker(rotation=tuple(lab.rotation * turn)) for turn in turns]
        sensors += [Sensors().with_moved(point, PLACE * way) for point in self.bench.points for way in ways]
        columns = [self._difference(replace(self.truth, sensors=sensor)) for sensor in sensors]
        columns.append([lab.clock * channel for channel in self.velocity])
        for name in arm.tubes:
            columns.append(self._when(off_nominal(self.truth, {name: MODULUS})))
        return [*columns, self._when(off_nominal(self.truth, {}, MASS))]

    def _when(self, truth: Truth) -> Channels:
        return self._difference(truth, ran(truth, self.bench, RUN, STEP))

    def _gap(self, changed: Truth) -> Channels:
        """Measured less simulated, where the model takes stamps and encoders at their word."""
        moved = changed.robot != self.truth.robot
        gaps = any(turn.hub.gap for turn in changed.robot.turns)
        step = GAP_STEP if gaps else STEP
        gap = self._difference(changed, ran(changed, self.bench, RUN, step) if moved else None)
        t = self.motion.time[rows_at(self.motion, TRACKER_RATE, FIRST)]
        late = changed.sensors.tracker.stamps(t) - self.truth.sensors.tracker.stamps(t)
        for k, velocity in enumerate(self.velocity):
            if len(velocity) == len(late):
                gap[k] = gap[k] - velocity * late
        for joint in changed.sensors.encoders:
            self._misread(gap, changed, joint)
        return gap

    def _misread(self, gap: Channels, changed: Truth, joint: str) -> None:
        """Takes from the gap what the arm does along the wrong angle, as if it stood still."""
        if joint not in self.by_encoder:
            turn = self.truth.robot.turn(joint)
            self.by_encoder[joint] = self._when_turned(turn.name, 1e-3)
        t = self.motion.time[rows_at(self.motion, TRACKER_RATE, FIRST)]
        angle = self.bench.angles[RUN][joint](t)[0]
        wrong = changed.sensors.encoder(joint).read(angle) - self.truth.sensors.encoder(joint).read(angle)
        for k, slope in enumerate(self.by_encoder[joint]):
            if len(slope) == len(wrong):
                gap[k] = gap[k] - slope * wrong

    def _when_turned(self, joint: str, by: float) -> Channels:
        """Derivative of all channels by an angle that is added to a motor's."""
        angle = self.bench.angles[RUN][joint]

        def shifted(t: Floats) -> tuple[Floats, Floats, Floats]:
            phi, rate, acceleration = angle(t)
            return phi + by, rate, acceleration

        runs = {**self.bench.angles, RUN: {**self.bench.angles[RUN], joint: shifted}}
        motion = ran(self.truth, replace(self.bench, angles=runs), RUN, STEP)
        return self._difference(self.truth, motion, 1 / by)


def off_nominal(truth: Truth, moduli: dict[str, float], mass: float = 0.0) -> Truth:
    """With tubes and the load off their values by relative parts."""
    robot = truth.robot
    for name, part in moduli.items():
        tube = robot.carried_by(name).link
        stiff = {key: getattr(tube, key) * (1 + part) for key in ("EI", "GJ", "EA")}
        robot = robot.with_link(name, **stiff)
    last = robot.turns[-1]
    robot = robot.with_load(last.link_name, mass=last.link.load.mass * (1 + mass))
    return replace(truth, robot=robot)


def sized(
    ruler: Ruler, hide: Hide, at: str, target: float, seed: int, least: float = 0.0, most: float = inf
) -> tuple[float, float]:
    """p of a size within 10 %, or the nearest tried from `least` to `most`; and that size.

    Secants in logarithms, for gaps that grow as a power of p.
    """

    def size(p: float) -> float:
        return ruler.size(hide(ruler.truth, at, p, np.random.default_rng(seed))[0])

    first = min(max(1.0, least), most)
    tried, slope = [(first, size(first))], 1.0
    for _ in range(5):
        p, reached = tried[-1]
        bound = (p == least and reached > target) or (p == most and reached < target)
        if abs(reached / target - 1) < 0.1 or bound:
            break
        if len(tried) > 1:
            old_p, old = tried[-2]
            slope = float(np.clip(np.log(reached / old) / np.log(p / old_p), 0.3, 3.0))
        following = float(np.clip(p * (target / reached) ** (1 / slope), p / 10, 10 * p))
        following = min(max(following, least), most)
        tried.append((following, size(following)))
    return min(tried, key=lambda one: abs(np.log(one[1] / target)))
