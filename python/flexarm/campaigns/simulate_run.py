"""Transient runs: series at a rate, and statistics of the deviation from the nominal run.

With d(t) the length of the deviation of a quantity from that of the nominal run at each of n steps

    rms = sqrt(sum d^2 / n),  max = max d,  final = d(end)                                               (1)

where the deviation of a scalar keeps its sign in `final`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.consistency import missing
from flexarm.arm.sensor import Sensor
from flexarm.arrays import Floats
from flexarm.campaigns.cases import Case
from flexarm.campaigns.outcome import Outcome, Prepared, Runner, Value, Variable, tried
from flexarm.campaigns.study import Found, Keep, Study
from flexarm.comparison.poses import FORCES
from flexarm.drive import Drive
from flexarm.errors import InvalidParameter
from flexarm.linear.ports import unit_of_channels
from flexarm.measurement.predict import FRAMED_READINGS, READINGS, read
from flexarm.record import Record
from flexarm.simulation.side_by_side import side_by_side
from flexarm.simulation.simulate import simulate
from flexarm.simulation.simulation import Simulation

TURNS = ("orientation", "inclination", "angular_rate", "acceleration")
"""Quantities that need rotations of the points."""


@dataclass
class SimulateRun(Runner):
    """Simulations along the drives of all cases."""

    drives: list[Drive | Record]
    keep: tuple[Keep, ...]
    step: float
    alpha: float
    variables: tuple[Variable, ...]
    instants: list[list[Floats]]
    """By case and entry of `keep`: where series are taken [s]; infinite after the end of a run."""
    reference: list[list[Floats]] = field(default_factory=list)
    """By case and entry of `keep`: values of the nominal run at every step."""

    def nominal(self, arm: Arm) -> list[Outcome]:
        """Run the nominal arm through every case, and keep what statistics compare with."""
        found = []
        for case in range(len(self.drives)):
            [run] = self._simulated([arm], [case])
            if isinstance(run, Exception):
                raise run
            self.reference.append([_read(run, keep, run.time) for keep in self.keep])
            found.append(self._kept(run, case))
        return found

    @property
    def at_once(self) -> int:
        """Number of arms that this processor computes side by side."""
        return max(1, _core.lanes())

    def outcome(self, arm: Arm, case: int) -> Outcome:
        """Return series and statistics of one run."""
        [found] = self.outcomes([arm], [case])
        if isinstance(found, Exception):
            raise found
        return found

    def outcomes(self, arms: Sequence[Arm], cases: Sequence[int]) -> list[Outcome | Exception]:
        """Return series and statistics of each run, or what it raised."""
        runs = self._simulated(arms, cases)
        return [
            run if isinstance(run, Exception) else tried(self._kept, run, case)
            for run, case in zip(runs, cases, strict=True)
        ]

    def _simulated(self, arms: Sequence[Arm], cases: Sequence[int]) -> list[Simulation | Exception]:
        """Return the runs, also a single one as beside others: none depends on what runs with it."""
        seen = {keep.quantity for keep in self.keep}
        options: dict[str, Any] = {
            "step": self.step,
            "alpha": self.alpha,
            "forces": "strain" in seen,
            "consistent_forces": not seen.isdisjoint(FORCES),
            "rotations": any(quantity in TURNS for quantity in seen),
        }
        pairs = [(arm, self.drives[case]) for arm, case in zip(arms, cases, strict=True)]
        together = side_by_side(pairs, joints=not seen <= {"position", *TURNS}, **options)
        return [
            tried(simulate, *pair, **options) if run is None else run
            for pair, run in zip(pairs, together, strict=True)
        ]

    def _kept(self, run: Any, case: int) -> Outcome:
        found: dict[str, Value] = {}
        for k, keep in enumerate(self.keep):
            if keep.rate_hz is not None:
                values = _read(run, keep, self.instants[case][k])
                found[keep.variable] = values[:, 0] if values.shape[1] == 1 else values
            if keep.statistics:
                deviation = _read(run, keep, run.time) - self.reference[case][k]
                found |= statistics(keep, deviation)
        return found


def statistics(keep: Keep, deviation: Floats) -> dict[str, float]:
    """Return the statistics (1) of a deviation, shape (n, channels), by the name of their variable."""
    squares = deviation**2 @ np.ones(deviation.shape[1])
    last = deviation[-1]
    values = {
        "rms": float(np.sqrt(np.mean(squares))),
        "max": float(np.sqrt(np.max(squares))),
        "final": float(last[0] if len(last) == 1 else np.linalg.norm(last)),
    }
    return {f"{keep.variable}_{name}": values[name] for name in keep.statistics}


def simulate_run(study: Study, arm: Arm, cases: tuple[Case, ...]) -> Prepared:
    """Return simulations of a study, and what is wrong with what is to be kept.

    Raise InvalidFile if a drive cannot be read.
    """
    drives = [_drive(case, arm) for case in cases]
    spans = [_span(drive, arm) for drive in drives]
    found: Found = []
    instants: list[list[Floats]] = [[] for _ in cases]
    variables: list[Variable] = []
    clocks: dict[float | None, str] = {}
    for i, keep in enumerate(study.keep):
        if wrong := _keep_problems(keep, i, arm):
            found += wrong
            continue
        planned = _planned(max(end - start for start, end in spans), keep.rate_hz)
        for k, (start, end) in enumerate(spans):
            late = start + planned > end + 1e-9 * max(1.0, abs(end))
            instants[k].append(np.where(late, np.inf, start + planned))
        time = clocks.setdefault(keep.rate_hz, f"{keep.variable}_time" if clocks else "time")
        variables += _variables(keep, arm, time, spans[0][0] + planned)
    return SimulateRun(drives, study.keep, study.step, study.alpha, tuple(variables), instants), found


def _drive(case: Case, arm: Arm) -> Drive | Record:
    path = case.files[0]
    if path.is_dir() or path.name == "record.toml":
        return Record.load(path)
    return Drive.from_csv(path, arm)


def _span(drive: Drive | Record, arm: Arm) -> tuple[float, float]:
    motion = Drive.from_record(drive, drive.applied_to(arm)) if isinstance(drive, Record) else drive
    return motion.start, motion.end


def _planned(longest: float, rate: float | None) -> Floats:
    """Return instants at a rate over the longest run, from its start [s]."""
    if rate is None:
        return np.zeros(0)
    return np.arange(int(np.floor(longest * rate * (1 + 1e-12))) + 1) / rate


def _keep_problems(keep: Keep, i: int, arm: Arm) -> Found:
    """Return what is wrong with an entry, as a sensor of the model would be refused."""
    found: Found = []
    if keep.quantity not in READINGS and keep.quantity not in FRAMED_READINGS:
        allowed = ", ".join((*FRAMED_READINGS, *READINGS))
        return [(("keep", i, "quantity"), f"must be one of {allowed}, got {keep.quantity!r}")]
    try:
        _sensor(keep)
    except InvalidParameter as error:
        return [(("keep", i, problem.where), problem.what) for problem in error.problems]
    for kind in ("joint", "point", "link"):
        names = [each.name for each in getattr(arm, f"{kind}s")]
        name = getattr(keep, kind)
        if name is not None and name not in names:
            found.append((("keep", i, kind), missing(kind, name, names)))
    if keep.quantity == "orientation" and keep.statistics:
        what = "of a quaternion have no meaning; keep it with rate_hz, or the inclination"
        found.append((("keep", i, "statistics"), what))
    return found


@lru_cache  # every run is read by the same
def _sensor(keep: Keep) -> Sensor:
    keys = ("joint", "point", "link", "side", "axes", "position", "fibre")
    given = {key: getattr(keep, key) for key in keys}
    return Sensor(
        name=keep.variable,
        quantity=keep.quantity,
        rate_hz=keep.rate_hz or 1.0,
        **{key: value for key, value in given.items() if value not in (None, ())},
    )


def _read(run: Any, keep: Keep, instants: Floats) -> Floats:
    """Return the values of a perfect sensor, shape (n, channels); NaN at instants that are infinite."""
    known = np.isfinite(instants)
    values = read(run, _sensor(keep), np.where(known, instants, run.time[0]))
    return np.asarray(np.where(known[:, None], values, np.nan))


def _variables(keep: Keep, arm: Arm, time: str, instants: Floats) -> list[Variable]:
    """Return the variables of an entry."""
    sensor = _sensor(keep)
    unit = unit_of_channels(arm, sensor)
    channels = sensor.directions
    found = []
    if keep.rate_hz is not None:
        dims, coordinates = [time], {time: instants}
        if len(channels) > 1:
            axis = "axis" if channels == ("x", "y", "z") else f"{keep.variable}_axis"
            dims.append(axis)
            coordinates[axis] = list(channels)  # type: ignore[assignment]
        text = f"{keep.quantity} at {keep.place}"
        tolerance = None if "max" in keep.statistics else keep.tolerance  # told once
        found.append(
            Variable(keep.variable, unit, text, tuple(dims), coordinates, {time: "s"}, tolerance, "series")
        )
    for name in keep.statistics:
        text = f"{name} deviation of {keep.quantity} at {keep.place} from the nominal run"
        tolerance = keep.tolerance if name == "max" else None
        found.append(Variable(f"{keep.variable}_{name}", unit, text, tolerance=tolerance, measure=name))
    return found
