"""Hypotheses about the drives of a record, and the rigid arm by which they are screened.

One drive counts the other way, or one or all are in another unit.

A hypothesis is a tuple of effects that take the fault back before the model is driven (`flexarm.drive`).
Hypotheses that leave no joint beyond the usual range of motion come first; among these, those with fewer
drives at fault. For all drives together only units are tried: who writes one angle in degrees writes all of
them so.

Hypotheses are screened by the motion of the rigid arm along the drives, without dynamics. Kinematics take
milliseconds where a simulation takes seconds, and cannot diverge. Positions, attitudes and rates of a rigid
arm tell a wrong unit or sign of a drive from the right one; torques, strains and deflections need the forces,
and are left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import ceil, log, pi

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.closure import joints_moved_with
from flexarm.arm.joint import motor_ratio, shaft_ratio
from flexarm.arm.kinematics import chain_to, link_pose
from flexarm.arm.sensor_effect import ChannelEffect
from flexarm.arm.sizes import LONGEST
from flexarm.arrays import Floats
from flexarm.comparison.simulated_record import SimulatedRecord, pair_record
from flexarm.drive.from_record import true_time
from flexarm.effects import SignError, UnitError
from flexarm.measurement.effects_of import effects_of
from flexarm.record import Record, Signal
from flexarm.record.plausibility import FARTHEST
from flexarm.record.time_unit import LIVELY, motion_of
from flexarm.simulation.energies import NAMES, Energies
from flexarm.simulation.simulation import Simulation
from flexarm.validation.finding import ChannelFinding
from flexarm.validation.gain_faults import name_conversion
from flexarm.validation.policy import POLICY
from flexarm.wording import listed

Hypothesis = tuple[ChannelEffect, ...]

COMMON_FACTORS = (180 / pi, pi / 180, 2 * pi, 0.5 / pi, 1e3, 1e-3)
"""Wrong units of angles and lengths, of one drive or of all; gear ratios come on top."""
FACTORS = (*COMMON_FACTORS, 100.0, 0.01, 10.0, 0.1, 2.0, 0.5, 4.0, 0.25)
"""The same with factors of counts, which one encoder may have."""


def drive_hypotheses(arm: Arm, record: Record, channels: Sequence[ChannelFinding] | None) -> list[Hypothesis]:
    """Return faults of drives that explain the disturbed signals and leave a plausible motion.

    `channels` are those along the drives as they are; None if the model cannot follow these.
    """
    drives = [record.signals[name] for name in record.drive]
    drives = [signal for signal in drives if signal.joint is not None and signal.valid.any()]
    moving = [
        signal
        for signal in drives
        if np.nanstd(signal.values) > 3 * (signal.noise_std or 0.0)
        and (channels is None or is_disturbed(arm, str(signal.joint), channels))
    ]
    found: list[Hypothesis] = [(SignError(at=signal.name),) for signal in moving]
    found += [each for signal in moving for each in _unit_hypotheses([signal], arm, FACTORS)]
    turning = [signal for signal in drives if signal.unit == "rad"]
    if moving and len(turning) > 1:
        found += _unit_hypotheses(turning, arm, COMMON_FACTORS)
    implausible = implausible_drives(arm, record)
    found = [each for each in found if implausible <= unit_factors(each).keys()]
    out_of_range = {signal.name for signal in drives if relative_range(signal, arm) > 1}
    return sorted(found, key=lambda each: not out_of_range <= unit_factors(each).keys())


def implausible_drives(arm: Arm, record: Record) -> set[str]:
    """Return the drives that turn their joint beyond `implausible_angle`, and faster than joints do.

    Drives with an effect of the model are left out: it states their values.
    """
    known = {effect.at for effect in arm.effects if effect.place.startswith("signal")}
    drives = [record.signals[name] for name in record.drive if name not in known]
    return {signal.name for signal in drives if is_implausible(signal, arm)}


def is_implausible(signal: Signal, arm: Arm) -> bool:
    """Return True if a drive turns its joint beyond `implausible_angle`, and faster than joints do."""
    turns = signal.unit == "rad" and signal.joint is not None and signal.pose is None
    if not turns or FARTHEST * relative_range(signal, arm) <= POLICY.implausible_angle:
        return False
    motion = motion_of(signal.name, signal.time, signal.values[:, 0], signal.unit)
    return motion.rate > LIVELY * shaft_ratio(signal.joint, arm.gears)


def _unit_hypotheses(drives: Sequence[Signal], arm: Arm, factors: Iterable[float]) -> list[Hypothesis]:
    """Return unit errors of drives: one factor for all, gear ratios or the inverse, degrees of the motor."""
    ratios = [abs(motor_ratio(arm, str(signal.joint))) for signal in drives]
    common = [(factor,) * len(drives) for factor in factors]
    geared = [tuple(ratios), tuple(1 / ratio for ratio in ratios)]
    if all(is_implausible(signal, arm) for signal in drives):
        geared.append(tuple(180 / pi * ratio for ratio in ratios))  # degrees of the motor
    tried = dict.fromkeys([*common, *geared] if any(ratio != 1 for ratio in ratios) else common)
    return [
        tuple(UnitError(at=signal.name, factor=f) for signal, f in zip(drives, each, strict=True))
        for each in tried
        if all(relative_range(signal, arm) / f < 1 for signal, f in zip(drives, each, strict=True))
        and any(
            np.nanstd(signal.values) / f > POLICY.min_drive_motion
            for signal, f in zip(drives, each, strict=True)
        )
    ]


def similar_factors(one: Hypothesis, other: Hypothesis) -> bool:
    """Return True if two hypotheses give a drive units that are hard to tell apart."""
    mine, its = unit_factors(one), unit_factors(other)
    return any(abs(log(mine[at] / its[at])) < log(POLICY.similar_factors) for at in mine.keys() & its.keys())


def unit_factors(hypothesis: Hypothesis) -> dict[str, float]:
    """Return factors of unit errors by signal."""
    return {
        effect.at: value for effect in hypothesis for key, value, _ in effect.parameters() if key == "factor"
    }


def relative_range(signal: Signal, arm: Arm) -> float:
    """Return the range of a drive relative to the usual range of joints."""
    most = FARTHEST * shaft_ratio(signal.joint, arm.gears) if signal.unit == "rad" else LONGEST
    return float(np.nanmax(np.abs(signal.values), initial=0.0)) / most


def is_disturbed(arm: Arm, joint: str, found: Sequence[ChannelFinding]) -> bool:
    """Return True if at least half of the signals that a joint moves do not follow the model."""
    odd: dict[str, bool] = {}
    for each in found:
        signal = each.channel.signal
        if is_moved_by(arm, joint, signal):
            odd[signal.name] = odd.get(signal.name, False) or bool(each.name) or each.unexplained
    return bool(odd) and sum(odd.values()) >= len(odd) / 2


def is_moved_by(arm: Arm, joint: str, signal: Signal) -> bool:
    """Return True if a joint, or one coupled to it by gears or a loop, moves the place of a signal."""
    moved = joints_moved_with(arm, joint)
    if signal.joint is not None:
        return signal.joint in moved
    link = signal.link or (arm.point(signal.point).link if signal.point is not None else "base")
    return any(each.name in moved for each in chain_to(arm, link))


def describe_hypothesis(arm: Arm, hypothesis: Hypothesis, record: Record, followed: Sequence[str]) -> str:
    """Describe a fault of drives, and the signals that the model follows once it is taken back."""
    others = ", ".join(followed) or "most signals"
    factors = unit_factors(hypothesis)
    if not factors:
        [effect] = hypothesis
        return (
            f"the drive {effect.at} counts the other way: driven by its negative the model follows {others}"
        )
    drives = (
        f"the drive {next(iter(factors))} shows"
        if len(factors) == 1
        else f"the drives {listed(list(factors))} show"
    )
    times = listed(list(dict.fromkeys(f"{factor:.5g}" for factor in factors.values())))
    parts = listed(list(dict.fromkeys(f"1/{factor:.5g}" for factor in factors.values())))
    at, factor = next(iter(factors.items()))
    what = "angle" if all(record.signals[each].unit == "rad" for each in factors) else "length"
    why = _name_ratios(arm, record, factors) or name_conversion(factor, 0.0, record.signals[at].unit)
    return f"{drives} {times} times the {what}{why}: driven by {parts} of it the model follows {others}"


def _name_ratios(arm: Arm, record: Record, factors: Mapping[str, float]) -> str:
    """Return the clause that factors are gear ratios, or ""."""
    ratios = {at: abs(motor_ratio(arm, str(record.signals[at].joint))) for at in factors}
    if all(ratio == 1 for ratio in ratios.values()):
        return ""
    if all(abs(log(factors[at] / ratio)) < POLICY.factor_accuracy for at, ratio in ratios.items()):
        return ", the motor's own angle, not divided by the gear ratio"
    if all(abs(log(factors[at] * ratio)) < POLICY.factor_accuracy for at, ratio in ratios.items()):
        return ", the angle divided by the gear ratio twice"
    return ""


KINEMATIC = frozenset(
    {"position", "orientation", "inclination", "joint_angle", "joint_rate", "angular_rate", "acceleration"}
)
"""Quantities that a rigid arm shows without its forces."""


def rigid_record(arm: Arm, record: Record) -> SimulatedRecord | None:
    """Return a record of motion paired with the rigid arm; None if no signal but the drives is kinematic.

    None also if joints follow others through gears or in loops, which takes a solver.
    Raise InvalidParameter if an effect cannot act on a drive, or readings do not determine its true angle.
    """
    if record.kind == "static" or arm.gears or arm.closures:
        return None
    drives = {name: record.signals[name] for name in record.drive}
    shown = {}
    for name, signal in kinematic_signals(record).items():
        every = slice(None, None, max(1, ceil(len(signal) / POLICY.rigid_rows)))
        shown[name] = signal.replace(time=signal.time[every], values=signal.values[every])
    if not shown:
        return None
    run = rigid_motion(record.applied_to(arm), *_driven(arm, record))
    found = pair_record(run, record.replace(signals={**drives, **shown}))
    return found if found.evidence else None


def kinematic_signals(record: Record) -> dict[str, Signal]:
    """Return the signals that a rigid arm shows, without the drives."""
    return {
        name: signal
        for name, signal in record.signals.items()
        if name not in record.drive and signal.quantity in KINEMATIC
    }


def _driven(arm: Arm, record: Record) -> tuple[Floats, dict[str, Floats]]:
    """Return instants and the angles of the joints there, as the drives say, not smoothed."""
    samples = {}
    for signal in (record.signals[name] for name in record.drive):
        true = effects_of(arm, signal).true(signal.values)[:, 0]
        known = np.isfinite(true)
        if signal.joint is not None and known.any():
            samples[signal.joint] = true_time(signal, arm, float(signal.time[0]))[known], true[known]
    first = min((float(t[0]) for t, _ in samples.values()), default=0.0)
    last = max((float(t[-1]) for t, _ in samples.values()), default=record.duration)
    time = np.linspace(
        first, last, int(np.clip((last - first) / POLICY.rigid_step, 10, POLICY.rigid_instants))
    )
    rest = {name: np.full(len(time), value) for name, value in record.joints.items()}
    return time, rest | {joint: np.interp(time, *each) for joint, each in samples.items()}


def rigid_motion(arm: Arm, time: Floats, angles: Mapping[str, Floats]) -> Simulation:
    """Return the motion of the rigid arm, its joints at some angles [rad, m] or 0; torques are unknown."""
    from scipy.spatial.transform import Rotation

    n, still = len(time), np.zeros(len(time))
    values = {joint.name: angles.get(joint.name, still) for joint in arm.joints}
    angle = np.column_stack([values[joint.name] for joint in arm.joints])
    position, orientation = np.empty((n, len(arm.points), 3)), np.empty((n, len(arm.points), 4))
    angular_rate = np.empty_like(position)
    for k, point in enumerate(arm.points):
        pose = link_pose(arm, point.link, values)
        position[:, k] = pose.of_point(np.asarray(point.position))
        turned = Rotation.from_matrix(np.broadcast_to(pose.R, (n, 3, 3)))
        orientation[:, k] = turned.as_quat()
        turns = (turned[:-1].inv() * turned[1:]).as_rotvec()  # in the body's axes
        between = turns / np.diff(time)[:, None]
        angular_rate[[0, -1], k] = between[[0, -1]]
        angular_rate[1:-1, k] = (between[:-1] + between[1:]) / 2
    rate, unknown = np.asarray(np.gradient(angle, time, axis=0)), np.full(angle.shape, np.nan)
    return Simulation(
        arm,
        time,
        position,
        np.asarray(np.gradient(position, time, axis=0)),
        angle,
        rate,
        angle,
        rate,
        unknown,
        unknown,
        Energies(*[still * np.nan] * len(NAMES)),
        orientation=orientation,
        angular_rate=angular_rate,
    )
