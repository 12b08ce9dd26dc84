"""Gain faults: sign errors, unit errors and dead channels, from the gain of a channel.

A channel in order has the gain 1 up to the influence of missing effects (`max_gain`): an arm 5 % too long, a
payload twice as heavy. A gain counts only if it is known to `min_sigmas` and leaves at most `max_unexplained`
of the motion. Factors near a conversion of units are named after it, those of a torque also after the gear
ratio of its joint. Quantities that bear loads show other factors up to `max_load_gain` where a load is not
stated; that is a remark, not a fault.
"""

from __future__ import annotations

from dataclasses import replace
from math import log, pi

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.joint import motor_ratio
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.record import Signal
from flexarm.validation.channel import Channel, GainFit, channels, predicted_at
from flexarm.validation.finding import ChannelFinding, cost, log_bayes
from flexarm.validation.initial_alignment import initial_alignment
from flexarm.validation.mirrors import with_mirrors
from flexarm.validation.policy import POLICY
from flexarm.validation.saturation import find_frozen, find_saturation, frozen_as_dead
from flexarm.wording import with_unit

LOADED = ("motor_torque", "motor_voltage", "strain", "deflection")
"""Quantities that bear loads, which the nominal model knows less well."""
ANGLES, LENGTHS, RATES, ACCELERATIONS = ("rad",), ("m",), ("rad/s",), ("m/s2",)
UNITS: dict[str, tuple[float, tuple[str, ...]]] = {
    "degrees for radians": (180 / pi, ANGLES + RATES),
    "radians for degrees": (pi / 180, ANGLES + RATES),
    "turns for radians": (0.5 / pi, ANGLES + RATES),
    "radians for turns": (2 * pi, ANGLES + RATES),
    "thousandths such as mm or mrad": (1e3, ()),
    "thousandfold units": (1e-3, ()),
    "centimetres for metres": (100.0, LENGTHS),
    "metres for centimetres": (0.01, LENGTHS),
    "percent": (0.01, ("1",)),
    "inches for metres": (1 / 0.0254, LENGTHS),
    "metres for inches": (0.0254, LENGTHS),
    "feet for metres": (1 / 0.3048, LENGTHS),
    "metres for feet": (0.3048, LENGTHS),
    "multiples of g for m/s2": (1 / 9.80665, ACCELERATIONS),
    "m/s2 for multiples of g": (9.80665, ACCELERATIONS),
    "micro units": (1e6, ()),
    "rpm for rad/s": (30 / pi, RATES),
    "rad/s for rpm": (pi / 30, RATES),
    "arc minutes for radians": (60 * 180 / pi, ANGLES),
    "arc seconds for radians": (3600 * 180 / pi, ANGLES),
}
"""Conversions: factor of a reading, and SI units to which it applies; (): all."""


def judge_gain(channel: Channel, simulated: SimulatedRecord, placement: Placement) -> ChannelFinding:
    """Return the channel under its best hypothesis of gain."""
    fit, own = channel.fit(), channel.fit_at_gain(1.0)
    here = in_order(channel, own)
    firm = abs(fit.gain) > POLICY.min_sigmas * fit.std and fit.unexplained_share < POLICY.max_unexplained
    if not firm:
        return _dead_channel(channel, own) or replace(here, unexplained=_is_unexplained(channel, own))
    loose = POLICY.max_loaded_gain if channel.signal.quantity in LOADED else POLICY.max_gain
    another_unit = not 1 / loose < abs(fit.gain) < loose
    if fit.gain > 0 and not another_unit:
        return replace(here, unexplained=_is_unexplained(channel, own))
    if fit.gain < 0 and _explained_by_delay(channel, simulated, placement, fit):
        return replace(here, unexplained=True)
    return (
        _sign_error(channel, fit, own) if not another_unit else _unit_error(channel, fit, own, simulated.arm)
    )


def in_order(channel: Channel, own: GainFit) -> ChannelFinding:
    """Return the channel as one in order."""
    return ChannelFinding(channel, cost=cost(channel, own.rms, own.penalty))


def _sign_error(channel: Channel, fit: GainFit, own: GainFit) -> ChannelFinding:
    turned = channel.fit_at_gain(-1.0)
    bayes = log_bayes(len(channel.rows), own.scatter, turned.scatter)
    sentence = (
        f"{channel.label} moves against the model: measured = {fit.gain:.3f} x predicted "
        f"(+- {fit.std:.1g}); with the sign turned {with_unit(fit.rms, channel.signal.unit, 2)} are left "
        f"of {with_unit(own.scatter, channel.signal.unit, 2)}"
    )
    return _if_better(channel, own, "sign_error", bayes, turned, {}, sentence)


def _unit_error(channel: Channel, fit: GainFit, own: GainFit, arm: Arm) -> ChannelFinding:
    factor = abs(fit.gain)
    bayes = log_bayes(len(channel.rows), own.scatter, fit.scatter)
    turned = "against the model and " if fit.gain < 0 else ""
    relative = fit.std / factor
    why = gear_side(channel.signal, factor, relative, arm)
    why = why or name_conversion(factor, relative, channel.signal.unit)
    times = f"{channel.label} moves {turned}{factor:.5g} times as far as the model says"
    if (
        not why
        and fit.gain > 0
        and channel.signal.quantity in LOADED
        and 1 / POLICY.max_load_gain < factor < POLICY.max_load_gain
    ):
        load = "does the arm carry what model and record state?"
        return replace(in_order(channel, own), sentence=f"{times}, which no unit gives: {load}")
    sentence = (
        f"{times} (+- {100 * relative:.1f} %){why}; "
        f"with that taken back {100 * fit.unexplained_share:.2g} % of its motion is left"
    )
    values = {"factor": (fit.gain, fit.std, "-")}
    return _if_better(channel, own, "unit_error", bayes, fit, values, sentence)


def gear_side(signal: Signal, factor: float, relative: float, arm: Arm) -> str:
    """Return the clause that a torque's factor is its gear ratio or the inverse, or ""."""
    ratio = motor_ratio(arm, str(signal.joint)) if signal.quantity == "motor_torque" else 1.0
    for own, side, other in ((ratio, "output", "motor"), (1 / ratio, "motor", "output")):
        if ratio != 1 and abs(log(factor / abs(own))) < max(0.1, 3 * relative):
            return f", as a torque on the {side} side does that is said to be on the {other} side"
    return ""


def name_conversion(factor: float, relative: float, unit: str) -> str:
    """Return the clause that names the conversion of units near a factor, or ""."""
    fits = {name: own for name, (own, units) in UNITS.items() if unit in units or not units}
    near = min(fits, key=lambda name: abs(log(factor / fits[name])))
    off = abs(log(factor / fits[near]))
    return f", which is what {near} give ({fits[near]:.5g})" if off < max(0.1, 3 * relative) else ""


def _dead_channel(channel: Channel, own: GainFit) -> ChannelFinding | None:
    """Return a dead channel: one value, but for its noise, while the prediction moves; else None."""
    seen, said = float(np.std(channel.measured)), float(np.std(channel.predicted))
    noise = channel.signal.noise_std or 0.0
    quiet = seen <= max(3 * noise, POLICY.negligible_share * said) or seen == 0
    lively = said > 10 * max(noise, 0.1 * channel.model_error) if seen == 0 else said > 10 * max(noise, seen)
    enough = channel.model_error < 0.3 * said
    if not (quiet and lively and enough):
        return None
    value = float(np.median(channel.measured))
    after = max(seen, noise, 1e-3 * own.scatter)
    unit = channel.signal.unit
    sentence = (
        f"{channel.label} stays at {value:.6g} {unit} to within {seen:.2g} {unit}, while the model says that "
        f"it moves by {np.ptp(channel.predicted):.3g} {unit}"
    )
    std = max(seen, noise) / np.sqrt(len(channel.rows))
    bayes = log_bayes(len(channel.rows), own.scatter, after)
    return _if_better(
        channel, own, "dead_channel", bayes, after, {"value": (value, float(std), unit)}, sentence
    )


def _if_better(
    channel: Channel,
    own: GainFit,
    name: str,
    bayes: float,
    after: GainFit | float,
    values: dict[str, tuple[float, float, str]],
    sentence: str,
) -> ChannelFinding:
    """Return the fault if its Bayes factor is positive, else the channel in order."""
    if bayes <= 0:
        return in_order(channel, own)
    rms, penalty = (after.rms, after.penalty) if isinstance(after, GainFit) else (after, 0.0)
    return ChannelFinding(
        channel, name, bayes, cost(channel, rms, penalty) - POLICY.prior_log_odds, values, sentence
    )


def _is_unexplained(channel: Channel, own: GainFit) -> bool:
    """Return True if too much motion is left in order, or nuisance regressors are too large."""
    moving = max(float(np.std(channel.predicted)), 10 * channel.noise)
    far = own.scatter > POLICY.max_unexplained * moving and own.scatter > 5 * np.hypot(
        channel.noise, channel.model_error
    )
    return far or own.penalty > POLICY.max_penalty


def _explained_by_delay(
    channel: Channel, simulated: SimulatedRecord, placement: Placement, flipped: GainFit
) -> bool:
    """Return True if a delay explains a turned sign as well: vibration at 5 Hz turns over in 0.1 s."""
    if simulated.record.kind == "static":
        return False
    for delay in np.linspace(-POLICY.max_delay, POLICY.max_delay, 31):
        there = predicted_at(simulated, channel.signal, placement, float(delay))[channel.rows, channel.index]
        if not np.isfinite(there).all():
            continue
        fit = replace(channel, predicted=there).fit()
        if fit.gain > POLICY.min_sigmas * fit.std and fit.unexplained_share < max(
            POLICY.max_unexplained, 3 * flipped.unexplained_share
        ):
            return True
    return False


def find_channel_faults(
    name: str, simulated: SimulatedRecord, seen: list[Channel] | None = None
) -> list[ChannelFinding]:
    """Return the finding of every channel of a record, `seen` if these are known."""
    placement = initial_alignment(simulated)
    seen = channels(name, simulated, placement) if seen is None else seen
    return with_mirrors(name, simulated, [_judge_channel(each, simulated, placement) for each in seen])


def _judge_channel(channel: Channel, simulated: SimulatedRecord, placement: Placement) -> ChannelFinding:
    """Judge one channel by its gain first, then by its plateaus."""
    slope = judge_gain(channel, simulated, placement)
    if slope.name:
        return slope
    held, cut = find_frozen(channel), find_saturation(channel)
    if cut is not None and (held is None or np.mean(cut[1][held[0]]) > POLICY.predominant_share):
        return cut[0]
    if held is None:
        return slope
    repeated = tuple(map(int, channel.rows[held[0]]))
    return frozen_as_dead(channel, *held) or replace(slope, frozen_rows=repeated, sentence=held[1])
