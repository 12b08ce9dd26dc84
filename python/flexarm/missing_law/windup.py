r"""Linear response of the residuals to a windup of a joint.

A windup w(t) adds to the angle by which a drive turns its joint: with phi the motor's angle over the ratio,
theta the link's angle and k the joint's stiffness,

.. math:: T = k (\varphi + w - \theta) + c (\dot\varphi + \dot w - \dot\theta)                         (1)

so that a run along phi + w has it. w is a cubic B-spline in each record [deBoor2001],

.. math:: w(t) = \sum_j c_j B_j(t), \qquad
          \partial r/\partial c_j = \lim_{\varepsilon \to 0}
          (r(\varphi + \varepsilon B_j) - r(\varphi))/\varepsilon                                        (2)

One run gives (2) of many splines: each step is differentiated by all of them. In poses w is a number for
each, and one run turns the joint in all of them: no pose moves another one; (2) is a difference there. A
torque f that the joint loses is the windup w = -f/k. Runs of (2) take a longer time step; residuals about a
latent motion are simulated with the step of the problem.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import factorial
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.budget import allows
from flexarm.comparison.simulated_record import SimulatedRecord, rotation_between
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.residual_rows import write_over_noise
from flexarm.drive import Drive, JointDrive
from flexarm.measurement.slopes import predict_slopes
from flexarm.missing_law.basis import Basis, PoseBasis, basis_of
from flexarm.missing_law.policy import LawPolicy
from flexarm.threads import at_once

if TYPE_CHECKING:
    from scipy.interpolate import PPoly


def drive_plus(drive: JointDrive, extra: PPoly) -> JointDrive:
    """Return a drive plus a piecewise polynomial; both are held before and after."""
    from scipy.interpolate import PPoly

    own = PPoly(drive.coefficients, drive.breaks)
    breaks = np.unique(np.concatenate([drive.breaks, extra.x]))
    breaks = breaks[np.concatenate([[True], np.diff(breaks) > 1e-9])]
    order = max(len(drive.coefficients), len(extra.c))
    middle = (breaks[:-1] + breaks[1:]) / 2
    found = np.zeros((order, len(breaks) - 1))
    for part in (own, extra):
        inside = np.clip(middle, part.x[0], part.x[-1])
        held = (middle < part.x[0]) | (middle > part.x[-1])
        i = np.clip(np.searchsorted(part.x, inside, side="right") - 1, 0, len(part.x) - 2)
        offset = np.where(held, inside, breaks[:-1]) - part.x[i]
        c = part.c[::-1, i]  # rising powers
        for k in range(len(c)):
            term = sum(
                c[j] * offset ** (j - k) * (factorial(j) / factorial(k) / factorial(j - k))
                for j in range(k, len(c))
            )
            found[order - 1 - k] += np.where(held & (k > 0), 0.0, term)
    return JointDrive(breaks, found, drive.side)


@dataclass(frozen=True, eq=False)
class Response:
    """Linear response of the residuals to what is missing at a place."""

    problem: Problem
    arm: Arm
    joint: str
    """The joint that moves, or carries the place; the model is that of the diagnosis."""
    bases: Mapping[str, Basis]
    """By record; coefficients of all records follow one another."""
    jacobian: Floats
    """Derivatives of the residual by all coefficients, shape (n, m)."""

    def parts(self, coefficients: Floats) -> dict[str, Floats]:
        """Return coefficients by record."""
        ends = np.cumsum([len(basis) for basis in self.bases.values()])[:-1]
        return dict(zip(self.bases, np.split(coefficients, ends), strict=True))

    def run(self, name: str, coefficients: Floats) -> SimulatedRecord:
        """Return the run of a record that has the states of the joint: the one without the motion."""
        return self.problem.simulations.run(name, self.arm)


class WindupResponse(Response):
    """Eq. (2) of a joint in all records."""

    @classmethod
    def of(cls, problem: Problem, arm: Arm, joint: str, policy: LawPolicy) -> WindupResponse | None:
        """Simulate (2), `jobs` runs at once; None if the time for it ends."""
        coarse = problem.with_step(policy.response_step)
        bases: dict[str, Basis] = {}
        for name, record in problem.records.items():
            poses = record.kind == "static"
            drive = None if poses else problem.simulations.drive(name, record.applied_to(arm))
            bases[name] = basis_of(problem, name, policy, np.inf if drive is None else drive.start)
        first = dict(zip(bases, np.cumsum([0, *map(len, bases.values())]), strict=False))
        found = np.zeros((len(problem), sum(map(len, bases.values()))))

        def columns(which: tuple[str, int]) -> None:
            name, j = which
            basis, at = bases[name], first[name]
            if isinstance(basis, PoseBasis):
                moved, nothing = coarse.residual(arm).copy(), coarse.residual(arm)
                turned = policy.perturbation * np.ones(len(basis))
                coarse.write_residual(moved, name, run_with_windup(coarse, arm, name, joint, basis, turned))
                for rows in coarse.rows_of(name):
                    row = np.arange(rows.where.start, rows.where.stop)
                    change = (moved - nothing)[rows.where] / policy.perturbation
                    found[row, at + np.rint(rows.time).astype(int)] = change
                return
            some = basis.splines()[j : j + policy.batch]
            found[:, at + j : at + j + len(some)] = _slopes(coarse, arm, name, joint, some)

        runs = [
            (name, j)
            for name, basis in bases.items()
            for j in range(0, 1 if isinstance(basis, PoseBasis) else len(basis), policy.batch)
        ]
        for k in range(0, len(runs), problem.jobs):
            if not allows(f"the missing motion of {joint} was sought"):
                return None
            at_once(columns, runs[k : k + problem.jobs], problem.jobs)
        return cls(problem, arm, joint, bases, found)

    def moved(self, coefficients: Floats) -> Floats:
        """Return what a latent motion changes of the residual, simulated, shape (n,)."""
        before = self.problem.residual(self.arm)
        after = before.copy()
        for name, each in self.parts(coefficients).items():
            self.problem.write_residual(after, name, self.run(name, each))
        found: Floats = after - before
        return found

    def run(self, name: str, coefficients: Floats) -> SimulatedRecord:
        """Return the run of a record with a latent motion."""
        return run_with_windup(self.problem, self.arm, name, self.joint, self.bases[name], coefficients)


def _slopes(problem: Problem, arm: Arm, name: str, joint: str, splines: Sequence[PPoly]) -> Floats:
    """Return (2) of some splines of a record, shape (n, splines), zero in the rows of others."""
    changes = [Drive({joint: JointDrive(each.x, each.c)}) for each in splines]
    pair, placement = problem.simulations.differentiated(name, arm, changes), problem.placement[name]
    found = np.zeros((len(problem), len(splines)))

    def of_signal(name: str) -> Floats:
        signal, clock = pair.record.signals[name], placement.clock(pair.record.signals[name])
        slopes = predict_slopes(
            pair.simulation, signal, clock, placement.frame(signal), stamps=pair.stamps[name]
        )
        slopes = np.where(np.isnan(slopes), 0.0, slopes)  # after the end of the run
        if signal.quantity != "orientation":
            return -slopes
        shown, part = pair.predicted(signal, placement, hold=True), 1e-6
        before = rotation_between(signal.values, shown)
        after = [rotation_between(signal.values, shown + part * slopes[..., k]) for k in range(len(splines))]
        return np.stack([(each - before) / part for each in after], axis=-1)

    write_over_noise(found, problem.rows_of(name), of_signal)
    return found


def driven_joints(problem: Problem, arm: Arm, name: str) -> set[str]:
    """Return the joints whose motor a record turns, in poses also those that stand still."""
    record = problem.records[name]
    if record.kind == "static":
        drives = (record.signals[each] for each in record.drive)
        known = {each.joint for each in drives if each.side == "output"}
        return {each.name for each in arm.moving_joints} - known
    joints = problem.simulations.drive(name, arm).joints
    return {joint for joint, drive in joints.items() if drive.side == "motor"}


def run_with_windup(
    problem: Problem, arm: Arm, name: str, joint: str, basis: Basis, coefficients: Floats
) -> SimulatedRecord:
    """Return the run of a record with a windup on a joint's drive."""
    if isinstance(basis, PoseBasis):
        return problem.simulations.turned(name, arm, joint, coefficients)
    drive = problem.simulations.drive(name, problem.records[name].applied_to(arm))
    with_windup = drive_plus(drive.joints[joint], basis.polynomial(coefficients))
    return problem.simulations.driven(name, arm, {joint: with_windup})
