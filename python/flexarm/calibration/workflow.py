"""The workflow of a calibration: clean, split, families, shared sizes, all parameters, verification."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from itertools import count
from math import exp
from typing import get_args

import numpy as np

from flexarm.arguments import NAMES, takes
from flexarm.arm import Arm
from flexarm.arm.parameter import path_of, with_value
from flexarm.budget import budgeted, current
from flexarm.calibration.estimation import Estimation, Posterior
from flexarm.calibration.families import Family, family_kinds, with_families
from flexarm.calibration.intervals import Marginal, marginals, own_prior
from flexarm.calibration.optimum import posterior_of
from flexarm.calibration.parameters import FreeParameter
from flexarm.calibration.policy import CalibrationPolicy
from flexarm.calibration.result import Calibration
from flexarm.calibration_estimates import (
    CalibratedFamily,
    CalibratedFrame,
    CalibratedParameter,
    ChiSquare,
    Kind,
    Range,
)
from flexarm.comparison.alignment_parameters import SEEN_IN_FRAMES
from flexarm.configuration import version
from flexarm.diagnosis.coarse_encoders import with_errors_of_drives
from flexarm.diagnosis.hold_out import Split, named_hold_out, split
from flexarm.diagnosis.noise_model import SEED, impute_noise, input_noise_remarks
from flexarm.diagnosis.nuisance import first_guess, nuisance_model
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.sensor_zeros import is_zero, with_zeros, without_idle_zeros
from flexarm.diagnosis.verification import SplitRecords, main_signal, rounded_to_std
from flexarm.errors import InvalidParameter
from flexarm.measurement.effects_of import effects_of
from flexarm.named_effects import NORMAL_90
from flexarm.record import Record
from flexarm.validation.sensor_check import clean_records, named_records
from flexarm.wording import listed

Progress = Callable[[float, str], object] | None


@takes(families=NAMES)
@budgeted
def calibrate(
    arm: Arm,
    records: Mapping[str, Record] | Sequence[Record],
    families: Sequence[str] = (),
    hold_out: Record | None = None,
    *,
    n_jobs: int | None = None,
    step: float = 2e-3,
    alpha: float = -0.05,
    policy: CalibrationPolicy | None = None,
    max_seconds: float | None = None,
    progress: Progress = None,
) -> Calibration:
    """Estimate all that is uncertain in a model, and families of effects, also where a gap stays.

    Parameters
    ----------
    arm : Arm
        The nominal model, with `[uncertainty]` where values are uncertain.
    records : dict of str to Record, or sequence of Record
        What is fitted, all together.
    families : sequence of str
        Effects, each at all places where it can act, such as "joint_compliance".
    hold_out : Record, optional
        Never used for fitting. Without one, blocks of time, or poses, are held back.
    n_jobs : int, optional
        Number of simulations at once; default one a core.
    step, alpha : float
        Of all simulations [s], [-].
    policy : CalibrationPolicy, optional
        Priors of families, and when an estimate is at rest.
    max_seconds : float, optional
        Wall-clock time after which no further step begins [s]; a remark tells then how far from rest the
        estimates are.
    progress : callable, optional
        Gets the share done and what is being done.

    Raises
    ------
    InvalidParameter
        If records and model do not fit each other, nothing is uncertain, or a family can act nowhere.
    NotConverged
        If the nominal model cannot be simulated.

    Examples
    --------
    >>> found = flexarm.calibrate(arm, [poses], families=["joint_compliance"])  # doctest: +SKIP
    >>> found.save("calibrated")  # doctest: +SKIP
    """
    begun = time.monotonic()
    tell = progress or (lambda done, what: None)
    family_kinds(families)
    given = named_records(records)
    held = named_hold_out(arm, hold_out, given)
    tell(0.0, "reading")
    clean = clean_records(arm, given, step=step, alpha=alpha)
    held, borrowed = impute_noise(clean.records, held)
    parted = split(arm, clean, clean_records(arm, held, step=step, alpha=alpha))
    workers = n_jobs or os.cpu_count() or 1
    uncertain = with_zeros(arm, parted.training, SelectionPolicy())
    problem = Problem(uncertain, parted.training, step=step, alpha=alpha, jobs=workers)
    problem, coarse, moved = with_errors_of_drives(problem, SEED)
    estimation = estimation_of(problem, families, policy or CalibrationPolicy())
    steps = count(1)  # each does a fifth of the rest, as how many follow is not known
    posterior = posterior_of(estimation, lambda what: tell(0.9 * (1 - 0.8 ** next(steps)), what))
    tell(0.9, "verifying")
    free, found = posterior.estimation.parameters, marginals(posterior)
    kinds = {k: kind for kind in get_args(Kind) for k, each in enumerate(free) if each.kind == kind}
    order = list(kinds)
    told = tuple(_parameter(posterior, k, kind, found[k]) for k, kind in kinds.items())
    model = _without_registrations(posterior.estimation.model(posterior.point.u), arm, posterior)
    updated = without_idle_zeros(_rounded(model, uncertain, told), arm)
    split_records = SplitRecords(parted.training, parted.held_out, step, alpha, workers)
    before = split_records.gaps(arm)
    after = split_records.gaps(updated, before)
    std = np.sqrt(np.diag(posterior.covariance))
    return Calibration(
        arm,
        updated,
        told,
        (posterior.covariance / np.outer(std, std))[np.ix_(order, order)],
        tuple(_family(posterior, family) for family in posterior.estimation.families),
        _frames(posterior),
        _chi_square(posterior),
        before,
        after,
        tuple(parted.training),
        tuple(parted.held_out),
        parted.kind,
        main_signal(parted.training, before),
        (
            *map(str, clean.outliers),
            *clean.remarks,
            *borrowed,
            *(encoder.evidence for encoder in coarse),
            *_remarks(posterior, parted),
            *input_noise_remarks(moved, problem),
            *current().remarks,
        ),
        {"version": version(), "step": step, "seconds": time.monotonic() - begun},
    )


def estimation_of(problem: Problem, families: Sequence[str], policy: CalibrationPolicy) -> Estimation:
    """Return the estimation of what is uncertain and of the families."""
    nuisance = nuisance_model(problem)
    arm, found = with_families(problem, nuisance.arm, families, policy)
    members = {member.key for family in found for member in family.members}
    free = [FreeParameter.of_nuisance(each) for each in nuisance.parameters if each.key not in members]
    if not found and not any(each.kind == "nominal" for each in free):
        raise InvalidParameter(
            "there is nothing to calibrate: give values an [uncertainty] in the model, or name a family "
            'such as "joint_compliance"',
            where="families",
        )
    everything = (*free, *(member for family in found for member in family.members))
    return Estimation(problem, arm, everything, tuple(found), policy)


def _without_registrations(model: Arm, nominal: Arm, posterior: Posterior) -> Arm:
    """Return a model whose clocks and frames are as the nominal one states them."""
    keys = (each.key for each in posterior.estimation.parameters if each.kind in ("clock", "frame"))
    for name, at in dict.fromkeys((key.split(".")[1], key.split(".")[2]) for key in keys):
        stated = nominal.effect(name, at)
        model = model.without_effect(name, at) if stated is None else model.with_effect(stated)
    return model


def _rounded(model: Arm, uncertain: Arm, told: Iterable[CalibratedParameter]) -> Arm:
    """Return the model with rounded values; zeros of sensors that no data move are as they were."""
    for each in told:
        value = rounded_to_std(each.value, each.std)
        if each.kind == "nominal" and is_zero(each.name):
            nominal = path_of(uncertain, each.name).get(uncertain)
            value = nominal if abs(each.value - nominal) < each.std else value
        if each.kind in ("family", "nominal"):
            with suppress(InvalidParameter):  # so near a limit that it stays as it is
                model = with_value(model, each.name, value)
    return model


def _parameter(posterior: Posterior, k: int, kind: Kind, found: Marginal) -> CalibratedParameter:
    estimation = posterior.estimation
    free, u = estimation.parameters[k], float(posterior.point.u[k])
    prior = float(np.sqrt(np.linalg.inv(estimation.precision())[k, k]))
    family = next((each for each in estimation.families if k in estimation.columns(each)), None)
    _, tau = own_prior(posterior, k)
    low, high = found.quantile(0.05), found.quantile(0.95)
    guess, sigma = first_guess(free.key, estimation.problem), (high - low) / (2 * NORMAL_90)
    return CalibratedParameter(
        free.key,
        kind,
        free.value(u) + guess,
        sigma * free.slope(u),
        free.value(low) + guess,
        free.value(high) + guess,
        free.unit,
        _range(free, float(estimation.centre[k]), prior, guess),
        float(np.clip(1.0 - (sigma / tau) ** 2, 0.0, 1.0)),
        "" if family is None else family.effect,
        found.one_sided,
    )


def _range(free: FreeParameter, u: float, sigma: float, guess: float) -> Range:
    """Return the 90 % interval of a prior about a first guess."""
    middle, low, high = (guess + free.value(u + sign * NORMAL_90 * sigma) for sign in (0, -1, 1))
    return Range(middle, low, high)


def _family(posterior: Posterior, family: Family) -> CalibratedFamily:
    """Return the shared size of the members, with its uncertainty given theirs."""
    hierarchy, shared = family.hierarchy, None
    if hierarchy.has_mean:
        columns = posterior.estimation.columns(family)
        u = posterior.point.u[columns]
        mu, n = hierarchy.shared_value(u), len(u)
        weight = n / hierarchy.spread**2 + 1 / hierarchy.hyperprior[1] ** 2
        mean = np.full(n, 1 / hierarchy.spread**2 / weight)
        sigma = float(np.sqrt(1 / weight + mean @ posterior.covariance[np.ix_(columns, columns)] @ mean))
        shared = Range(exp(mu), exp(mu - NORMAL_90 * sigma), exp(mu + NORMAL_90 * sigma))
    return CalibratedFamily(
        family.effect, family.parameter, hierarchy.prior.unit, family.places, shared, hierarchy.spread
    )


def _frames(posterior: Posterior) -> tuple[CalibratedFrame, ...]:
    """Return the poses of the frames: those of the records, corrected by the registration that was found."""
    problem, model = posterior.estimation.problem, posterior.estimation.model(posterior.point.u)
    found: dict[str, CalibratedFrame] = {}
    for each in problem.rows:
        record = problem.records[each.record]
        signal = record.signals[each.signal]
        if signal.frame in record.frames and signal.quantity in SEEN_IN_FRAMES:
            frame = effects_of(model, signal).registration(problem.placement[each.record].frame(signal))
            xyz, rpy = frame.pose
            found.setdefault(signal.frame, CalibratedFrame(signal.frame, tuple(xyz), tuple(rpy)))
    return tuple(found.values())


def _chi_square(posterior: Posterior) -> ChiSquare:
    point, problem = posterior.point, posterior.estimation.problem
    white = posterior.weighting.root(point.jacobian)
    effective = float(np.sum(posterior.inverse * (white.T @ white)))
    inflation: dict[str, list[float]] = {}
    for (each, _), size in zip(problem.channels(), posterior.inflation, strict=True):
        inflation.setdefault(each.signal, []).append(float(size))
    return ChiSquare(
        float(point.residual @ point.residual),
        len(point.residual),
        effective,
        {signal: float(np.mean(values)) for signal, values in inflation.items()},
    )


def _remarks(posterior: Posterior, parted: Split) -> list[str]:
    found, policy = [*parted.remarks], posterior.estimation.policy
    if not posterior.at_rest:
        k = int(np.argmax(np.abs(posterior.last_move)))
        found.append(
            f"the estimates are not at rest after {posterior.iterations} steps: the last one moves "
            f"{posterior.estimation.parameters[k].key} by {abs(posterior.last_move[k]):.2g} sigma"
        )
    if left := [name for name, size in _chi_square(posterior).inflation.items() if size > policy.inflated]:
        found.append(
            f"a gap stays in {listed(left)}: intervals are widened by it, and hold if what is left is "
            "not like what the parameters do"
        )
    return found
