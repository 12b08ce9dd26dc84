"""The floor: how small a gap could be, and whether the simulation is good enough to be compared.

Per signal: the noise that its record states, the noise that its own samples show (`residuals.noise`),
and what the simulation is wrong by, as the rms change of the predicted signal, all channels together, when

    step     is halved: the method is of order two, so this is 3/4 of the error                      (1)
    mesh     of every beam is twice as fine: of order four, 15/16 of the error                       (2)
    alpha    is 0, without numerical damping, instead of its default                                 (3)

Each should be below the noise. (1) is found for every record, the others for that with the liveliest drive,
or for all. A gap is
correlated from sample to sample unless it is white noise; the number of independent samples in it is what an
information criterion may count.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.beside import Beside, beside
from flexarm.comparison.step_check import change
from flexarm.diagnosis.gap.floor_table import Floor, SignalFloor
from flexarm.diagnosis.residuals.noise import drive_noise, effective_samples, estimated_noise
from flexarm.errors import InvalidParameter, NotConverged

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Signal


def floor(
    pairs: Mapping[str, Beside] | Beside, *, thorough: bool = False, step: float = 2e-3, alpha: float = -0.05
) -> Floor:
    """How small a gap could be: noise of every record, and error of the simulation.

    Takes a simulation of twice the work for each motion, and two more of the liveliest; of poses one.

    Parameters
    ----------
    pairs : dict of str to Beside, or Beside
        Records by name, each beside its simulation, as for `locate`.
    thorough : bool
        Find (2) and (3) of every record, not only of the one with the liveliest drive.
    step, alpha : float
        Of the simulations in `pairs` [s], [-].

    Raises
    ------
    InvalidParameter
        If there is no record.
    """
    found = {"record": pairs} if isinstance(pairs, Beside) else dict(pairs)
    if not found:
        raise InvalidParameter("needs at least one record beside its simulation, got none", where="pairs")
    liveliest = max(found, key=lambda name: _liveliness(found[name]))
    signals: list[SignalFloor] = []
    for name, pair in found.items():
        whole = thorough or name == liveliest
        signals += _of_record(name, pair, _variants(pair, step, alpha, whole))
    return Floor(tuple(signals), step)


def refined(arm: Arm) -> Arm:
    """The arm with twice as many elements in every beam."""
    links = [link.replace(elements=2 * link.elements) if link.type == "beam" else link for link in arm.links]
    return arm.replace(links=tuple(links))


def _liveliness(pair: Beside) -> float:
    """Greatest rms rate of a drive [rad/s]; of poses their number."""
    if pair.record.kind == "static":
        return float(len(pair.record.poses))
    rates = np.asarray(pair.subject.simulation.drive_rate)
    return float(np.sqrt(np.mean(rates**2, axis=0)).max(initial=0.0))


def _of_record(name: str, pair: Beside, others: Mapping[str, Beside | None]) -> list[SignalFloor]:
    """Floors of the signals of one record, with the same record beside other simulations."""
    found = []
    for signal in pair.subject.signals.values():
        is_drive = signal.name in pair.record.drive
        errors = (
            {}
            if is_drive
            else {kind: inf if b is None else change(pair, b, signal) for kind, b in others.items()}
        )
        residual = pair.subject.residual(signal, pair.aligned.placement)
        rows = residual[np.isfinite(residual).all(axis=1)]
        noise = pair.subject.noise(signal)
        found.append(
            SignalFloor(
                name,
                signal.name,
                "rad" if signal.quantity == "orientation" else signal.unit,
                residual.shape[1],
                float(np.sqrt(np.mean(noise**2))) if signal.noise_std is not None else None,
                _estimated(pair, signal, residual, is_drive),
                errors,
                len(rows),
                effective_samples(rows),
                is_drive,
            )
        )
    return found


def _estimated(pair: Beside, signal: Signal, residual: Floats, is_drive: bool) -> float | None:
    """Noise from the samples: of a drive's own, else of the gap."""
    if is_drive and pair.record.kind == "motion":
        return drive_noise(signal.values[:, 0])
    return estimated_noise(pair, signal, residual)


def _variants(pair: Beside, step: float, alpha: float, whole: bool) -> dict[str, Beside | None]:
    """The record beside other simulations, (1) or all; None where one comes to no end."""
    arm, record = pair.subject.arm, replace(pair.record, links={})  # the arm is drawn out already
    wanted: dict[str, tuple[Arm, float, float]] = {}
    if whole and any(link.type == "beam" for link in arm.links):
        wanted["mesh"] = (refined(arm), step, alpha)  # eq. (2)
    if record.kind == "motion":
        wanted["step"] = (arm, step / 2, alpha)  # eq. (1)
    if whole and record.kind == "motion":
        wanted["alpha"] = (arm, step, 0.0 if alpha else -0.05)  # eq. (3)
    found: dict[str, Beside | None] = {}
    for kind, (model, length, damping) in sorted(wanted.items(), reverse=True):
        try:
            found[kind] = beside(model, record, align=False, step=length, alpha=damping)
        except NotConverged:
            found[kind] = None
    return found
