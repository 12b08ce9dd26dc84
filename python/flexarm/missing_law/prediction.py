"""Gap of records with a law: of models that have it as an effect, and of runs along its windup.

A law that is no effect of a model is a windup along states of the run that it moves. A run without it gives
the first states, its own runs the next: a fixed-point iteration of `policy.rounds`. States of motions are
means over `policy.window`, so that it converges at the first mode.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.ndimage import uniform_filter1d

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.comparison.compare import compare
from flexarm.comparison.comparison import Comparison
from flexarm.comparison.pooled_gap import pooled_gap
from flexarm.diagnosis.fit import FIT_ERRORS
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.simulation_cache import SimulationCache
from flexarm.diagnosis.verification import Gaps, SplitRecords
from flexarm.law_curve import LawGap
from flexarm.missing_law.basis import TimeBasis
from flexarm.missing_law.latent import Latent
from flexarm.missing_law.law import Law
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.states import ANGLE_OF, angles_of, states_of
from flexarm.missing_law.windup import drive_plus

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

    from flexarm.record import Record


@dataclass(frozen=True, eq=False)
class LawCheck:
    """Records with which laws are verified, and the model without one."""

    records: SplitRecords
    """Those that were fitted, and those held out."""
    stated: Arm
    updated: Arm
    """The nominal model as given, and the one that a diagnosis repaired without a law."""
    signal: str
    """The signal of the gap."""

    @cached_property
    def before(self) -> Gaps:
        """Return the gap of the model without a law by record."""
        return self.records.gaps(self.updated)

    def gaps(self, arm: Arm) -> tuple[LawGap, LawGap]:
        """Return the gap without and with a law, as `flexarm compare` prints it: fitted, and held out."""
        after = self.records.gaps(arm)
        train, held_out = (
            LawGap(**asdict(pooled_gap(self.before, after, names, self.signal)))
            for names in (self.records.training, self.records.held_out)
        )
        return train, held_out

    def accepts(self, held_out: LawGap, policy: LawPolicy) -> bool:
        """Return True if a law predicts enough of what was held out."""
        if held_out.before_rms is None or held_out.after_rms is None:
            return False
        return held_out.after_rms < (1 - policy.least_closed) * held_out.before_rms


def gaps_with_law(
    latent: Latent,
    law: Law,
    problem: Problem,
    held_out: Mapping[str, Record],
    signal: str,
    policy: LawPolicy,
) -> tuple[LawGap, LawGap]:
    """Return the gap of a signal without and with a law: of the records that were fitted, and held out."""
    found = []
    for records, fitted in ((problem.records, True), (held_out, False)):
        try:
            found.append(_gap(latent, law, problem, records, signal, fitted, policy))
        except FIT_ERRORS:
            found.append(LawGap())
    return found[0], found[1]


def _gap(
    latent: Latent,
    law: Law,
    problem: Problem,
    records: Mapping[str, Record],
    signal: str,
    fitted: bool,
    policy: LawPolicy,
) -> LawGap:
    runs = SimulationCache(records, problem.step, problem.alpha)
    before: dict[str, Comparison] = {}
    after: dict[str, Comparison] = {}
    for k, (name, record) in enumerate(records.items()):
        plain, with_windup = _runs(latent, law, runs, name, k if fitted else -1, policy)
        before[name] = compare(plain.arm, record, simulation=plain)
        after[name] = compare(plain.arm, record, simulation=with_windup)
    if not any(signal in each.signals for each in before.values()):
        return LawGap()
    return LawGap(**asdict(pooled_gap(before, after, before, signal)))


def _runs(
    latent: Latent, law: Law, runs: SimulationCache, name: str, number: int, policy: LawPolicy
) -> tuple[Any, Any]:
    """Return the runs of a record without and with a law."""
    assert latent.response is not None
    arm, joint = latent.response.arm, latent.at
    plain = run = runs.run(name, arm).simulation
    others = [law.of.removeprefix(ANGLE_OF)] if law.of.startswith(ANGLE_OF) else []
    poses = runs.records[name].kind == "static"
    drive = None if poses else runs.drive(name, runs.records[name].applied_to(arm)).joints[joint]
    for _ in range(policy.rounds):
        states = states_of(run, joint, run.time, policy) | angles_of(run, others, run.time)
        if drive is None:
            moved = runs.turned(name, arm, joint, law.values(states, run.time, number))
        else:
            wound = drive_plus(drive, _windup(law, states, run.time, number, policy))
            moved = runs.driven(name, arm, {joint: wound})
        run = moved.simulation
    return plain, run


def _windup(law: Law, states: dict[str, Floats], time: Floats, number: int, policy: LawPolicy) -> PPoly:
    """Return the windup of a law of slow states of a run."""
    basis = TimeBasis.over(float(time[0]), float(time[-1]), policy)
    fine = basis.fine(policy)
    window = max(int(policy.window / float(np.median(np.diff(time)))), 1)
    slow = {
        key: np.interp(
            fine,
            time,
            values if key == "motor_angle" else uniform_filter1d(values, window, mode="nearest"),
        )
        for key, values in states.items()
    }
    return basis.polynomial(basis.nearest(fine, law.values(slow, fine, number)))
