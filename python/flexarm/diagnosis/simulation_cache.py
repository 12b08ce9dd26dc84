"""Cached simulations of records; models that differ only in sensors share one."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.sensor_effect import ClockEffect, FrameEffect, SignalEffect
from flexarm.arm.vocabulary import ANYWHERE
from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import end_of_simulation, needed_outputs, require_known_drive
from flexarm.comparison.free_vibration import rings_freely, simulate_free_vibration
from flexarm.comparison.poses import FORCES, pair_poses, solve_poses, with_turned
from flexarm.comparison.simulated_record import SimulatedRecord, pair_record
from flexarm.drive import Drive, JointDrive
from flexarm.drive.lead_in import with_pulse
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.record import Record

if TYPE_CHECKING:
    from flexarm.diagnosis.record_conditions import InitialCondition, UncertainTilt


KEPT_RUNS = 8
"""Least number of runs that are remembered; two of every record, if that is more.

In shorter steps a run is so much longer, and fewer are: as much as that, or one of every record.
"""


class SimulationCache:
    """Cached simulations of models in the motions and poses of some records.

    `step` [s] and `alpha` [-] are of all simulations, `made` is their number so far, and `beside` how many go
    side by side.
    """

    def __init__(self, records: Mapping[str, Record], step: float, alpha: float) -> None:
        self.records, self.step, self.alpha = records, step, alpha
        self.made, self.beside = 0, max(_core.lanes(), 1)
        self._kept = max(KEPT_RUNS, 2 * len(records))
        self._runs: OrderedDict[Any, SimulatedRecord] = OrderedDict()
        self._drives: dict[Any, Drive] = {}
        self._pairs: dict[str, SimulatedRecord] = {}

    def with_step(self, step: float) -> SimulationCache:
        """Return the same with other steps; drives stay as they are."""
        found = copy(self)
        found.step, found._runs = step, OrderedDict()
        found._kept = max(len(self.records), min(self._kept, int(self._kept * step / self.step)))
        return found

    def run(self, name: str, arm: Arm, rotations: bool = False) -> SimulatedRecord:
        """Return the simulation of a record by a model; with `rotations`, those of points are known."""
        return self._run_of(name, self.records[name].applied_to(arm), rotations)

    def tilted(self, tilt: UncertainTilt, arm: Arm, turn: float) -> SimulatedRecord:
        """Return a run on a base that is turned further than its record states, by `turn` [rad]."""
        record = self.records[tilt.record]
        assert record.base is not None
        x, y = record.base.tilt
        there = (x + turn, y) if tilt.axis == "x" else (x, y + turn)
        stand = record.base.replace(tilt=there)
        return self._run_of(tilt.record, record.replace(base=stand).applied_to(arm))

    def batches(self, name: str, arms: Iterable[Arm]) -> list[dict[Arm, Arm]]:
        """Return valid models, and what a record makes of them, in batches for `runs`.

        Those of a batch have the same equations along the same drive, and as many runs as go side by side.
        """
        record = self.records[name]
        alike: dict[Any, dict[Any, list[tuple[Arm, Arm]]]] = {}
        for arm in arms:
            with suppress(InvalidParameter):
                carried = record.applied_to(arm)
                equations = frozenset(
                    (e.name, e.at) for e in arm.effects if e.place in ("joint", "base", ANYWHERE)
                )
                kind = equations, effects_on_drives(record, carried)
                alike.setdefault(kind, {}).setdefault(self._key(name, carried), []).append((arm, carried))
        found = []
        for runs in (list(each.values()) for each in alike.values()):
            for k in range(0, len(runs), self.beside):
                found.append(dict(pair for some in runs[k : k + self.beside] for pair in some))
        return found

    def runs(self, name: str, carried: Mapping[Arm, Arm]) -> Iterator[tuple[Arm, SimulatedRecord]]:
        """Yield models of a batch with their simulations, side by side where they fit; none that fails."""
        keys = {arm: self._key(name, each) for arm, each in carried.items()}
        new = {keys[arm]: each for arm, each in carried.items() if keys[arm] not in self._runs}
        beside = self._side_by_side(name, new)
        for arm, each in carried.items():
            with suppress(InvalidParameter, NotConverged):
                found = beside.get(keys[arm])
                yield arm, replace(found, arm=each) if found is not None else self._run_of(name, each)

    def _side_by_side(self, name: str, arms: Mapping[Any, Arm]) -> dict[Any, SimulatedRecord]:
        """Return the runs of a record, by the key of their models, that fit side by side."""
        from flexarm.simulation.side_by_side import side_by_side

        record, found = self.records[name], {}
        alike: dict[Any, dict[Any, Arm]] = {}
        if record.kind == "motion" and not rings_freely(record):
            for key, arm in arms.items():
                with suppress(InvalidParameter):
                    alike.setdefault(tuple(self._options(name, arm).items()), {})[key] = arm
        for options, some in alike.items():
            pairs = [(arm, self.drive(name, arm)) for arm in some.values()]
            runs = side_by_side(pairs, **dict(options)) if len(pairs) > 1 else [None]
            for key, run in zip(some, runs, strict=True):
                if run is not None:
                    found[key] = self._paired(run, name, run.arm)
        self.made += len(found)
        return found

    def _run_of(self, name: str, carried: Arm, rotations: bool = False) -> SimulatedRecord:
        """Return a run of what a record makes of a model."""
        key = self._key(name, carried)
        run = self._runs.get(key)
        if run is None or (rotations and run.simulation.orientation is None):
            self.made += 1
            run = self._runs[key] = self._made(name, carried, rotations)
            while len(self._runs) > self._kept:
                self._runs.popitem(last=False)
        return replace(run, arm=carried)

    def _paired(self, run: Any, name: str, arm: Arm) -> SimulatedRecord:
        """Return a record with a run; signals that one run predicts are those that all predict."""
        if name not in self._pairs:
            self._pairs[name] = replace(pair_record(run, self.records[name]), simulation=None)
        return replace(self._pairs[name], simulation=run, arm=arm)

    def _key(self, name: str, arm: Arm) -> tuple[Any, ...]:
        """Return what a run depends on: everything but effects on sensors that do not drive."""
        record = self.records[name]
        moving = tuple(e for e in arm.effects if not isinstance(e, SignalEffect | ClockEffect | FrameEffect))
        loop = (arm.motors, arm.controllers, _read_by_controllers(record, arm))
        parts = (arm.gravity, arm.joints, arm.gears, arm.closures, arm.links, arm.payloads, arm.points)
        return (name, *parts, moving, effects_on_drives(record, arm), loop)

    def _made(self, name: str, arm: Arm, rotations: bool) -> SimulatedRecord:
        """Return a run."""
        record = self.records[name]
        if record.kind == "static":
            return pair_poses(solve_poses(arm, record), record, arm)
        if rings_freely(record):
            return self._paired(simulate_free_vibration(arm, record, self.step), name, arm)
        return self._paired(self._along(self.drive(name, arm), name, arm, rotations), name, arm)

    def with_pulse(self, start: InitialCondition, arm: Arm, height: float) -> SimulatedRecord:
        """Return the simulation of a record after a jerk of a drive."""
        drive = self.drive(start.record, self.records[start.record].applied_to(arm)).joints[start.joint]
        jerk = with_pulse(drive, start.before, start.width, height)
        return self.driven(start.record, arm, {start.joint: jerk})

    def driven(self, name: str, arm: Arm, joints: Mapping[str, JointDrive]) -> SimulatedRecord:
        """Return the simulation of a record along other drives of some joints; it is not cached."""
        record = self.records[name]
        carried = record.applied_to(arm)
        drive = self.drive(name, carried)
        self.made += 1
        run = self._along(replace(drive, joints={**drive.joints, **joints}), name, carried)
        return self._paired(run, name, carried)

    def turned(self, name: str, arm: Arm, joint: str, angles: Floats) -> SimulatedRecord:
        """Return poses of a record with a joint's motor turned further in each, by `angles` [rad]."""
        record = self.records[name]
        carried = record.applied_to(arm)
        self.made += 1
        return pair_poses(solve_poses(carried, with_turned(record, joint, angles)), record, carried)

    def differentiated(self, name: str, arm: Arm, changes: Sequence[Drive]) -> SimulatedRecord:
        """Return the simulation of a record with its derivatives with respect to changes of its drives.

        Forces are those of the time stepping: changes are smooth.
        """
        from flexarm.simulation.prepared import prepared
        from flexarm.simulation.solve import driven

        record = self.records[name]
        carried = record.applied_to(arm)
        options = self._options(name, carried)
        del options["consistent_forces"]
        run = prepared(carried, self.drive(name, carried), **options)
        run.options.consistent_forces = False
        self.made += 1
        return self._paired(driven(run, changes), name, carried)

    def _along(self, drive: Drive, name: str, arm: Arm, rotations: bool = False) -> Any:
        """Return the simulation along a drive."""
        from flexarm.simulation import simulate

        options = self._options(name, arm)
        options["rotations"] |= rotations
        return simulate(arm, drive, **options)

    def _options(self, name: str, arm: Arm) -> dict[str, Any]:
        """Return the options of a run of a record."""
        record = self.records[name]
        seen = {signal.quantity for signal in record.signals.values()}
        return {
            "step": self.step,
            "alpha": self.alpha,
            **needed_outputs([record]),
            "consistent_forces": not seen.isdisjoint(FORCES),
            "end": end_of_simulation(record, arm, self.drive(name, arm).start),
        }

    def drive(self, name: str, arm: Arm) -> Drive:
        """Return what a model with its record's payloads is driven by."""
        record = self.records[name]
        key = (name, effects_on_drives(record, arm))
        if key not in self._drives:
            require_known_drive(record)
            self._drives[key] = Drive.from_record(record, arm)
        return self._drives[key]


def effects_on_drives(record: Record, arm: Arm) -> tuple[Any, ...]:
    """Return effects of the model on signals and clocks that drive a record."""
    places = {*record.drive, *(record.signals[name].clock for name in record.drive)}
    return tuple(e for e in arm.effects if isinstance(e, SignalEffect | ClockEffect) and e.at in places)


def _read_by_controllers(record: Record, arm: Arm) -> tuple[Any, ...]:
    """Effects on sensors whose readings move the arm, in a closed loop."""
    if all(record.signals[name].quantity != "joint_command" for name in record.drive):
        return ()
    sensors = {sensor.name for sensor in arm.sensors}
    return tuple(e for e in arm.effects if isinstance(e, SignalEffect) and e.at in sensors)
