"""Nuisance parameters: clocks, registrations, nominal values, initial vibrations and tilts of the base.

Each has a Gaussian prior. Clocks and frames are effects of the model, `time_delay` and `frame_registration`,
that start at zero. Those of one name in several records are one clock and one frame, with the smallest stated
sigma. Nominal values are those of
`[uncertainty]`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from math import hypot, inf, isinf
from typing import Literal

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.parameter import Parameter, parameters, with_value
from flexarm.arm.uncertainty import owner_of
from flexarm.comparison.alignment_parameters import drive_clock
from flexarm.diagnosis.candidates import weighed
from flexarm.diagnosis.policy import FIT, NOISE_MODEL
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.residual_rows import is_non_smooth
from flexarm.effects.base_tilt import BaseTilt
from flexarm.effects.frame_registration import FrameRegistration
from flexarm.effects.time_delay import TimeDelay
from flexarm.errors import InvalidParameter
from flexarm.named_effects import Nuisance
from flexarm.record import Record
from flexarm.sensitivity import closes

UNKNOWN_DELAY = 1.0
"""1 sigma of an unknown clock, about the first guess [s]."""
UNKNOWN_POSE = {"translation": 0.1, "rotation": 0.1}
"""1 sigma of an unknown frame, about the first guess [m], [rad]."""


@dataclass(frozen=True)
class NuisanceParameter:
    """A parameter that is fitted along with the effects."""

    key: str
    """Parameter of the model."""
    centre: float
    sigma: float
    """Gaussian prior [unit]."""
    unit: str
    """Unit of both."""
    kind: Literal["clock", "frame", "nominal", "start", "base"]
    """A "start" is an initial vibration of a record, "base" the tilt of its base."""
    one_sign: bool = False
    """True if the model refuses values on the other side of zero, as of a modulus."""

    @property
    def of_record(self) -> bool:
        """Return True if it belongs to one record, not to the model: it acts linearly about any model."""
        return self.kind in ("start", "base")

    @property
    def place(self) -> tuple[str, str]:
        """Return effect and place of a clock or frame; of a base the record."""
        if self.kind == "base":
            return BaseTilt.name, self.key.removeprefix("records.").rsplit(".", 3)[0]
        _, name, at, *_ = self.key.split(".")
        return name, at

    @property
    def words(self) -> str:
        """Return a description for sentences."""
        if self.kind == "nominal":
            return f"value {self.key}"
        if self.kind == "start":
            return f"vibration with which {self.key.removeprefix('records.').split('.start.')[0]} begins"
        if self.kind == "base":
            return f"tilt of the base in {self.place[1]} about {self.key[-1]}"
        _, _, at, *rest = self.key.split(".")
        return f"{'.'.join(rest)} of {self.kind} {at}"

    def limited(self, step: float) -> float:
        """Return a step from the centre, shortened where a nominal value would nearly lose its sign.

        Linear steps far from the optimum can be too long: values of one sign, and values known to better than
        themselves, stay above a fifth of the centre. Parameters of a record stay at theirs.
        """
        if self.of_record:
            return 0.0
        if self.kind != "nominal" or not (self.one_sign or self.sigma < abs(self.centre)):
            return step
        return (
            max(step, -FIT.greatest_loss * self.centre)
            if self.centre >= 0
            else min(step, -FIT.greatest_loss * self.centre)
        )


@dataclass(frozen=True)
class NuisanceModel:
    """All nuisance parameters of a problem."""

    arm: Arm
    """The model with the effects that carry them."""
    parameters: tuple[NuisanceParameter, ...]
    """In the order of the columns of a Jacobian."""

    @property
    def keys(self) -> list[str]:
        """Return the keys of the model's parameters."""
        return [unknown.key for unknown in self.parameters]

    @property
    def sigma(self) -> np.ndarray:
        """Return 1 sigma of each."""
        return np.array([unknown.sigma for unknown in self.parameters])

    def model(self, arm: Arm, values: np.ndarray) -> Arm:
        """Return a model with values of these; those of records are no part of it."""
        for unknown, value in zip(self.parameters, values, strict=True):
            if not unknown.of_record:
                arm = with_value(arm, unknown.key, float(value))
        return arm

    def steps(self, arm: Arm) -> dict[str, float]:
        """Return steps of differences with respect to nominal values in non-smooth models; small ones
        elsewhere.

        After an impact at another instant the motion is out of phase, so small differences tell little.
        """
        if not is_non_smooth(arm):
            return {}
        return {
            u.key: min(FIT.ripple_step * u.sigma, FIT.widest_step * abs(u.centre) or u.sigma)
            for u in self.parameters
            if u.kind == "nominal"
        }

    def taken_by(self, spots: Collection[tuple[str, str]]) -> frozenset[str]:
        """Return the keys of clocks, frames and zeros that are effects themselves, given name and place."""
        return frozenset(u.key for u in self.parameters if u.key.startswith("effects.") and u.place in spots)

    def without(self, keys: Collection[str]) -> NuisanceModel:
        """Return the model without some keys."""
        return NuisanceModel(self.arm, tuple(u for u in self.parameters if u.key not in keys))


def nuisance_model(problem: Problem) -> NuisanceModel:
    """Return clocks and frames of the records, and the uncertain values of the model."""
    arm = problem.arm
    clocks, frames = _clocks(problem), _frames(problem)
    for name in clocks:
        if arm.effect(TimeDelay.name, name) is None:
            arm = arm.with_effect(TimeDelay(at=name))
    for name in frames:
        if arm.effect(FrameRegistration.name, name) is None:
            arm = arm.with_effect(FrameRegistration(at=name))
    found = []
    for name, sigma in clocks.items():
        (p,) = parameters(arm, [TimeDelay(at=name).model_key("delay")])
        found.append(NuisanceParameter(p.key, p.value, sigma, p.unit, "clock"))
    for name, sigmas in frames.items():
        for kind, sigma in sigmas.items():
            if sigma > 0:
                there = parameters(arm, [FrameRegistration(at=name).model_key(kind)])
                found += [NuisanceParameter(p.key, p.value, sigma, p.unit, "frame") for p in there]
    swings = [
        NuisanceParameter(start.key, 0.0, NOISE_MODEL.jerk, start.unit, "start")
        for start in problem.initial_conditions
    ]
    tilts = [NuisanceParameter(tilt.key, tilt.stated, tilt.sigma, "rad", "base") for tilt in problem.tilts]
    return NuisanceModel(arm, (*found, *nominal(arm, problem.records), *swings, *tilts))


def nominal(arm: Arm, records: Mapping[str, Record]) -> list[NuisanceParameter]:
    """Return uncertain nominal values, but for components that would open a loop.

    A payload mass that every record states is known.
    """
    found = []
    for key in arm.uncertainty:
        value, sigma = arm.sigma(key)
        bare, stated = bare_key(arm, key), owner_of(arm, key).unit
        if _known(bare, records):
            continue
        there = parameters(arm, [bare])
        sigmas = np.broadcast_to(sigma, (len(there),)) if isinstance(value, tuple) else [sigma]
        found += [
            NuisanceParameter(
                p.key, p.value, float(s), stated or p.unit, "nominal", _has_one_sign(arm, p, float(s))
            )
            for p, s in zip(there, sigmas, strict=True)
            if s > 0 and closes(arm, p)
        ]
    return found


def known_loads(arm: Arm, records: Mapping[str, Record]) -> list[str]:
    """Return payloads with an uncertain mass that every record states."""
    return [bare.split(".")[1] for key in arm.uncertainty if _known(bare := bare_key(arm, key), records)]


def _known(key: str, records: Mapping[str, Record]) -> bool:
    """Return True if a value is the mass of a payload that every record states."""
    table, name, *rest = key.split(".")
    masses = table == "payloads" and rest == ["mass"] and bool(records)
    return masses and all(weighed(record, name) for record in records.values())


def _has_one_sign(arm: Arm, nominal: Parameter, sigma: float) -> bool:
    """Return True if the model refuses the value of opposite sign; for zero, a sigma below it."""
    try:
        with_value(arm, nominal.key, -nominal.value or -sigma)
    except InvalidParameter:
        return True
    return False


def bare_key(arm: Arm, key: str) -> str:
    """Return a key of `[uncertainty]` without the unit at its end."""
    place = owner_of(arm, key)
    return ".".join((*place.prefix, place.field))


def first_guess(key: str, problem: Problem) -> float:
    """Return the first guess of the delay of an unknown clock [s]; 0 for other parameters."""
    if not key.startswith(f"effects.{TimeDelay.name}."):
        return 0.0
    clock = key.split(".")[2]
    return next(
        (
            problem.placement[name].clocks[clock].delay
            for name, record in problem.records.items()
            if clock in record.clocks and record.clocks[clock].unknown
        ),
        0.0,
    )


def counted_from_stamps(nuisances: Iterable[Nuisance], problem: Problem) -> tuple[Nuisance, ...]:
    """Return fitted nuisance parameters with delays of unknown clocks in full, their first guess included."""
    found = []
    for each in nuisances:
        guess = first_guess(f"effects.{each.name}.{each.at}.delay", problem)
        values = (
            replace(one, value=one.value + guess, low90=one.low90 + guess, high90=one.high90 + guess)
            for one in each.parameters
        )
        found.append(replace(each, parameters=tuple(values)) if guess else each)
    return tuple(found)


def _clocks(problem: Problem) -> dict[str, float]:
    """1 sigma of the offset of every clock of evidence but the drive's [s]: the least that is stated."""
    found: dict[str, float] = {}
    for each in problem.rows:
        record = problem.records[each.record]
        name = record.signals[each.signal].clock
        own = drive_clock(record)
        if name == own or record.kind == "static":
            continue
        clock, reference = record.clocks[name], record.clocks[own]
        sigma = inf if clock.unknown or reference.unknown else hypot(clock.sigma, reference.sigma)
        found[name] = min(sigma, found.get(name, inf))
    return {name: UNKNOWN_DELAY if isinf(sigma) else sigma for name, sigma in found.items() if sigma > 0}


def _frames(problem: Problem) -> dict[str, dict[str, float]]:
    """1 sigma of the registration of every frame of evidence [m], [rad]: the least that is stated."""
    found: dict[str, dict[str, float]] = {}
    for each in problem.rows:
        record = problem.records[each.record]
        signal = record.signals[each.signal]
        frame = record.frames.get(signal.frame)
        if frame is None or signal.quantity not in ("position", "orientation"):
            continue
        least = found.setdefault(signal.frame, dict.fromkeys(UNKNOWN_POSE, inf))
        for kind in UNKNOWN_POSE:
            least[kind] = min(least[kind], inf if frame.unknown else getattr(frame, kind))
    return {
        name: {kind: UNKNOWN_POSE[kind] if isinf(sigma) else sigma for kind, sigma in least.items()}
        for name, least in found.items()
        if any(sigma > 0 for sigma in least.values())
    }
