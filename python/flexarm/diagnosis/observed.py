"""What was measured, beside what a model predicts of it: one vector of residuals over their noise.

    r(model) = (y - f(model)) / sigma                                                                 (1)

y are all values of all signals that are evidence, in all records, that are finite; sigma is their stated
noise, or, where none is stated, what the data show of it. Clocks and frames stand where the records state
them (or, unknown ones, where a first guess puts them); everything else, their errors too, is a parameter of
the model. Rows are the same for every model.

Runs are kept: a model that differs by its sensors alone costs no simulation.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexarm.arm import Arm
from flexarm.arm.parameter import neighbours, parameters
from flexarm.arm.sensor_effect import ClockEffect, FrameEffect, SignalEffect
from flexarm.comparison.beside import last_needed
from flexarm.comparison.poses import is_input, pose_numbers, solve_poses
from flexarm.comparison.start import first_guess
from flexarm.comparison.subject import Placement, Subject, subject
from flexarm.comparison.unknowns import stated
from flexarm.drive import Drive
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.measurement.slopes import predict_slopes
from flexarm.record import Record, Signal

Floats = NDArray[np.float64]

KEPT_RUNS, KEPT_RESIDUALS = 8, 400
"""Number of runs and of residuals that are remembered."""
SHIFT = 1e-4
"""Of a point, for a difference that is exact to rounding [m]."""


@dataclass(frozen=True, eq=False)
class Rows:
    """The rows of (1) that belong to one channel of one signal of one record.

    Attributes
    ----------
    record, signal : str
        Names.
    channel : int
        Of the signal.
    where : slice
        In the vector.
    kept : ndarray of bool, shape (n,)
        Rows of the signal that are in it.
    sigma : float
        1 sigma of the noise [SI].
    time : ndarray
        Stamps of the kept rows [s], or numbers of poses.
    """

    record: str
    signal: str
    channel: int
    where: slice
    kept: NDArray[np.bool_]
    sigma: float
    time: Floats


@dataclass(eq=False)
class Observed:
    """Records, and the residuals (1) of any model of the arm against them.

    Attributes
    ----------
    arm : Arm
        The nominal model.
    records : dict of str to Record
        What was measured.
    step, alpha : float
        Of all simulations [s], [-].
    jobs : int
        Number of simulations at once.
    placement : dict of str to Placement
        Clocks and frames by record.
    rows : tuple of Rows
        What the entries of a residual are.
    skipped : dict of str to str
        Signals of no use, "record: signal", and why.
    """

    arm: Arm
    records: Mapping[str, Record]
    step: float = 2e-3
    alpha: float = -0.05
    placement: dict[str, Placement] = field(init=False, default_factory=dict)
    rows: tuple[Rows, ...] = field(init=False, default=())
    skipped: dict[str, str] = field(init=False, default_factory=dict)
    jobs: int = 1
    _runs: OrderedDict[Any, Any] = field(init=False, default_factory=OrderedDict)
    _residuals: OrderedDict[Any, Floats] = field(init=False, default_factory=OrderedDict)
    _drives: dict[Any, Drive] = field(init=False, default_factory=dict)
    runs_made: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        rows: list[Rows] = []
        start = 0
        for name, record in self.records.items():
            pair = self._pair(name, self.arm)
            self.placement[name] = first_guess(pair, stated(record))
            self.skipped |= {f"{name}: {signal}": why for signal, why in pair.skipped.items()}
            for signal in pair.evidence.values():
                for each in self._channels(name, pair, signal, start):
                    rows.append(each)
                    start = each.where.stop
        self.rows = tuple(rows)
        if not rows:
            reasons = "; ".join(f"{name}: {why}" for name, why in self.skipped.items())
            raise InvalidParameter(f"hold nothing to compare with a simulation ({reasons})", where="records")

    def correction(self, arm: Arm) -> Floats:
        """What (1) misses of its value for vanishing time steps h, shape (len(self),).

        r(h/4) + (r(h/4) - r(h/2))/3 - r(h): Richardson's extrapolation, as the method is of order two.
        """
        if all(record.kind == "static" for record in self.records.values()):
            return np.zeros(len(self))
        half, quarter = (self.with_step(self.step / n).residual(arm) for n in (2, 4))
        found: Floats = quarter + (quarter - half) / 3 - self.residual(arm)
        return found

    def with_step(self, step: float) -> Observed:
        """The same rows against other simulations."""
        found = copy(self)
        found.step = step
        found._runs, found._residuals = OrderedDict(), OrderedDict()
        return found

    def with_drives(self, records: Mapping[str, Record]) -> Observed:
        """The same rows against simulations along the drives of other records."""
        found = self.with_step(self.step)
        found.records, found._drives = records, {}
        return found

    def with_noise(self, times: Floats) -> Observed:
        """The same rows with more noise, times as much in each of `rows`."""
        found = self.with_step(self.step)
        found.rows = tuple(
            replace(each, sigma=each.sigma * float(t)) for each, t in zip(self.rows, times, strict=True)
        )
        return found

    def __len__(self) -> int:
        """Number of residuals."""
        return int(self.rows[-1].where.stop)

    # ---------------------------------------------------------------- residuals

    def residual(self, arm: Arm) -> Floats:
        """Eq. (1) for a model, shape (len(self),)."""
        key = (arm.joints, arm.links, arm.payloads, arm.points, arm.effects, arm.motors, arm.controllers)
        if key not in self._residuals:
            found = np.empty(len(self))
            for name in self.records:
                self._fill(found, name, self._pair(name, arm))
            found.setflags(write=False)
            self._residuals[key] = found
            while len(self._residuals) > KEPT_RESIDUALS:
                self._residuals.popitem(last=False)
        return self._residuals[key]

    def prepare(self, arms: Iterable[Arm]) -> None:
        """Computes residuals of many models, `jobs` at once; `residual` says later which of them failed."""
        wanted = list(arms)
        if self.jobs > 1 and len(wanted) > 1:
            with ThreadPoolExecutor(self.jobs) as pool:
                list(pool.map(self._tried, wanted))

    def _tried(self, arm: Arm) -> None:
        with suppress(InvalidParameter, NotConverged):
            self.residual(arm)

    def slopes(self, arm: Arm, keys: list[str]) -> Floats:
        """Derivatives of (1) by parameters of the model, shape (len(self), len(keys)).

        A point that moves in its link moves with the link's section, dp/do = R; all else by differences.
        """
        exact = self.pose_slopes(arm, keys)
        if exact is not None:
            return exact
        found = np.zeros((len(self), len(keys)))
        wanted = parameters(arm, keys)
        pairs = [neighbours(arm, parameter) for parameter in wanted]
        seen = [self._only_seen(p.key) for p in wanted]
        self.prepare(a for pair, s in zip(pairs, seen, strict=True) if not s for a, _ in pair)
        for k, (parameter, ((above, up), (below, down))) in enumerate(zip(wanted, pairs, strict=True)):
            if seen[k]:
                found[:, k] = self._point_slope(arm, parameter.key)
            else:
                found[:, k] = (self.residual(above) - self.residual(below)) / (up - down)
        return found

    def pose_slopes(self, arm: Arm, keys: list[str]) -> Floats | None:
        """The same of poses, from the derivatives of their equilibria: one run for all parameters.

        None where records are motions, orientations are measured, or a law has no derivative.
        """
        signals = {(each.record, each.signal) for each in self.rows}
        if any(
            self.records[record].kind != "static"
            or self.records[record].signals[signal].quantity == "orientation"
            for record, signal in signals
        ):
            return None
        found = np.empty((len(self), len(keys)))
        try:
            for name, record in self.records.items():
                run = solve_poses(record.applied_to(arm), record, sensitivities=keys)
                self._fill_slopes(found, name, run)
        except InvalidParameter:
            return None
        return found

    def channels(self) -> Iterator[tuple[Rows, slice]]:
        """Rows by channel."""
        for each in self.rows:
            yield each, each.where

    # --------------------------------------------------------------------- runs

    def pair(self, name: str, arm: Arm) -> Subject:
        """A simulation of the model beside a record."""
        return self._pair(name, arm)

    def _pair(self, name: str, arm: Arm) -> Subject:
        record = self.records[name]
        carried = record.applied_to(arm)
        if record.kind == "static":
            inputs = {n: "is an input of the poses" for n, s in record.signals.items() if is_input(record, s)}
            run = self._run(name, record, carried)
            return subject(run, record, pose_numbers(record), inputs, carried)
        return subject(self._run(name, record, carried), record, arm=carried)

    def _run(self, name: str, record: Record, arm: Arm) -> Any:
        """The simulation, made or remembered."""
        key = (name, *self._mechanics(record, arm))
        run = self._runs.get(key)
        if run is not None:
            return run
        self.runs_made += 1
        run = solve_poses(arm, record) if record.kind == "static" else self._simulated(name, record, arm)
        self._runs[key] = run
        while len(self._runs) > KEPT_RUNS:
            self._runs.popitem(last=False)
        return run

    def _simulated(self, name: str, record: Record, arm: Arm) -> Any:
        from flexarm.simulation import simulate

        quantities = {signal.quantity for signal in record.signals.values()}
        options: dict[str, Any] = {
            "step": self.step,
            "alpha": self.alpha,
            "rotations": True,
            "forces": "strain" in quantities,
        }
        drive = self._drive(name, record, arm)
        options["end"] = last_needed(record, arm, drive.start)
        return simulate(arm, drive, **options)

    def _drive(self, name: str, record: Record, arm: Arm) -> Drive:
        key = (name, _driving(record, arm))
        if key not in self._drives:
            self._drives[key] = Drive.from_record(record, arm)
        return self._drives[key]

    def _last_drive(self, name: str) -> float:
        """Last instant at which all drives are known; what is measured later says nothing about the model."""
        record = self.records[name]
        if record.kind == "static" or not record.drive:
            return float(np.inf)
        return min(float(record.signals[drive].time[-1]) for drive in record.drive)

    def _mechanics(self, record: Record, arm: Arm) -> tuple[Any, ...]:
        """What a run depends on: everything but effects on sensors that do not drive."""
        moving = tuple(e for e in arm.effects if not isinstance(e, SignalEffect | ClockEffect | FrameEffect))
        loop = (arm.motors, arm.controllers, _read_by_controllers(record, arm))
        return (arm.joints, arm.links, arm.payloads, arm.points, moving, _driving(record, arm), loop)

    def _only_seen(self, key: str) -> bool:
        """Whether a parameter is the place of a point of which only positions are measured."""
        table, name, *_ = key.split(".")
        if table != "points":
            return False
        signals = [s for record in self.records.values() for s in record.signals.values() if s.point == name]
        return all(signal.quantity == "position" for signal in signals)

    def _point_slope(self, arm: Arm, key: str) -> Floats:
        """Derivative of (1) by the place of a point in its link."""
        _, point, _, axis = key.split(".")
        found = np.zeros(len(self))
        for name in self.records:
            pair = self._pair(name, arm)
            run = pair.simulation
            i = run.points.index(point)
            move = np.zeros_like(run.position)
            move[:, i] = _turned(run.orientation[:, i], "xyz".index(axis))
            ahead, behind = found.copy(), found.copy()
            for rows, sign in ((ahead, SHIFT), (behind, -SHIFT)):
                moved = replace(run, position=run.position + sign * move)
                self._fill(rows, name, replace(pair, simulation=moved))
            found += (ahead - behind) / (2 * SHIFT)
        return found

    # --------------------------------------------------------------------- rows

    def _channels(self, name: str, pair: Subject, signal: Signal, start: int) -> Iterator[Rows]:
        residual = pair.residual(signal, self.placement[name], hold=True)
        noise = pair.noise(signal)
        stamps = pair.stamps[signal.name]
        driven = pair.instants(signal, self.placement[name]) <= self._last_drive(name) + 1e-9
        for channel in range(residual.shape[1]):
            kept = np.isfinite(residual[:, channel]) & driven
            count = int(kept.sum())
            if count == 0:
                continue
            sigma = float(noise[channel]) or shown_noise(residual[kept, channel])
            if sigma > 0:
                yield Rows(name, signal.name, channel, slice(start, start + count), kept, sigma, stamps[kept])
                start += count

    def _fill(self, found: Floats, name: str, pair: Subject) -> None:
        residuals: dict[str, Floats] = {}
        for each in self.rows:
            if each.record != name:
                continue
            if each.signal not in residuals:
                signal = pair.record.signals[each.signal]
                residuals[each.signal] = pair.residual(signal, self.placement[name], hold=True)
            found[each.where] = residuals[each.signal][each.kept, each.channel] / each.sigma  # eq. (1)

    def _fill_slopes(self, found: Floats, name: str, run: Any) -> None:
        record = self.records[name]
        stamps = pose_numbers(record)
        slopes: dict[str, Floats] = {}
        for each in self.rows:
            if each.record != name:
                continue
            if each.signal not in slopes:
                signal = record.signals[each.signal]
                frame = self.placement[name].frame(signal)
                slopes[each.signal] = predict_slopes(
                    run, signal, registration=frame, stamps=stamps[each.signal]
                )
            found[each.where] = -slopes[each.signal][each.kept, each.channel] / each.sigma


def weighed(record: Record, key: str) -> bool:
    """Whether a parameter is the mass of a payload that a record weighed: it has no effect there."""
    table, name, *rest = key.split(".")
    if table == "effects" and name == "payload_mass":
        name, rest = rest[0], ["mass"]
    elif table != "payloads":
        return False
    carried = record.payloads.get(name)
    return carried is not None and rest == ["mass"] and carried.mass is not None


def _turned(quaternion: Floats, axis: int) -> Floats:
    """An axis of the section in base axes, shape (n, 3)."""
    from scipy.spatial.transform import Rotation

    found: Floats = Rotation.from_quat(quaternion).as_matrix()[:, :, axis]
    return found


def shown_noise(residual: Floats) -> float:
    """1 sigma of white noise from second differences, which a smooth motion hardly has, robustly.

    The variance of r_{i-1} - 2 r_i + r_{i+1} is six times that of r.
    """
    if len(residual) < 8:
        return 0.0
    return float(1.4826 * np.median(np.abs(np.diff(residual, 2))) / np.sqrt(6.0))


def _driving(record: Record, arm: Arm) -> tuple[Any, ...]:
    """Effects of the model on signals and clocks that drive a record."""
    places = {*record.drive, *(record.signals[name].clock for name in record.drive)}
    return tuple(e for e in arm.effects if isinstance(e, SignalEffect | ClockEffect) and e.at in places)


def _read_by_controllers(record: Record, arm: Arm) -> tuple[Any, ...]:
    """Effects on sensors whose readings move the arm, in a closed loop."""
    if all(record.signals[name].quantity != "joint_command" for name in record.drive):
        return ()
    sensors = {sensor.name for sensor in arm.sensors}
    return tuple(e for e in arm.effects if isinstance(e, SignalEffect) and e.at in sensors)
