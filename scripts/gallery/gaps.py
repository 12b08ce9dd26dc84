"""The gap that an effect leaves: what the machine with it shows, minus what the model without it predicts.

    gap = y(machine, true drive) - prediction(model, encoder readings of the machine)                (1)

for every signal, without noise. An encoder that errs so shows at the tip, as in a real record, and the model
never sees the true angle. The other way round, a nuisance is a change of the prediction of the model alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from flexarm import Arm, Simulation, modes, simulate
from flexarm.comparison.gap import joint_directions
from flexarm.measurement.clocks import ClockError
from flexarm.measurement.frames import Registration
from flexarm.measurement.measure import measure
from flexarm.measurement.predict import predict
from flexarm.record import Frame, Record
from gallery.experiments import ENCODER, JOINT, NOISE, TRACKER, Experiment, Floats, Setup

Gap = Mapping[str, Floats]
"""By signal, shape (n, channels)."""
SEED = 2
"""Of `outliers`, the one effect that is random."""


@dataclass
class Bench:
    """One experiment on machines that differ from one model.

    Attributes
    ----------
    experiment : Experiment
        The run.
    model : Arm
        The model without the effect.
    """

    experiment: Experiment
    model: Arm
    right: Record = field(init=False)
    nominal: Simulation = field(init=False)

    def __post_init__(self) -> None:
        self.right = self.measured(self.model)
        self.nominal = simulate(self.model, self.right, step=self.experiment.step)

    def measured(self, machine: Arm) -> Record:
        """The record of a machine."""
        run = simulate(self.experiment.carrying(machine), self.experiment.drive(), step=self.experiment.step)
        return measure(
            run,
            self.experiment.sensors(),
            np.random.default_rng(SEED),
            drive=(ENCODER,),
            frames={TRACKER: Frame()},
            payloads=self.experiment.carried(),
        )

    def gap(self, machine: Arm) -> Gap:
        """Eq. (1); zero where a stamp lies beyond the run."""
        record = self.measured(machine)
        shown, right = record.signals[ENCODER], self.right.signals[ENCODER]
        same = np.array_equal(shown.values, right.values) and np.array_equal(shown.time, right.time)
        run = self.nominal if same else simulate(self.model, record, step=self.experiment.step)
        signals = {name: record.signals[name] for name in NOISE}
        return {name: np.nan_to_num(s.values - predict(run, s)) for name, s in signals.items()}  # eq. (1)

    def nuisances(self) -> Iterator[tuple[str, Gap]]:
        """Gaps for a late tracker and its registration: what every alignment takes away."""
        step = 1e-6
        unit = np.eye(3) * step
        changes = {"clock": (ClockError(delay=step), Registration())}
        for k, axis in enumerate("xyz"):
            changes[f"translation {axis}"] = (ClockError(), Registration(translation=unit[k]))
            changes[f"rotation {axis}"] = (ClockError(), Registration(rotation=unit[k]))
        signals = {name: self.right.signals[name] for name in NOISE}
        before = {name: predict(self.nominal, s) for name, s in signals.items()}
        for label, (clock, frame) in changes.items():
            after = {
                name: predict(self.nominal, s, clock, frame) if s.frame == TRACKER else before[name]
                for name, s in signals.items()
            }
            yield label, {name: np.nan_to_num((after[name] - before[name]) / step) for name in signals}


@cache
def bench(experiment: Experiment, model: Arm) -> Bench:
    """The bench of an experiment and a model."""
    return Bench(experiment, model)


def stacked(gaps: Mapping[Experiment, Gap], setup: Setup) -> Floats:
    """The gaps that a set-up sees, each over its noise, as one vector."""
    return np.concatenate(
        [(gaps[run][name] / NOISE[name]).ravel() for run, names in setup.items() for name in names]
    )


def at_tip(gap: Gap) -> bool:
    """Whether the tip shows it: more than a hundredth of the noise."""
    return bool(np.abs(gap["tip"]).max() > 0.01 * NOISE["tip"])


def by_direction(run: Bench, gap: Gap) -> dict[str, Floats]:
    """The tip's gap [m], tangential, radial and normal, shape (n,)."""
    angle = states(run)["angle"]
    directions = joint_directions(run.model, JOINT, "tip", {JOINT: angle})
    assert directions is not None
    return {name: np.sum(unit * gap["tip"], axis=1) for name, unit in directions.items()}


def states(run: Bench) -> dict[str, Floats]:
    """Time [s], angle [rad], rate [rad/s] and torque [N m] of the joint at the tip's samples, each (n,)."""
    time, motion = run.right.signals["tip"].time, run.nominal
    sampled = {
        "angle": np.interp(time, motion.time, motion.drive_angle[:, 0]),
        "rate": np.interp(time, motion.time, motion.drive_rate[:, 0]),
        "torque": np.interp(time, motion.time, motion.joint_torque[:, 0]),
    }
    return {**sampled, "time": time}


def slow_part(run: Bench, values: Floats) -> Floats:
    """Means over a period of the first mode, without its ringing; shorter by half a period at both ends."""
    half = round(run.experiment.rate_hz / first_mode(run.model) / 2)
    total = np.cumsum(np.concatenate([np.zeros_like(values[:1]), values]), axis=0)
    width = 2 * half + 1
    return np.asarray((total[width:] - total[:-width]) / width)


@cache
def first_mode(model: Arm) -> float:
    """Frequency of the first mode, upright [Hz]."""
    return float(modes(model, count=1).frequency_hz[0])
