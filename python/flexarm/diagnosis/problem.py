"""The identification problem: measured and predicted data as one vector of residuals over their noise.

    r(model) = (y - f(model)) / sigma                                                                 (1)

y are all values of all signals that are evidence, in all records, sigma is their noise
(`diagnosis.residual_rows`). Clocks and frames are as the records state them, unknown ones as a first guess
has them. Everything else, their errors included, is a parameter of the model. Rows are the same for every
model.
"""

from __future__ import annotations

from collections import Counter, OrderedDict
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, field, replace
from functools import partial
from operator import attrgetter
from types import MappingProxyType
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.budget import current
from flexarm.comparison.alignment_parameters import stated_placement
from flexarm.comparison.initial_guess import initial_guesses
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.diagnosis.discrepancy import angles_of_poses, pose_kernels
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.record_conditions import (
    InitialCondition,
    UncertainTilt,
    find_initial_conditions,
    initial_condition_jacobian,
    tilt_jacobian,
    uncertain_tilts,
)
from flexarm.diagnosis.residual_rows import (
    Rows,
    differences,
    evidence_rows,
    is_non_smooth,
    rows_left,
    static_jacobian,
    write_over_noise,
)
from flexarm.diagnosis.simulation_cache import SimulationCache
from flexarm.errors import InvalidParameter
from flexarm.measurement.effects_of import SensorEffects
from flexarm.record import Record
from flexarm.threads import at_once

KEPT_RESIDUALS = 400
"""Number of residuals that are remembered."""

_Seen = WeakKeyDictionary[Any, dict[tuple[str, SensorEffects], Floats]]
"""Residuals of each signal relative to a stored run, by the effects on its sensor."""


@dataclass(eq=False)
class Problem:
    """Records, and the residuals (1) of any model of the arm against them."""

    arm: Arm
    """The nominal model."""
    records: Mapping[str, Record]
    """Measured records by name."""
    step: float = 2e-3
    alpha: float = -0.05
    """Settings of all simulations [s], [-]."""
    jobs: int = 1
    """Number of simulations at once."""
    policy: SelectionPolicy = field(default_factory=SelectionPolicy)
    """Thresholds of a search for effects."""
    placement: dict[str, Placement] = field(init=False, default_factory=dict)
    """Clocks and frames by record."""
    rows: tuple[Rows, ...] = field(init=False, default=())
    """The channels of which a residual consists."""
    skipped: dict[str, str] = field(init=False, default_factory=dict)
    """Signals of no use, "record: signal", and why."""
    planar: bool = field(init=False, default=False)
    """True if the nominal arm moves in a plane in all records."""
    initial_conditions: tuple[InitialCondition, ...] = field(init=False, default=())
    """Possible initial vibrations of records that begin in motion."""
    tilts: tuple[UncertainTilt, ...] = field(init=False, default=())
    """Tilts of the base that records state with a sigma."""
    simulations: SimulationCache = field(init=False)
    """Simulations of the records."""
    evidence: WeakKeyDictionary[Any, Any] = field(init=False, default_factory=WeakKeyDictionary)
    """Evidence of fits, and the rows that it was computed with (`diagnosis.evidence`)."""
    draws: dict[Any, tuple[np.random.Generator, list[SimulationCache]]] = field(
        init=False, default_factory=dict
    )
    """Simulations along drives with other noise, by the effects on drives (`diagnosis.noise_model`)."""
    _residuals: OrderedDict[Any, Floats] = field(init=False, default_factory=OrderedDict)
    _stepped: dict[float, Problem] = field(init=False, default_factory=dict)
    _seen: _Seen = field(init=False, default_factory=WeakKeyDictionary)
    _kernels: dict[Any, list[tuple[Floats, Floats]]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        self.simulations = SimulationCache(self.records, self.step, self.alpha)
        rows: list[Rows] = []
        pairs = [self.simulations.run(name, self.arm) for name in self.records]
        motions = all(record.kind == "motion" for record in self.records.values())
        self.planar = motions and all(
            getattr(pair.simulation, "solver", {}).get("dimension") == 2 for pair in pairs
        )
        guesses = initial_guesses(pairs, [stated_placement(record) for record in self.records.values()])
        self.placement = dict(zip(self.records, guesses, strict=True))
        for name, pair in zip(self.records, pairs, strict=True):
            self.skipped |= {f"{name}: {signal}": why for signal, why in pair.skipped.items()}
            rows.extend(evidence_rows(name, pair, self.placement[name], rows[-1].where.stop if rows else 0))
        self.rows = tuple(rows)
        if not rows:
            reasons = "; ".join(f"{name}: {why}" for name, why in self.skipped.items())
            raise InvalidParameter(f"hold nothing to compare with a simulation ({reasons})", where="records")
        self.initial_conditions = find_initial_conditions(self, self.arm)
        self.tilts = uncertain_tilts(self.records)

    def __len__(self) -> int:
        """Return the number of residuals."""
        return int(self.rows[-1].where.stop)

    @property
    def seconds(self) -> float:
        """Length of the longest motion [s]; 0 if all are poses."""
        motions = (each for each in self.rows if self.records[each.record].kind == "motion")
        return max((float(np.ptp(each.time)) for each in motions), default=0.0)

    def expected_cost(self, non_smooth: bool) -> float:
        """Return the sum of squares of the residual of a right model."""
        return sum((1 + each.explained_square(non_smooth)) * len(each.time) for each in self.rows)

    def channels(self) -> Iterator[tuple[Rows, slice]]:
        """Rows by channel."""
        for each in self.rows:
            yield each, each.where

    def rows_of(self, record: str) -> Iterator[Rows]:
        """Rows of one record."""
        return (each for each in self.rows if each.record == record)

    def pose_kernels(self, rows: Rows) -> list[tuple[Floats, Floats]]:
        """Return eigenvalues and eigenvectors of the correlation of poses, by correlation length."""
        key = (rows.record, rows.signal, rows.mask.tobytes())
        if key not in self._kernels:
            record = self.records[rows.record]
            pose = np.asarray(record.signals[rows.signal].pose)[rows.mask]
            self._kernels[key] = pose_kernels(angles_of_poses(record, pose))
        return self._kernels[key]

    def with_step(self, step: float) -> Problem:
        """Return the same rows against other simulations, whose residuals are remembered too."""
        if step == self.step:
            return self
        if step not in self._stepped:
            found = self._stepped[step] = self.fresh()
            found.step, found.simulations = step, self.simulations.with_step(step)
        return self._stepped[step]

    def fresh(self) -> Problem:
        """Return a copy without cached residuals, for other rows or records."""
        found = copy(self)
        found._residuals, found._stepped = OrderedDict(), {}
        found.evidence = WeakKeyDictionary()
        return found

    def along(self, simulations: SimulationCache) -> Problem:
        """Return the same rows against other simulations, such as those along other drives."""
        found = self.fresh()
        found.records, found.simulations, found.draws = simulations.records, simulations, {}
        return found

    def with_noise(self, times: Floats) -> Problem:
        """Return the same rows with more noise, times as much in each of `rows`."""
        found = self.fresh()
        found.rows = tuple(
            replace(
                each,
                sigma=each.sigma * float(t),
                input_noise=each.input_noise / float(t) ** 2,
                discretisation_error=each.discretisation_error / float(t) ** 2,
            )
            for each, t in zip(self.rows, times, strict=True)
        )
        return found

    def without(self, out: NDArray[np.bool_]) -> Problem:
        """Fewer rows: without those of a mask of shape (n,)."""
        found = self.fresh()
        found.rows = tuple(rows_left(self.rows, out))
        return found

    def residual(self, arm: Arm) -> Floats:
        """Eq. (1) for a model, shape (len(self),)."""
        key = _key(arm)
        if key not in self._residuals:
            found = np.empty(len(self))
            run = partial(self.simulations.run, arm=arm)
            for name, pair in zip(self.records, at_once(run, self.records, self.jobs), strict=True):
                self.write_residual(found, name, pair)
            self._keep(key, found)
        return self._residuals[key]

    def _keep(self, key: Any, found: Floats) -> None:
        """Remembers a residual, and forgets the oldest ones."""
        found.setflags(write=False)
        self._residuals[key] = found
        while len(self._residuals) > KEPT_RESIDUALS:
            self._residuals.popitem(last=False)

    def write_residual(
        self, found: Floats, name: str, pair: SimulatedRecord, rows: Iterable[Rows] | None = None
    ) -> None:
        """Write the rows of one record into a residual, or some of them."""
        seen = self._seen.setdefault(pair.simulation, {})

        def of_signal(name_of: str) -> Floats:
            signal = pair.record.signals[name_of]
            key = (name_of, pair.effects(signal))
            if key not in seen:
                seen[key] = pair.residual(signal, self.placement[name], hold=True)
            return seen[key]

        write_over_noise(found, self.rows_of(name) if rows is None else rows, of_signal)

    def prepare(self, arms: Iterable[Arm]) -> None:
        """Compute residuals of many models, side by side and `jobs` batches at once; `residual` says later
        which failed. Those that the budget leaves no time for are left out.
        """
        wanted = {key: arm for arm in arms if (key := _key(arm)) not in self._residuals}
        if len(wanted) < 2:
            return
        found = {key: np.empty(len(self)) for key in wanted}
        written: list[Any] = []
        budget = current()

        def compute(batch: tuple[str, dict[Arm, Arm]]) -> None:
            for arm, pair in () if budget.spent else self.simulations.runs(*batch):
                with suppress(InvalidParameter):
                    self.write_residual(found[_key(arm)], batch[0], pair)
                    written.append(_key(arm))

        some = {name: self.simulations.batches(name, wanted.values()) for name in self.records}
        at_once(compute, [(name, batch) for name, batches in some.items() for batch in batches], self.jobs)
        for key, count in Counter(written).items():
            if count == len(self.records):
                self._keep(key, found[key])

    def correction(self, arm: Arm) -> Floats:
        """Return the discretisation error of (1): its limit for vanishing time steps h less (1), shape
        (len(self),).

        Richardson's extrapolation from h and h/2 less r(h). Where
        h/2 moves more than the noise, or laws have corners, that shows in smaller steps: with h/2 and h/4.
        """
        if all(record.kind == "static" for record in self.records.values()):
            return np.zeros(len(self))
        coarse = self.residual(arm)
        half = self.with_step(self.step / 2).residual(arm)
        if is_non_smooth(arm) or np.mean((half - coarse) ** 2) > 1.0:
            fine, finer = half, self.with_step(self.step / 4).residual(arm)
        else:
            fine, finer = coarse, half
        return extrapolated(fine, finer) - coarse

    def jacobian(
        self, arm: Arm, keys: list[str], steps: Mapping[str, float] = MappingProxyType({})
    ) -> Floats:
        """Return derivatives of (1) by parameters of the model, initial conditions and tilts of the base.

        The shape is (len(self), len(keys)); `steps` are those of differences by some parameters.
        """
        initial_conditions = [start for start in self.initial_conditions if start.key in keys]
        found = np.zeros((len(self), len(keys)))
        of_model = [k for k, key in enumerate(keys) if not key.startswith("records.")]
        own = [keys[k] for k in of_model]
        exact = self.static_jacobian(arm, own)
        found[:, of_model] = differences(self, arm, own, steps) if exact is None else exact
        found[:, [keys.index(start.key) for start in initial_conditions]] = initial_condition_jacobian(
            self, arm, initial_conditions
        )
        tilts = [tilt for tilt in self.tilts if tilt.key in keys]
        found[:, [keys.index(tilt.key) for tilt in tilts]] = tilt_jacobian(self, arm, tilts)
        return found

    def static_jacobian(self, arm: Arm, keys: list[str]) -> Floats | None:
        """Return the same from the derivatives of equilibria; None where they have none."""
        return static_jacobian(self, arm, keys)


def extrapolated(coarse: Floats, fine: Floats) -> Floats:
    """Richardson's extrapolation of a method of order two from steps h and h/2."""
    return fine + (fine - coarse) / 3


_key = attrgetter(
    *("gravity", "joints", "gears", "closures", "links", "payloads", "points", "motors", "controllers"),
    "effects",
)
"""Return the parts of a model that residuals depend on."""
