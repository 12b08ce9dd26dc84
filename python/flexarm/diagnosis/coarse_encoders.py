"""Encoders that count in coarse steps.

Their readings lie on a quantisation grid (`flexarm.record.quantisation_grid`). The motion of the drive
between two counts is lost, and moves everything it drives. The size of that error follows from rounding once
more: with f the smoothed drive,

    y'_i = step round((f(t_i) + u)/step) - u,    u uniform within a step                              (1)

is about as far from f as f is from the truth. The difference of the simulations along both is an error of
each channel, added to its noise. Near a mode one u errs up to ten times as much as another: the largest error
of `NOISE_MODEL.draws` of them counts, `NOISE_MODEL.quantisation_factor` times.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.joint_units import parameters_in
from flexarm.arrays import Floats
from flexarm.diagnosis.noise_model import (
    allow_for_input_noise,
    input_noise_by_signal,
    smoothed,
    weighted_by_input_noise,
)
from flexarm.diagnosis.policy import NOISE_MODEL
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.simulation_cache import SimulationCache
from flexarm.effects.encoder_quantisation import EncoderQuantisation
from flexarm.measurement.effects_of import effects_of
from flexarm.measurement.encoder import quantised
from flexarm.named_effects import Estimate, NamedEffect
from flexarm.record import Record
from flexarm.record.quantisation_grid import FEW, quantisation_step
from flexarm.wording import with_unit


@dataclass(frozen=True)
class CoarseEncoder:
    """A coarse encoder, its step and the error that it causes."""

    effect: EncoderQuantisation
    """Effect with the step that was seen."""
    unit: str
    """Of the step: rad, or m along a prismatic joint."""
    over_noise: float
    """The step over the stated noise of the encoder."""
    moves: str
    """The signal with the largest error."""
    error: float
    """Rms of that error over the noise."""

    def named(self, probability: float) -> NamedEffect:
        """Return the encoder as a named effect: its step is seen in the readings."""
        step = self.effect.step
        exact = Estimate("step", step, 1e-4 * step, (1 - 2e-4) * step, (1 + 2e-4) * step, self.unit)
        return NamedEffect(EncoderQuantisation.name, self.effect.at, probability, (exact,), (), self.evidence)

    @property
    def evidence(self) -> str:
        """Return what shows the step, and what it does."""
        return (
            f"all readings of {self.effect.at} are {with_unit(self.effect.step, self.unit, 4)} apart or "
            f"multiples of it, {self.over_noise:.0f} times the stated noise; what the arm did between two "
            f"counts is lost, and moves {self.moves} by {self.error:.1f} times its noise"
        )


def coarse_encoders(arm: Arm, records: Mapping[str, Record]) -> tuple[EncoderQuantisation, ...]:
    """Return coarse encoders of drives whose steps neither the records nor the model state."""
    steps: dict[str, list[float]] = {}
    for record in records.values():
        for name in record.drive if record.kind == "motion" else ():
            signal = record.signals[name]
            stated = arm.effect(EncoderQuantisation.name, name) is not None
            rests = len(np.unique(signal.values[signal.valid])) < FEW  # then no step can be told
            if signal.quantity == "joint_angle" and not stated and not rests:
                step = quantisation_step(signal.values[:, 0])
                covered_by_noise = step <= NOISE_MODEL.coarse_count * (signal.noise_std or np.inf)
                steps.setdefault(name, []).append(0.0 if covered_by_noise else step)
    return tuple(
        EncoderQuantisation(at=name, step=float(np.median(found)))
        for name, found in steps.items()
        if min(found) > 0 and max(found) < 1.01 * min(found)
    )


def with_errors_of_drives(
    problem: Problem, seed: int
) -> tuple[Problem, tuple[CoarseEncoder, ...], dict[str, float]]:
    """Return the problem with what noise and counts of encoders that drive move, coarse encoders, and input
    noise by signal.
    """
    allow_for_input_noise(problem, problem.arm)
    moved = input_noise_by_signal(problem)
    return *with_coarse_encoders(weighted_by_input_noise(problem), seed), moved


def with_coarse_encoders(problem: Problem, seed: int) -> tuple[Problem, tuple[CoarseEncoder, ...]]:
    """Return the same with noise that holds the errors of (1), and the encoders whose steps matter."""
    found: list[CoarseEncoder] = []
    variance = np.zeros(len(problem.rows))
    arm = problem.arm
    rng = np.random.default_rng(seed)
    for effect in coarse_encoders(arm, problem.records):
        there = arm.with_effect(effect)
        error = np.max([_error(problem, there, effect, rng) for _ in range(NOISE_MODEL.draws)], axis=0)
        most = int(np.argmax(error))
        if error[most] > NOISE_MODEL.reported:
            variance += (NOISE_MODEL.quantisation_factor * error) ** 2
            arm = there
            driven = [r for r in problem.records.values() if _moves_by(r, effect.at)]
            noise = min(record.signals[effect.at].noise_std or 0.0 for record in driven)
            moves = problem.rows[most].signal
            ((_, _, unit),) = parameters_in(effect, arm)
            found.append(CoarseEncoder(effect, unit, effect.step / noise, moves, float(error[most])))
    if not found:
        return problem, ()
    noisier = problem.with_noise(np.sqrt(1.0 + variance))
    noisier.arm = arm
    return noisier, tuple(found)


def _error(problem: Problem, arm: Arm, effect: EncoderQuantisation, rng: np.random.Generator) -> Floats:
    """Return the rms error (1) of each of `rows`, over its noise."""
    again = {
        name: _rounded_again(record, arm, effect, rng) if _moves_by(record, effect.at) else record
        for name, record in problem.records.items()
    }
    rounded = problem.along(SimulationCache(again, problem.step, problem.alpha))
    error = rounded.residual(arm) - problem.residual(arm)
    return np.array([float(np.sqrt(np.mean(error[each.where] ** 2))) for each in problem.rows])


def _moves_by(record: Record, encoder: str) -> bool:
    """Return True if a record is a motion along the readings of an encoder; poses and other motions are
    not.
    """
    return record.kind == "motion" and encoder in record.drive


def _rounded_again(record: Record, arm: Arm, effect: EncoderQuantisation, rng: np.random.Generator) -> Record:
    """Return a record whose encoder reads (1)."""
    signal = record.signals[effect.at]
    noise = float(effects_of(arm, signal).noise(signal.noise_std or 0.0)[0])
    u = effect.step * rng.uniform()
    values = quantised(smoothed(signal, noise) + u, effect.step) - u  # eq. (1)
    values[~np.isfinite(signal.values[:, 0])] = np.nan
    rounded = {**record.signals, effect.at: signal.replace(values=values[:, None])}
    return record.replace(signals=list(rounded.values()))
