"""A motion of the chain of rods as a lab would have recorded it: a flexarm Record with noise and nuisances.

The tracker's clock is late by an unknown delay; its frame is off by a small turn about y and a shift, so that
it reads R p + s. The record states their sigmas alone. Nothing of flexarm but the container is used.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from chain import Floats
from motion import Arm, Drive, move

from flexarm import Record, Signal
from flexarm.record.table import Clock, Frame

ENCODER_RATE, TORQUE_RATE = 200, 50  # Hz


@dataclass(frozen=True)
class Nuisances:
    """What is true of the tracker: delay of its stamps [s], shift (x, z) [m] and turn about y [rad]."""

    delay: float = 0.0
    shift: tuple[float, float] = (0.0, 0.0)
    turn: float = 0.0

    @classmethod
    def drawn(cls, sigmas: Lab, rng: np.random.Generator) -> Nuisances:
        """As likely as the record says they are; one laboratory keeps them for all its records."""
        shift = sigmas.translation * rng.standard_normal(2)
        return cls(
            sigmas.clock * rng.standard_normal(), tuple(shift), sigmas.rotation * rng.standard_normal()
        )


@dataclass(frozen=True)
class Lab:
    """Sensors: 1 sigma of their noise, of clock and frame; rate and drop-outs of the tracker."""

    encoder: float = 2e-6
    tracker: float = 4e-5
    torque: float = 0.05
    clock: float = 1.5e-3
    translation: float = 8e-4
    rotation: float = 4e-4
    rate: float = 10.0
    lost: float = 0.02


def record(
    arm: Arm,
    drive: Drive,
    end: float,
    rng: np.random.Generator,
    lab: Lab | None = None,
    nuisances: Nuisances | None = None,
    points: Mapping[str, tuple[float, tuple[float, float]]] | None = None,
    torque: bool = True,
) -> Record:
    """The record of a motion from 0 to `end` [s].

    Parameters
    ----------
    points : dict of str to (fraction, offset)
        Reflectors: fraction of the length, offset across and along; default: the tip.
    torque : bool
        Log the motor's torque too.
    """
    lab, nuisances = lab or Lab(), nuisances or Nuisances()
    points = {"tip": (1.0, (0.0, 0.0))} if points is None else points
    fast, seen = np.arange(0, end, 1 / ENCODER_RATE), np.arange(0.3 / lab.rate, end, 1 / lab.rate)
    run = move(arm, drive, np.union1d(fast, seen))
    driven, tracked = np.isin(run.time, fast), np.isin(run.time, seen)
    angle = run.motor_angle[driven] + lab.encoder * rng.standard_normal(len(fast))
    signals = [
        Signal(
            name="hinge",
            quantity="joint_angle",
            joint="hinge",
            side="motor",
            time=fast,
            values=angle,
            noise_std=lab.encoder,
            clock="controller",
        )
    ]
    if torque:
        every = slice(None, None, ENCODER_RATE // TORQUE_RATE)
        values = run.motor_torque[driven][every]
        signals.append(
            Signal(
                name="torque",
                quantity="motor_torque",
                joint="hinge",
                side="output",
                time=fast[every],
                values=values + lab.torque * rng.standard_normal(len(values)),
                noise_std=lab.torque,
                clock="controller",
            )
        )
    for name, (fraction, offset) in points.items():
        signals.append(
            Signal(
                name=name,
                quantity="position",
                point=name,
                axes=("x", "z"),
                time=seen + nuisances.delay,
                values=_read(run.place(fraction, offset)[tracked], lab, nuisances, rng),
                noise_std=lab.tracker,
                clock="tracker",
                frame="tracker",
            )
        )
    return Record(
        signals=signals,
        drive=("hinge",),
        clocks={"controller": Clock(), "tracker": Clock(sigma=lab.clock)},
        frames={"tracker": Frame(translation=lab.translation, rotation=lab.rotation)},
    )


def _read(p: Floats, lab: Lab, nuisances: Nuisances, rng: np.random.Generator) -> Floats:
    """Turned about +y (z towards x), shifted, noisy, and lost now and then."""
    c, s = np.cos(nuisances.turn), np.sin(nuisances.turn)
    read = p @ np.array([[c, -s], [s, c]]) + nuisances.shift
    read += lab.tracker * rng.standard_normal(read.shape)
    read[rng.random(len(read)) < lab.lost] = np.nan
    return read
