"""Encoders that count in steps their records do not tell of, and what those steps do to everything else.

Readings of such an encoder lie on a quantisation grid (`flexarm.record.quantisation_grid`), seen in them
No fit can take the steps back: what the drive did between two
counts is lost, and moves everything it drives. How much follows from rounding once more: with f the smoothed
drive,

    y'_i = step round((f(t_i) + u)/step) - u,    u uniform within a step                              (1)

is about as far from f as f is from the truth, and the difference of the simulations along both is an error of
each channel, added to its noise. How quickly f follows a count that comes or stays away is chance, and near a
mode one u errs up to ten times as much as another one: the largest error of `DRAWS` of them counts,
`ROUGHLY` times.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.diagnosis.noise_model import DRAWS, SAID, smoothed
from flexarm.diagnosis.problem import Problem
from flexarm.effects.encoder_quantisation import EncoderQuantisation
from flexarm.measurement.effects_of import effects_of
from flexarm.named_effects import Estimate, NamedEffect
from flexarm.record import Record
from flexarm.record.quantisation_grid import quantisation_step

COARSE = 5.0
"""Steps over the stated noise from which a record does not tell of them."""
ROUGHLY = 2.0
"""How well the error of one motion tells that of another."""


@dataclass(frozen=True)
class CoarseEncoder:
    """An encoder, its step and what that does.

    Attributes
    ----------
    effect : EncoderQuantisation
        With the step that was seen.
    over_noise : float
        The step over the stated noise of the encoder.
    moves : str
        The signal that it disturbs most.
    error : float
        There, rms over the noise.
    """

    effect: EncoderQuantisation
    over_noise: float
    moves: str
    error: float

    def named(self, probability: float) -> NamedEffect:
        """As a diagnosis says it: steps are seen in the readings themselves."""
        step = self.effect.step
        exact = Estimate("step", step, 1e-4 * step, (1 - 2e-4) * step, (1 + 2e-4) * step, "rad")
        evidence = (
            f"all readings of {self.effect.at} are {1e3 * step:.4g} mrad apart or multiples of it, "
            f"{self.over_noise:.0f} times the stated noise; what the arm did between two counts is lost, and "
            f"moves {self.moves} by {self.error:.1f} times its noise"
        )
        return NamedEffect(EncoderQuantisation.name, self.effect.at, probability, (exact,), (), evidence)


def coarse_encoders(arm: Arm, records: Mapping[str, Record]) -> tuple[EncoderQuantisation, ...]:
    """Of joint angles that drive, where neither the records nor the model state the steps."""
    steps: dict[str, list[float]] = {}
    for record in records.values():
        for name in record.drive if record.kind == "motion" else ():
            signal = record.signals[name]
            if signal.quantity == "joint_angle" and arm.effect(EncoderQuantisation.name, name) is None:
                step = quantisation_step(signal.values[:, 0])
                told = step <= COARSE * (signal.noise_std or np.inf)
                steps.setdefault(name, []).append(0.0 if told else step)
    return tuple(
        EncoderQuantisation(at=name, step=float(np.median(found)))
        for name, found in steps.items()
        if min(found) > 0 and max(found) < 1.01 * min(found)
    )


def with_coarse_encoders(problem: Problem, seed: int) -> tuple[Problem, tuple[CoarseEncoder, ...]]:
    """Return the same with noise that holds the errors of (1), and the encoders whose steps matter."""
    found: list[CoarseEncoder] = []
    variance = np.zeros(len(problem.rows))
    arm = problem.arm
    rng = np.random.default_rng(seed)
    for effect in coarse_encoders(arm, problem.records):
        there = arm.with_effect(effect)
        error = np.max([_error(problem, there, effect, rng) for _ in range(DRAWS)], axis=0)
        most = int(np.argmax(error))
        if error[most] > SAID:
            variance += (ROUGHLY * error) ** 2
            arm = there
            driven = [r for r in problem.records.values() if _moves_by(r, effect.at)]
            noise = min(record.signals[effect.at].noise_std or 0.0 for record in driven)
            moves = problem.rows[most].signal
            found.append(CoarseEncoder(effect, effect.step / noise, moves, float(error[most])))
    if not found:
        return problem, ()
    noisier = problem.with_noise(np.sqrt(1.0 + variance))
    noisier.arm = arm
    return noisier, tuple(found)


def _error(problem: Problem, arm: Arm, effect: EncoderQuantisation, rng: np.random.Generator) -> Floats:
    """Return what (1) does to each of `rows`, rms over its noise."""
    again = {
        name: _rounded_again(record, arm, effect, rng) if _moves_by(record, effect.at) else record
        for name, record in problem.records.items()
    }
    return _rms(problem, problem.with_drives(again).residual(arm) - problem.residual(arm))


def _moves_by(record: Record, encoder: str) -> bool:
    """Return True if a record is a motion along the readings of an encoder; poses and other motions are
    not.
    """
    return record.kind == "motion" and encoder in record.drive


def _rounded_again(record: Record, arm: Arm, effect: EncoderQuantisation, rng: np.random.Generator) -> Record:
    """Return a record whose encoder reads (1)."""
    signal = record.signals[effect.at]
    noise = float(effects_of(arm, signal).noise(signal.noise_std or 0.0)[0])
    f = smoothed(signal, noise)
    u = effect.step * rng.uniform()
    values = effect.step * np.round((f + u) / effect.step) - u  # eq. (1)
    values[~np.isfinite(signal.values[:, 0])] = np.nan
    rounded = {**record.signals, effect.at: signal.replace(values=values[:, None])}
    return record.replace(signals=list(rounded.values()))


def _rms(problem: Problem, residual: Floats) -> Floats:
    return np.array([float(np.sqrt(np.mean(residual[each.where] ** 2))) for each in problem.rows])
