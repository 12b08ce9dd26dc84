r"""States of the motion at the samples of a residual, and how the residual depends on them.

The states are those of the simulation, which also knows torques that nothing measured. They sort the samples:
into conditions for a table of cells, and into groups for covariates.

Angle, rate, acceleration, torque and time are covariates of the residual. The correlation ratio of y is the
share of its squares that lies in the means of groups g of n_g samples, such as the intervals of a state:

    eta^2 = sum_g n_g mean_g^2 / sum_i y_i^2                                                         (1)

A constant explains c of the squares. Of the rest, y less its mean with n - 1 degrees of freedom, k groups
explain, less what they explain of noise,

    r = 1 - (1 - eta^2) (n - 1)/(n - k)                                                              (2)

A curve over any state explains a step, and two curves explain more than one. Covariates are therefore tried
in order of complexity: 1 the sign of a state, 2 a curve over it, 3 two curves (one for each sense of the
motion) or time. A more complex covariate must gain `covariate_gain` over the simpler ones, and explain as
much of the whole.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import AlignedRecord
from flexarm.residual_analysis.policy import POLICY

Groups = NDArray[np.intp]
Covariates = Mapping[str, tuple[int, Groups]]
"""By name: complexity of the covariate, and the group of each sample."""

CONSTANT = "a constant"


def intervals(state: Floats, bins: int = 25) -> Groups:
    """Return the number of the interval, of `bins` equally wide ones, in which each sample lies."""
    edges = np.linspace(state.min(), state.max(), bins + 1)
    return np.clip(np.digitize(state, edges) - 1, 0, bins - 1)


def correlation_ratio(groups: Groups, values: Floats) -> float:
    """Return the share (1) of the squares of values, shape (n, k), in the means of groups of samples."""
    count = np.bincount(groups)
    sums = np.stack([np.bincount(groups, column) for column in values.T], axis=1)
    explained = np.sum(sums[count > 0] ** 2 / count[count > 0, None])
    return float(explained / max(np.sum(values**2), 1e-300))  # eq. (1)


@dataclass(frozen=True)
class CovariateDependence:
    """Dependence of a residual on covariates."""

    adjusted: Mapping[str, float]
    """By covariate, such as "angle of elbow": share (2) of what is not constant."""
    best: str
    """The covariate that explains most, unless a simpler one explains nearly as much."""
    constant: float
    """Share of the squares in a constant."""

    @property
    def share(self) -> float:
        """Share of all squares that the best covariate explains, the constant included."""
        rest = 0.0 if self.best == CONSTANT else self.adjusted[self.best]
        return self.constant + (1 - self.constant) * rest

    @property
    def relevant(self) -> bool:
        """Return True if the best covariate explains enough of the squares to be named in a table."""
        return self.share >= POLICY.explained_share

    def __str__(self) -> str:
        shares = {name: f"{name} {100 * share:.0f} %" for name, share in self.adjusted.items()}
        ranked = sorted(self.adjusted, key=lambda name: -self.adjusted[name])
        others = ", ".join(shares[name] for name in ranked[:3] if name != self.best)
        best = shares.get(self.best, "nothing much")
        return f"constant {100 * self.constant:.0f} %; the rest {best} ({others})"


def covariate_dependence(covariates: Covariates, values: Floats) -> CovariateDependence:
    """Return the dependence of values over their noise, shape (n, k), on covariates."""
    n, rest = len(values), values - values.mean(axis=0)
    constant = 1 - float(np.sum(rest**2) / max(np.sum(values**2), 1e-300))
    adjusted = {}
    for name, (_, groups) in covariates.items():
        k = len(np.unique(groups))
        left = (1 - correlation_ratio(groups, rest)) * (n - 1) / (n - k) if n > k else 1.0
        adjusted[name] = max(0.0, 1 - left)  # eq. (2)
    best, most = CONSTANT, 0.0
    for complexity in sorted({complexity for complexity, _ in covariates.values()}):
        equals = [name for name, (each, _) in covariates.items() if each == complexity]
        first = max(equals, key=lambda name: adjusted[name])
        if adjusted[first] > most + POLICY.covariate_gain:
            best, most = first, adjusted[first]
    named = most * (1 - constant) > POLICY.covariate_gain
    return CovariateDependence(adjusted, best if named else CONSTANT, constant)


Mask = NDArray[np.bool_]

ZONES = 5
"""Intervals of angle and of time in a table of cells."""


@dataclass(frozen=True, eq=False)
class JointStates:
    """States of one joint at the samples, each of shape (n,)."""

    joint: str
    """Its name."""
    angle: Floats
    rate: Floats
    acceleration: Floats
    torque: Floats
    """Of the drive; torque on the child, output side [rad or m, N m or N]."""
    since_motion: Floats
    since_torque: Floats
    """Time since rate and torque last changed sign [s]; infinite before that."""
    sense: NDArray[np.intp]
    """1 or -1: direction of the last motion, as friction remembers it; 0 before it moved."""
    slides: bool = False
    """True for a prismatic joint."""

    @property
    def units(self) -> dict[str, str]:
        """Unit by state."""
        length, force = ("m", "N") if self.slides else ("rad", "N m")
        return {"angle": length, "rate": f"{length}/s", "acceleration": f"{length}/s2", "torque": force}

    def label(self, state: str) -> str:
        """Return the label of an axis: the state of a joint that turns or slides, with its unit."""
        word = {"angle": "position", "torque": "force"}.get(state, state) if self.slides else state
        return f"{word} of {self.joint} [{self.units[state]}]"

    @property
    def moves(self) -> bool:
        """True if the joint moves in time, as in no record of poses."""
        return bool(np.any(self.rate != 0))


def joined_states(parts: Sequence[JointStates]) -> JointStates:
    """Return the states at the samples of several records, one after the other."""
    names = ("angle", "rate", "acceleration", "torque", "since_motion", "since_torque", "sense")
    arrays = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    return JointStates(parts[0].joint, **arrays, slides=parts[0].slides)


def moved_joints(pairs: Sequence[AlignedRecord]) -> list[str]:
    """Return the joints that at least one of the records moves; all movable ones if none does."""
    found: set[str] = set()
    for pair in pairs:
        run = pair.simulated.simulation
        spans = np.ptp(np.asarray(run.drive_angle), axis=0)
        found |= {name for name, span in zip(run.joints, spans, strict=True) if span > 1e-9}
    movable = [joint.name for joint in pairs[0].simulated.arm.moving_joints]
    return [name for name in movable if name in found] or movable


def joint_states(pair: AlignedRecord, joint: str, instants: Floats) -> JointStates:
    """Return the states of a joint at instants of the simulation."""
    run = pair.simulated.simulation
    time, j = np.asarray(run.time), run.joints.index(joint)
    rate = np.asarray(run.drive_rate)[:, j]
    torques = np.asarray(getattr(run, "joint_torque", run.motor_torque))
    rounding = 1e-12 * np.abs(torques).max(initial=0.0)  # of joints without a drive, in loops
    torque = np.where(np.abs(torques[:, j]) > rounding, torques[:, j], 0.0)
    moving = pair.record.kind == "motion" and len(time) > 1
    acceleration = np.gradient(rate, time) if moving else np.zeros(len(time))
    sense, since_motion = _sign_history(time, rate, instants)
    since_torque = _sign_history(time, torque, instants)[1]
    never = np.full(len(instants), np.inf)
    return JointStates(
        joint,
        np.interp(instants, time, np.asarray(run.drive_angle)[:, j]),
        np.interp(instants, time, rate),
        np.interp(instants, time, acceleration),
        np.interp(instants, time, torque),
        since_motion if moving else never,
        since_torque if moving else never,
        sense,
        pair.simulated.arm.joint(joint).type == "prismatic",
    )


def _sign_history(time: Floats, values: Floats, instants: Floats) -> tuple[NDArray[np.intp], Floats]:
    """Return the last sign of values (0 before any), and the time since it changed [s] (infinite before)."""
    least = POLICY.rest * np.abs(values).max(initial=0.0)
    sign = np.sign(np.where(np.abs(values) > least, values, 0.0))
    known = np.flatnonzero(sign)
    last = np.concatenate([[0.0], sign[known]])[np.searchsorted(time[known], instants, side="right")]
    turns = time[known[1:]][np.diff(sign[known]) != 0]
    changed = np.concatenate([[-np.inf], turns])[np.searchsorted(turns, instants, side="right")]
    return last.astype(np.intp), instants - changed


def conditions(
    states: Sequence[JointStates],
    time: Floats,
    record: Groups,
    labels: Sequence[str],
    first_mode: float | None,
) -> Iterator[tuple[str, str, Mask]]:
    """Yield state, wording and samples of every condition; those of one state share out all samples.

    `states` are of the joints that move. `time` [s] and `record`, the number of each sample's record in
    `labels`, have the shape (n,). A reversal lasts for one period of `first_mode` [Hz], or three samples.
    """
    yield "all", "throughout", np.ones(len(time), dtype=bool)
    steps = np.diff(time)
    step = float(np.median(steps[steps > 0])) if np.any(steps > 0) else 0.0
    window = max(1 / first_mode if first_mode else 0.0, 3 * step)
    for each in states:
        yield from _of_joint(each, f" of {each.joint}" if len(states) > 1 else "", window)
    in_time = any(each.moves for each in states)
    for k, name in enumerate(labels if in_time or len(labels) > 1 else ()):
        inside = record == k
        if not in_time:
            yield "record", name, inside
        elif inside.any():
            edges = np.linspace(time[inside].min(), time[inside].max(), ZONES + 1)
            zone = np.clip(np.digitize(time, edges) - 1, 0, ZONES - 1)
            of = f" of {name}" if len(labels) > 1 else ""
            for i in range(ZONES):
                yield "time", f"{edges[i]:.3g} to {edges[i + 1]:.3g} s{of}", inside & (zone == i)


def _of_joint(states: JointStates, of: str, window: float) -> Iterator[tuple[str, str, Mask]]:
    """Yield the conditions of one joint."""
    zone, unit = intervals(states.angle, ZONES), states.units["angle"]
    width = np.ptp(states.angle) / ZONES
    for i in range(ZONES if width > 0 else 0):
        middle = states.angle.min() + (i + 0.5) * width
        yield f"angle{of}", f"near {middle:+.2g} {unit}{of}", zone == i
    if np.any(states.torque != 0):
        yield f"torque sign{of}", f"torque{of} negative", ~(states.torque > 0)
        yield f"torque sign{of}", f"torque{of} positive", states.torque > 0
    if not states.moves:
        return
    rests = np.abs(states.rate) <= POLICY.rest * np.abs(states.rate).max(initial=0.0)
    yield f"motion{of}", f"angle{of} rising", ~rests & (states.rate > 0)
    yield f"motion{of}", f"angle{of} falling", ~rests & (states.rate < 0)
    yield f"motion{of}", f"angle{of} standing", rests
    for kind, since in (("torque", states.since_torque), ("motion", states.since_motion)):
        yield f"{kind} reversal{of}", f"after {kind} reversal{of}", since < window
        yield f"{kind} reversal{of}", f"away from {kind} reversal{of}", ~(since < window)
    strong = np.abs(states.acceleration) > 0.5 * np.abs(states.acceleration).max()
    yield f"acceleration{of}", f"acceleration{of} strong", strong
    yield f"acceleration{of}", f"acceleration{of} weak", ~strong


def covariate_groups(states: Sequence[JointStates], time: Floats, record: Groups) -> Covariates:
    """Return the covariates that a residual may follow, with 12 samples an interval or more, 4 poses."""
    found: dict[str, tuple[int, Groups]] = {}
    if record.max(initial=0) > 0:
        found["the record"] = (1, record)
    moving = [each for each in states if each.moves]
    bins = int(np.clip(len(time) // (12 if moving else 4), 2, 25))
    for each in states:
        of = f" of {each.joint}" if len(states) > 1 else ""
        if np.any(each.torque > 0) and np.any(each.torque < 0):
            found[f"sign of torque{of}"] = (1, (each.torque > 0).astype(np.intp))
        for kind in ("angle", "rate", "torque", "acceleration") if each.moves else ("angle", "torque"):
            found[f"{kind}{of}"] = (2, intervals(getattr(each, kind), bins))
        if each.moves:
            found[f"sense of motion{of}"] = (1, each.sense + 1)
            for kind in ("angle", "torque"):
                two = 3 * intervals(getattr(each, kind), max(2, bins // 2)) + each.sense + 1
                found[f"{kind}{of}, by sense of motion"] = (3, two)
    if moving:
        found["time"] = (3, _slow_time(moving, time, record, bins))
    return found


def _slow_time(states: Sequence[JointStates], time: Floats, record: Groups, bins: int) -> Groups:
    """Return intervals of time, by record, no shorter than cycles of the motion.

    Any slow residual follows finer ones.
    """
    groups, first = np.zeros(len(time), dtype=np.intp), 0
    for k in np.unique(record):
        inside = record == k
        turns = [int(np.count_nonzero(np.diff(each.sense[inside]))) for each in states]
        count = int(np.clip(min((t for t in turns if t), default=0) // 2, 1, bins))
        groups[inside] = first + intervals(time[inside], count)
        first += count
    return groups
