"""Noise beyond what records state: noise of other records, input noise and discretisation error.

**Imputed noise.** A held-out record that states no noise of a signal takes the largest that the training
states of it. Without noise a signal aligns no clock and no frame.

**Input noise.** The angle that drives a simulation is smoothed (`flexarm.measurement.smoothing`). A part of
its noise remains and moves all that the drive moves, lightly damped modes most. With f the smoothed drive,

    y'_i = step round((f(t_i) + n_i + u)/step) - u,    u uniform within a step                         (1)

smoothed anew, is about as far from f as f is from the truth. step is that of the grid of the readings
(`flexarm.record.quantisation_grid`), n_i is white, and both together are as large as the record states;
without a grid, or with one that this noise does not cover, y' = f + n. Counts are no white noise: while a
joint hardly moves all readings err alike. Where most readings repeat one u errs up to ten times as much
as another, and the greatest of the draws counts, `quantisation_factor` times. Angles of poses are not
smoothed; f is their reading. The difference of the simulations along both is an error of each channel.

**Discretisation error.** Richardson extrapolation (`Problem.correction`) assumes second order. Motions with
impacts have no order: after some of them the motions of two time steps diverge. With r(h) the residual and

    E(h) = r(h/2) + (r(h/2) - r(h))/3,                                                                (2)

E(h/2) - E(h) is an error of each channel.

The mean squares of both errors count as noise in the evidence (`diagnosis.evidence`), not as a gap. What
input noise does to estimates follows from the errors themselves (`diagnosis.uncertainty`).

**Time step.** Fits correct the residuals of all models by the discretisation error of one (`estimator`). That
holds while the error is small: a lightly damped mode whose period is p wrong has another phase after 1 / p
periods, and another model another error. The step is halved while in some channel

    mean (r(h/2) - r(h))^2 > SelectionPolicy.model_errors                                            (3)

and a halving reduces the left side as a method of order two does.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from itertools import count, islice
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.comparison.alignment_parameters import uncertain_clock_and_frame
from flexarm.diagnosis.fit import FIT_ERRORS
from flexarm.diagnosis.policy import NOISE_MODEL
from flexarm.diagnosis.problem import Problem, extrapolated
from flexarm.diagnosis.residual_rows import greatest_by_signal, is_non_smooth
from flexarm.diagnosis.simulation_cache import SimulationCache, effects_on_drives
from flexarm.measurement.effects_of import effects_of
from flexarm.measurement.encoder import quantised
from flexarm.measurement.smoothing import smooth
from flexarm.record import Record
from flexarm.record.quantisation_grid import quantisation_step
from flexarm.wording import listed, times_noise, with_unit

if TYPE_CHECKING:
    from flexarm.record import Signal


def impute_noise(
    training: Mapping[str, Record], held_out: Mapping[str, Record]
) -> tuple[dict[str, Record], list[str]]:
    """Return the held-out records with the noise of the training, and remarks.

    Remarks also name clocks and frames that a signal without noise does not align.
    """
    found, said = dict(held_out), []
    for name, record in held_out.items():
        signals = dict(record.signals)
        for signal in record.signals.values():
            if signal.noise_std is None:
                named = (
                    each.signals[signal.name] for each in training.values() if signal.name in each.signals
                )
                same = [each for each in named if each.quantity == signal.quantity]
                noise = max((each.noise_std for each in same if each.noise_std is not None), default=None)
                signals[signal.name] = signal.replace(noise_std=noise)
                said += _sentences(name, record, signal, noise) if noise is not None or not same else []
        found[name] = record.replace(signals=signals)
    return found, said


def _sentences(name: str, record: Record, signal: Signal, noise: float | None) -> list[str]:
    begin = f"{name} states no noise of {signal.name}"
    if noise is not None:
        return [f"{begin}: {with_unit(noise, signal.unit, 2)} count, as the training states it"]
    places = uncertain_clock_and_frame(record, signal)
    return [f"{begin}, nor does the training: it does not align {listed(places)}"] if places else []


SEED = 0
"""Seed of n: the same for all models, so that they are compared alike."""


def allow_for_input_noise(problem: Problem, arm: Arm) -> None:
    """Add the input noise (1) of a model to `rows`, where it exceeds what was known."""
    squares: list[list[float]] = []
    with suppress(*FIT_ERRORS):
        for error in islice(_input_errors(problem, arm), NOISE_MODEL.draws):
            squares.append([float(np.mean(error[each.where] ** 2)) for each in problem.rows])
            if max(squares[0], default=0.0) < NOISE_MODEL.negligible**2:
                return
        if squares:
            square = np.mean(squares, axis=0)
            if any(_shows_counts(signal) for signal in _driving_encoders(problem.records)):
                square = NOISE_MODEL.quantisation_factor**2 * np.max(squares, axis=0)
            rows = zip(problem.rows, square.tolist(), strict=True)
            problem.rows = tuple(replace(each, input_noise=max(each.input_noise, s)) for each, s in rows)


def _driving_encoders(records: Mapping[str, Record]) -> Iterator[Signal]:
    """Yield the angles that drive motions."""
    for record in records.values():
        for name in record.drive if record.kind == "motion" else ():
            if record.signals[name].quantity == "joint_angle":
                yield record.signals[name]


def _shows_counts(signal: Signal) -> bool:
    """Return True for counts of which the stated noise is the rounding: most readings repeat."""
    values = signal.values[signal.valid, 0]
    counted = 0 < quantisation_step(values) <= NOISE_MODEL.coarse_count * (signal.noise_std or 0.0)
    return counted and bool(np.median(np.abs(np.diff(values))) == 0)


def input_noise_by_signal(problem: Problem) -> dict[str, float]:
    """Return input noise over the own noise of each signal, where it exceeds `NOISE_MODEL.reported`."""
    most = greatest_by_signal(problem.rows, lambda rows: sqrt(rows.input_noise))
    return {signal: size for signal, size in most.items() if size > NOISE_MODEL.reported}


def input_noise_remarks(sizes: Mapping[str, float], problem: Problem) -> list[str]:
    """Return a remark on input noise, if there is any."""
    if not sizes:
        return []
    drives = dict.fromkeys(name for record in problem.records.values() for name in record.drive)
    return [f"noise of {listed(list(drives))}, as stated, moves {times_noise(sizes)}, which is no gap"]


def weighted_by_input_noise(problem: Problem) -> Problem:
    """Return the problem with input noise above `NOISE_MODEL.dominant` as noise of its rows.

    On a stiff arm a torque sensor reads mostly input noise where moves begin and end, and by its own noise it
    would outweigh all other signals.
    """
    times = [
        sqrt(1.0 + each.input_noise) if each.input_noise > NOISE_MODEL.dominant**2 else 1.0
        for each in problem.rows
    ]
    if max(times, default=1.0) == 1.0:
        return problem
    found = problem.with_noise(np.array(times))
    rows = zip(found.rows, times, strict=True)
    found.rows = tuple(each if t == 1.0 else replace(each, input_noise=0.0) for each, t in rows)
    return found


def input_noise_errors(problem: Problem, arm: Arm) -> Floats:
    """Return residual errors for draws of (1), over the noise, shape (draws, n); (0, n) if there are none."""
    found = np.empty((0, len(problem)))
    with suppress(*FIT_ERRORS):
        for error in islice(_input_errors(problem, arm), NOISE_MODEL.error_draws):
            found = np.vstack([found, error])
    return found


def _input_errors(problem: Problem, arm: Arm) -> Iterator[Floats]:
    """Yield the residual error for each draw of (1), over the noise, shape (n,); none without noise.

    The draws are those of all models with the same effects on what drives, which are smoothed once.
    """
    effects = tuple(effects_on_drives(record, arm) for record in problem.records.values())
    rng, drawn = problem.draws.setdefault(effects, (np.random.default_rng(SEED), []))
    for k in count():
        if k == len(drawn):
            again = {name: _noisy_again(record, arm, rng) for name, record in problem.records.items()}
            if all(again[name] is record for name, record in problem.records.items()):
                return
            drawn.append(SimulationCache(again, problem.step, problem.alpha))
        noisy = problem.along(drawn[k].with_step(problem.step))
        yield np.asarray(noisy.residual(arm) - problem.residual(arm))


def _noisy_again(record: Record, arm: Arm, rng: np.random.Generator) -> Record:
    """Return a record whose encoders that drive read (1)."""
    noisy = {
        name: record.signals[name].replace(values=input_noise_reading(record, name, arm, rng))
        for name in record.drive
        if record.signals[name].quantity == "joint_angle" and record.signals[name].noise_std
    }
    return record.replace(signals=list({**record.signals, **noisy}.values())) if noisy else record


def input_noise_reading(record: Record, name: str, arm: Arm, rng: np.random.Generator) -> Floats:
    """Return y' of (1), shape (n, 1)."""
    signal = record.signals[name]
    noise = float(effects_of(arm, signal).noise(signal.noise_std or 0.0)[0])
    values = smoothed(signal, noise) if record.kind == "motion" else signal.values[:, 0]
    step = quantisation_step(signal.values[:, 0])
    counted = step <= NOISE_MODEL.coarse_count * noise
    white = sqrt(max(noise**2 - step**2 / 12, 0.0)) if counted else noise
    values = values + white * rng.standard_normal(len(signal))
    if counted and step > 0:
        u = step * rng.spawn(1)[0].uniform()
        values = quantised(values + u, step) - u  # eq. (1)
    values[~np.isfinite(signal.values[:, 0])] = np.nan
    return np.asarray(values[:, None])


def smoothed(signal: Signal, noise: float) -> Floats:
    """Return the angle that drives a simulation at the stamps of its encoder, shape (n,)."""
    from scipy.interpolate import PPoly

    breaks, coefficients = smooth(signal.time, signal.values[:, 0], noise)
    return np.asarray(PPoly(coefficients, breaks)(signal.time))


def allow_for_discretisation_error(problem: Problem, arm: Arm) -> None:
    """Count the error of (2) in each of `rows` for a non-smooth model, where it is more than was known."""
    if not is_non_smooth(arm):
        return
    with suppress(*FIT_ERRORS):
        coarse, half, quarter = (problem.with_step(problem.step / times).residual(arm) for times in (1, 2, 4))
        error = extrapolated(half, quarter) - extrapolated(coarse, half)  # eq. (2)
        square = [float(np.mean(error[each.where] ** 2)) for each in problem.rows]
        if max(square) < NOISE_MODEL.negligible**2:
            return
        rows = zip(problem.rows, square, strict=True)
        problem.rows = tuple(
            replace(each, discretisation_error=max(each.discretisation_error, s)) for each, s in rows
        )


def discretisation_remarks(problem: Problem) -> list[str]:
    """Return a remark on signals for which no step is fine enough, if there are any."""
    most = greatest_by_signal(problem.rows, lambda rows: sqrt(rows.discretisation_error))
    sizes = {signal: size for signal, size in most.items() if size > NOISE_MODEL.negligible}
    said = "no time step is fine enough for what bounces: half of it moves"
    return [f"{said} {times_noise(sizes)}, which is no gap"] if sizes else []


def with_fine_step(problem: Problem, arm: Arm) -> Problem:
    """Return the problem with its step, or with half or a quarter of it where (3) asks for that."""
    if is_non_smooth(arm) or all(record.kind == "static" for record in problem.records.values()):
        return problem
    with suppress(*FIT_ERRORS):
        moved = _moved(problem, arm)
        for _ in range(NOISE_MODEL.halvings):
            if not np.any(moved > problem.policy.model_errors):  # eq. (3)
                break
            finer = problem.with_step(problem.step / 2)
            then = _moved(finer, arm)
            if then.max() * NOISE_MODEL.second_order > moved.max():
                break
            problem, moved = finer, then
    return problem


def _moved(problem: Problem, arm: Arm) -> Floats:
    """Left side of (3) by channel."""
    change = problem.with_step(problem.step / 2).residual(arm) - problem.residual(arm)
    return np.array([float(np.mean(change[where] ** 2)) for _, where in problem.channels()])


def step_remarks(stated: float, taken: float) -> list[str]:
    """Return a remark on a step that is not the stated one."""
    if taken == stated:
        return []
    return [
        f"simulated in steps of {1e3 * taken:.3g} ms: those of {1e3 * stated:.3g} ms miss more than the noise"
    ]
