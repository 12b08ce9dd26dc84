"""Rows of a residual, the values of a record that are evidence over their noise, and their derivatives.

    r_i = (y_i - f_i)/sigma                                                                            (1)

A channel of a signal gives a row for every finite value y while all drives are known. sigma is the stated
noise or, where a motion states none, a robust estimate from second differences, which a smooth motion hardly
has: the variance of r_(i-1) - 2 r_i + r_(i+1) is six times that of white r,

    sigma = median |r_(i-1) - 2 r_i + r_(i+1)| / (0.6745 sqrt 6).                                      (2)

The noise of poses is the scatter of rows of one pose; without such rows it has to be stated.

Derivatives with respect to parameters of the model are computed in the cheapest way that is exact. Those of
poses follow from the derivatives of equilibria, one run for all parameters. A point of which only positions
are measured moves in its link with the link's section,

    dp/do = R,                                                                                         (3)

without another run. All others are differences of runs. Predictions of non-smooth laws have ripples, so that
small steps tell little of large ones.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm.arm import Arm
from flexarm.arm.parameter import neighbours, parameters
from flexarm.arrays import Floats
from flexarm.comparison.poses import pose_numbers, solve_poses
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.diagnosis.policy import FIT, NOISE_MODEL
from flexarm.errors import InvalidParameter
from flexarm.measurement.slopes import predict_slopes
from flexarm.record import Signal
from flexarm.residual_analysis.noise_floor import repeated_noise

if TYPE_CHECKING:
    from flexarm.diagnosis.problem import Problem


def is_non_smooth(arm: Arm) -> bool:
    """Return True if a model has a non-smooth law."""
    return not all(effect.smooth for effect in arm.effects)


@dataclass(frozen=True, eq=False)
class Rows:
    """The rows of (1) that belong to one channel of one signal of one record."""

    record: str
    signal: str
    """Names."""
    channel: int
    """Number of the channel in the signal."""
    where: slice
    """In the vector."""
    mask: NDArray[np.bool_]
    """True at rows of the signal that are in the vector, shape (n,)."""
    sigma: float
    """1 sigma of the noise [SI]."""
    time: Floats
    """Instants of the rows by the drive's clock [s], or numbers of poses."""
    input_noise: float = 0.0
    """Mean square, over sigma^2, of input noise (`noise_model`)."""
    discretisation_error: float = 0.0
    """The same of the discretisation error of non-smooth models (`noise_model`)."""

    def explained_square(self, non_smooth: bool) -> float:
        """Return the mean square, over sigma^2, of input noise, and of discretisation error of non-smooth
        models.
        """
        return self.input_noise + (self.discretisation_error if non_smooth else 0.0)


def evidence_rows(name: str, pair: SimulatedRecord, placement: Placement, start: int) -> Iterator[Rows]:
    """Yield the rows of all channels of a record, the same for any simulation, from row `start` on.

    Raise InvalidParameter if the noise of poses is neither stated nor shown.
    """
    poses = pair.record.kind == "static"
    drives = [pair.record.signals[drive] for drive in pair.record.drive]
    last = np.inf if poses else min((float(drive.time[-1]) for drive in drives), default=np.inf)
    for signal in pair.evidence.values():
        residual, noise = pair.residual(signal, placement, hold=True), pair.noise(signal)
        if poses and not noise.all():
            noise = np.where(noise > 0, noise, noise_of_poses(name, signal, residual))
        instants = pair.instants(signal, placement)
        for channel in range(residual.shape[1]):
            kept = np.isfinite(residual[:, channel]) & (instants <= last + 1e-9)
            sigma = float(noise[channel]) or shown_noise(residual[kept, channel])
            if kept.any() and sigma > 0:
                where = slice(start, start + int(kept.sum()))
                yield Rows(name, signal.name, channel, where, kept, sigma, instants[kept])
                start = where.stop


def rows_left(rows: Iterable[Rows], out: NDArray[np.bool_]) -> Iterator[Rows]:
    """Rows without those of a mask over all of them, in a residual that is shorter by these."""
    start = 0
    for each in rows:
        left = ~out[each.where]
        kept = each.mask.copy()
        kept[np.flatnonzero(kept)] = left
        stop = start + int(left.sum())
        if stop > start:
            yield replace(each, where=slice(start, stop), mask=kept, time=each.time[left])
        start = stop


def greatest_by_signal(rows: Iterable[Rows], size: Callable[[Rows], float]) -> dict[str, float]:
    """Return the greatest size of the channels of each signal, in all records, at least 0."""
    found: dict[str, float] = {}
    for each in rows:
        found[each.signal] = max(found.get(each.signal, 0.0), size(each))
    return found


def noise_of_poses(name: str, signal: Signal, residual: Floats) -> float:
    """1 sigma of each channel of a signal of a record, from rows of one pose.

    Raise InvalidParameter if these are too few, or all alike.
    """
    known = np.isfinite(residual).all(axis=1)
    pose = np.asarray(signal.pose)[known]
    repeats = len(pose) - len(np.unique(pose))
    sigma = repeated_noise(pose, residual[known]) if repeats >= NOISE_MODEL.repeats else None
    if sigma is None or sigma < NOISE_MODEL.rounding * np.nanmax(np.abs(signal.values)):
        raise InvalidParameter(
            f"state noise_std above zero; of poses only rows that repeat one would show it, needed are "
            f"{NOISE_MODEL.repeats} that are not all alike, got {repeats}",
            where=f"records.{name}.signals.{signal.name}",
        )
    return sigma


def shown_noise(residual: Floats) -> float:
    """Eq. (2); zero of too few values."""
    if len(residual) < 8:
        return 0.0
    return float(1.4826 * np.median(np.abs(np.diff(residual, 2))) / np.sqrt(6.0))  # eq. (2)


def write_over_noise(found: Floats, rows: Iterable[Rows], values: Callable[[str], Floats]) -> None:
    """Write eq. (1) into some rows of a residual, or derivatives of it, from the values of each signal."""
    by_signal: dict[str, Floats] = {}
    for each in rows:
        if each.signal not in by_signal:
            by_signal[each.signal] = values(each.signal)
        found[each.where] = by_signal[each.signal][each.mask, each.channel] / each.sigma  # eq. (1)


def differences(
    problem: Problem, arm: Arm, keys: Sequence[str], steps: Mapping[str, float] = MappingProxyType({})
) -> Floats:
    """From runs with each parameter a little larger and smaller, of points from (3); shape (n, len(keys)).

    `steps` are those of some parameters, if not small.
    """
    found = np.zeros((len(problem), len(keys)))
    wanted = parameters(arm, list(keys))
    seen = {p.key for p in wanted if _only_seen(problem, p.key)}
    pairs = {
        p.key: neighbours(arm, p, steps.get(p.key), FIT.relative_step) for p in wanted if p.key not in seen
    }
    problem.prepare(model for pair in pairs.values() for model, _ in pair)
    for k, key in enumerate(p.key for p in wanted):
        if key in seen:
            found[:, k] = _point_slope(problem, arm, key)
        else:
            (above, up), (below, down) = pairs[key]
            found[:, k] = (problem.residual(above) - problem.residual(below)) / (up - down)
    return found


def static_jacobian(problem: Problem, arm: Arm, keys: Sequence[str]) -> Floats | None:
    """From the derivatives of equilibria, shape (n, len(keys)).

    None where records are motions, orientations are measured, or a law has no derivative.
    """
    records = problem.records
    signals = {(each.record, each.signal) for each in problem.rows}
    if any(
        records[record].kind != "static" or records[record].signals[signal].quantity == "orientation"
        for record, signal in signals
    ):
        return None
    found = np.empty((len(problem), len(keys)))
    try:
        for name in records:
            _write_pose_slopes(found, problem, arm, name, list(keys))
    except InvalidParameter:
        return None
    return found


def _write_pose_slopes(found: Floats, problem: Problem, arm: Arm, name: str, keys: list[str]) -> None:
    record, placement = problem.records[name], problem.placement[name]
    carried = record.applied_to(arm)
    effects = (key.split(".")[1:3] for key in keys if key.startswith("effects."))
    if any(arm.effect(*place) != carried.effect(*place) for place in effects):
        raise InvalidParameter("is what the record states", where="sensitivities")
    run = solve_poses(carried, record, sensitivities=keys)
    stamps = pose_numbers(record)

    def of_signal(name: str) -> Floats:
        signal = record.signals[name]
        frame = placement.frame(signal)
        return -predict_slopes(run, signal, registration=frame, stamps=stamps[name])

    write_over_noise(found, problem.rows_of(name), of_signal)


def _only_seen(problem: Problem, key: str) -> bool:
    """Return True if a parameter is the place of a point of which only positions are measured."""
    table, name, *_ = key.split(".")
    if table != "points":
        return False
    records = problem.records.values()
    signals = [s for record in records for s in record.signals.values() if s.point == name]
    return all(signal.quantity == "position" for signal in signals)


def _point_slope(problem: Problem, arm: Arm, key: str) -> Floats:
    """Return the derivative with respect to the place of a point in its link."""
    from scipy.spatial.transform import Rotation

    _, point, _, axis = key.split(".")
    found = np.zeros(len(problem))
    for name, record in problem.records.items():
        pair = problem.simulations.run(name, arm, rotations=True)
        rows = [row for row in problem.rows_of(name) if record.signals[row.signal].point == point]
        run = pair.simulation
        i = run.points.index(point)
        move = np.zeros_like(run.position)
        sections = Rotation.from_quat(run.orientation[:, i]).as_matrix()
        move[:, i] = sections[:, :, "xyz".index(axis)]  # eq. (3)
        shifted = replace(run, position=run.position + FIT.point_step * move)
        after = problem.residual(arm).copy()
        problem.write_residual(after, name, replace(pair, simulation=shifted), rows)
        found += (after - problem.residual(arm)) / FIT.point_step  # positions are linear in the shift
    return found
