"""Sign and unit of a channel, from the slope by which it follows its prediction; dead channels.

A sensor in order has slope 1 within what missing effects do to it (`IN_ORDER`): an arm 5 % too long, a
payload twice as heavy. A slope counts only if the channel then follows the prediction to `FOLLOWS` of its
motion and is known to five sigma. Factors near a conversion of units are named after it, of a torque also
those of its joint's gear. What bears a load shows any other factor up to `HEAVIER` where the arm carries what
no one stated: that is said, and no fault.

All channels of a record, each under its best hypothesis.
"""

from __future__ import annotations

from dataclasses import replace
from math import log, pi
from typing import TYPE_CHECKING

import numpy as np

from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.measurement.torque import gear_ratio
from flexarm.validation.channel import Channel, channels
from flexarm.validation.finding import PRIOR, Finding, cost, log_bayes
from flexarm.validation.initial_alignment import placing
from flexarm.validation.regression import Fit, values_at
from flexarm.validation.saturation import dead_from, frozen, saturated
from flexarm.wording import with_unit

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Signal


IN_ORDER = 1.6
"""Slopes between its inverse and it need no other unit."""
LOOSE = {"motor_torque": 3.0, "motor_voltage": 3.0, "strain": 3.0, "deflection": 3.0}
"""The same for what bears loads, and the nominal model knows less well."""
HEAVIER = 20.0
"""Factor, or its inverse, that a load which is not stated may give to these."""
FOLLOWS = 0.3
"""Greatest share of the motion that a hypothesis may leave."""
CERTAIN = 5.0
"""Sigmas by which a slope must be known."""
STILL = 0.02
"""Share of the predicted motion below which a channel does not move."""
STRAINED = 4.5
"""Half of the squares of sigmas by which what is no fault may be off: an offset of three, say."""
FAR_DELAY = 0.15
"""Delays [s] that may turn a sign and are no sign error."""
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
"""Conversions by the factor that a reading gets, and the SI units of what is measured so; of anything: ()."""


def judged(channel: Channel, simulated: SimulatedRecord, placement: Placement) -> Finding:
    """The channel under its best hypothesis of slope."""
    fit, own = channel.fit(), channel.fit_at(1.0)
    here = in_order(channel, own)
    firm = abs(fit.slope) > CERTAIN * fit.std and fit.missed < FOLLOWS
    if not firm:
        return _dead(channel, own) or replace(here, strange=_strange(channel, own))
    loose = LOOSE.get(channel.signal.quantity, IN_ORDER)
    another_unit = not 1 / loose < abs(fit.slope) < loose
    if fit.slope > 0 and not another_unit:
        return replace(here, strange=_strange(channel, own))
    if fit.slope < 0 and _late(channel, simulated, placement, fit):
        return replace(here, strange=True)
    return _flipped(channel, fit, own) if not another_unit else _scaled(channel, fit, own, simulated.arm)


def in_order(channel: Channel, own: Fit) -> Finding:
    """The channel as one that is what it says."""
    return Finding(channel, cost=cost(channel, own.left, own.strain))


def _flipped(channel: Channel, fit: Fit, own: Fit) -> Finding:
    turned = channel.fit_at(-1.0)
    bayes = log_bayes(len(channel.rows), own.scatter, turned.scatter)
    sentence = (
        f"{channel.label} moves against the model: measured = {fit.slope:.3f} x predicted "
        f"(+- {fit.std:.1g}); with the sign turned {with_unit(fit.left, channel.signal.unit, 2)} are left "
        f"of {with_unit(own.scatter, channel.signal.unit, 2)}"
    )
    return _found(channel, own, "sign_error", bayes, turned, {}, sentence)


def _scaled(channel: Channel, fit: Fit, own: Fit, arm: Arm) -> Finding:
    factor = abs(fit.slope)
    bayes = log_bayes(len(channel.rows), own.scatter, fit.scatter)
    turned = "against the model and " if fit.slope < 0 else ""
    relative = fit.std / factor
    why = of_gear(channel.signal, factor, relative, arm)
    why = why or unit_named(factor, relative, channel.signal.unit)
    times = f"{channel.label} moves {turned}{factor:.5g} times as far as the model says"
    if not why and fit.slope > 0 and channel.signal.quantity in LOOSE and 1 / HEAVIER < factor < HEAVIER:
        load = "does the arm carry what model and record state?"
        return replace(in_order(channel, own), sentence=f"{times}, which no unit gives: {load}")
    sentence = (
        f"{times} (+- {100 * relative:.1f} %){why}; "
        f"with that taken back {100 * fit.missed:.2g} % of its motion is left"
    )
    values = {"factor": (factor, fit.std, "-")}
    return _found(channel, own, "unit_error", bayes, fit, values, sentence)


def of_gear(signal: Signal, factor: float, relative: float, arm: Arm) -> str:
    """That a torque's factor is its gear's ratio, or the inverse, for a sentence."""
    ratio = gear_ratio(arm, str(signal.joint)) if signal.quantity == "motor_torque" else 1.0
    for own, side, other in ((ratio, "output", "motor"), (1 / ratio, "motor", "output")):
        if ratio != 1 and abs(log(factor / abs(own))) < max(0.1, 3 * relative):
            return f", as a torque on the {side} side does that is said to be on the {other} side"
    return ""


def unit_named(factor: float, relative: float, unit: str) -> str:
    """The conversion that a factor may be of readings in an SI unit, for a sentence."""
    fits = {name: own for name, (own, units) in UNITS.items() if unit in units or not units}
    near = min(fits, key=lambda name: abs(log(factor / fits[name])))
    off = abs(log(factor / fits[near]))
    return f", which is what {near} give ({fits[near]:.5g})" if off < max(0.1, 3 * relative) else ""


def _dead(channel: Channel, own: Fit) -> Finding | None:
    """A channel that shows one value, but for its noise, while the model says that it moves."""
    seen, said = float(np.std(channel.measured)), float(np.std(channel.predicted))
    noise = channel.signal.noise_std or 0.0
    quiet = seen <= max(3 * noise, STILL * said) or seen == 0
    lively = said > 10 * max(noise, 0.1 * channel.floor) if seen == 0 else said > 10 * max(noise, seen)
    enough = channel.floor < 0.3 * said
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
    return _found(channel, own, "dead_channel", bayes, after, {"value": (value, float(std), unit)}, sentence)


def _found(
    channel: Channel,
    own: Fit,
    name: str,
    bayes: float,
    after: Fit | float,
    values: dict[str, tuple[float, float, str]],
    sentence: str,
) -> Finding:
    """The fault if it wins, else the channel in order."""
    if bayes <= 0:
        return in_order(channel, own)
    left, strain = (after.left, after.strain) if isinstance(after, Fit) else (after, 0.0)
    return Finding(channel, name, bayes, cost(channel, left, strain) - PRIOR, values, sentence)


def _strange(channel: Channel, own: Fit) -> bool:
    """Whether no hypothesis explains it.

    It leaves more of its motion than one that follows, and much more than any noise; or what is no fault is
    strained.
    """
    moving = max(float(np.std(channel.predicted)), 10 * channel.noise)
    far = own.scatter > FOLLOWS * moving and own.scatter > 5 * np.hypot(channel.noise, channel.floor)
    return far or own.strain > STRAINED


def _late(channel: Channel, simulated: SimulatedRecord, placement: Placement, flipped: Fit) -> bool:
    """Whether a delay explains a turned sign as well: vibration at 5 Hz turns over in 0.1 s."""
    if simulated.record.kind == "static":
        return False
    for delay in np.linspace(-FAR_DELAY, FAR_DELAY, 31):
        there = values_at(simulated, channel.signal, placement, float(delay))[channel.rows, channel.index]
        if not np.isfinite(there).all():
            continue
        fit = replace(channel, predicted=there).fit()
        if fit.slope > CERTAIN * fit.std and fit.missed < max(FOLLOWS, 3 * flipped.missed):
            return True
    return False


AT_ITS_ENDS = 0.8
"""Share of the repeated values that lie at the ends of the range, where a channel is cut off, not frozen."""


def findings(name: str, simulated: SimulatedRecord) -> list[Finding]:
    """What every channel of a record looks like beside one simulation of it."""
    placement = placing(simulated)
    return [_finding(channel, simulated, placement) for channel in channels(name, simulated, placement)]


def _finding(channel: Channel, simulated: SimulatedRecord, placement: Placement) -> Finding:
    """One channel: its slope first, then its plateaus."""
    slope = judged(channel, simulated, placement)
    if slope.name:
        return slope
    held, cut = frozen(channel), saturated(channel)
    if cut is not None and (held is None or np.mean(cut[1][held[0]]) > AT_ITS_ENDS):
        return cut[0]
    if held is None:
        return slope
    repeated = tuple(map(int, channel.rows[held[0]]))
    return dead_from(channel, *held) or replace(slope, frozen=repeated, sentence=held[1])
